// The text of /metrics, in Prometheus' format 0.0.4.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace rigcal::metrics {

// A figure as it is now, read from where it is kept when somebody asks.
struct Reading {
  std::string name;  // with its unit last; ends in _total where it only grows
  std::string help;  // of the name: that of its first reading counts
  double value = 0.0;
  std::map<std::string, std::string> labels = {};
};

// The readings with all that was noted (noted.h), by name and then by labels: each name has its help and type once. A
// second reading of the same name and labels is left out.
[[nodiscard]] std::string TextOf(const std::vector<Reading>& readings);
inline constexpr const char* kContentType = "text/plain; version=0.0.4; charset=utf-8";

}  // namespace rigcal::metrics
