// What `rigcal resolve` says of a run, of the document of the verb recomputation.
#pragma once

#include <ostream>
#include <string>

#include "client/text/document.h"

namespace rigcal::client {

// "Run 3: all robots, re-computed with rigcal 0.2.0, estimator joint/7, asked for by Ada."
[[nodiscard]] std::string RunText(const Document& document);
// "3 robots changed", "1 robot changed, 1 failed": of those that are done, for a line of progress.
[[nodiscard]] std::string ChangedText(const Document& document);
// The counts, a row for each sensor that would sit elsewhere, the largest effect first, then what is unchanged and what
// was left.
void PrintRecomputation(const Document& document, std::ostream& out);

}  // namespace rigcal::client
