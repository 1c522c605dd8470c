// The experiments' page: one file, no scripts, no links.
#pragma once

#include <string>
#include <vector>

namespace rigcal::paper {

[[nodiscard]] std::string Page(const std::vector<std::string>& sections);

}  // namespace rigcal::paper
