// Drawings of the experiments' page, as SVG text. Titles and names must be free of markup.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace rigcal::paper {

struct Series {
  std::string name;
  std::string colour;
  std::vector<double> values;  // one per data set
  double expected = 0.0;       // of their mean
};

// Values over the number of the data set, a dashed line at each expected mean, box plots at the right.
[[nodiscard]] std::string PlotSeries(const std::string& title, const std::string& unit,
                                     const std::vector<Series>& series);

struct Strips {
  std::string name;
  std::string colour;
  std::vector<std::vector<double>> values;  // per group
  std::vector<double> expected;             // per group; 0: none
};
// Two lines under a group.
using GroupName = std::pair<std::string, std::string>;

enum class Scale { kLinear, kLogarithmic };

// Per group one column of dots for each of the strips, a dash at what is expected.
[[nodiscard]] std::string PlotStrips(const std::string& title, const std::string& unit,
                                     const std::vector<GroupName>& groups, const std::vector<Strips>& strips,
                                     Scale scale);

}  // namespace rigcal::paper
