// Keys of causes in words.
#pragma once

#include <string>

namespace rigcal::report {

// "board_size panel larger" -> "board panel larger than given"; a key that is not known, of a later version, in its own
// words.
[[nodiscard]] std::string CauseText(const std::string& key);

}  // namespace rigcal::report
