// Drawings of the experiments' page, as SVG text. Titles and names must be free of markup.
#pragma once

#include <string>
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

struct Bars {
  std::string name;
  std::vector<double> values;  // one per group
};

// Bars side by side per group on a logarithmic axis; values <= 0 are left out.
[[nodiscard]] std::string PlotBars(const std::string& title, const std::string& unit,
                                   const std::vector<std::string>& groups, const std::vector<Bars>& bars);

}  // namespace rigcal::paper
