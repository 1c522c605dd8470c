// Words that several sentences share.
#pragma once

#include <string>
#include <vector>

namespace rigcal::check {

// "left", "left and up", "left, right and up".
[[nodiscard]] std::string Enumerated(const std::vector<std::string>& words);
// The same of names, the first six of them: "a, b, c, d, e, f and 3 more".
[[nodiscard]] std::string NamesText(const std::vector<std::string>& names);

}  // namespace rigcal::check
