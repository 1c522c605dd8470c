#include <fmt/format.h>

#include <cmath>

#include "tests/paper/chain_experiment.h"
#include "tests/paper/plots.h"

namespace rigcal::paper {
namespace {

constexpr std::array<const char*, kWays> kColours = {"#ff725c", "#efb118", "#4269d0"};
constexpr double kDegreesPerRadian = 57.29577951308232;

std::string Plot(const ChainExperiment& experiment, const std::string& title, const std::string& unit, double scale,
                 std::vector<double> WayErrors::*errors, double WayErrors::*predicted) {
  std::vector<GroupName> groups;
  std::vector<Strips> strips;
  for (const Route& route : experiment.routes)
    groups.emplace_back(route.sensors.front().str(), "to " + route.sensors.back().str());
  for (std::size_t way = 0; way < kWays; ++way) {
    strips.push_back({kWayNames[way], kColours[way], {}, {}});
    for (const Route& route : experiment.routes) {
      std::vector<double> values = route.ways[way].*errors;
      for (double& value : values) value *= scale;
      strips.back().values.push_back(std::move(values));
      strips.back().expected.push_back(scale * std::sqrt(route.ways[way].*predicted));
    }
  }
  return PlotStrips(title, unit, groups, strips, Scale::kLogarithmic);
}

std::string Cell(double seen, double predicted) { return fmt::format("<td>{:.3g} ({:.3g})</td>", seen, predicted); }

std::string Cells(const WayErrors& errors) {
  return Cell(1e3 * Rms(errors.error_m), 1e3 * std::sqrt(errors.predicted_m2)) +
         Cell(kDegreesPerRadian * Rms(errors.error_rad), kDegreesPerRadian * std::sqrt(errors.predicted_rad2));
}

std::string Row(const Route& route) {
  std::string chain;
  for (const SensorId& sensor : route.sensors) chain += (chain.empty() ? "" : " &rarr; ") + sensor.str();
  std::string row = fmt::format("<tr><th>{}</th><th>{}</th>", chain, route.direct_method);
  for (const WayErrors& errors : route.ways) row += Cells(errors);
  return row + "</tr>\n";
}

std::string Table(const ChainExperiment& experiment) {
  std::string table =
      "<div class='table' tabindex='0'><table><tr><th>chain</th><th>direct by</th><th>chained, "
      "mm</th><th>deg</th><th>direct, "
      "mm</th>"
      "<th>deg</th><th>graph, mm</th><th>deg</th></tr>\n";
  for (const Route& route : experiment.routes) table += Row(route);
  table += "<tr class='sum'><th>all</th><th></th>";
  for (const WaySum& sum : experiment.sums)
    table += Cell(1e3 * sum.rms_m, 1e3 * sum.predicted_rms_m) +
             Cell(kDegreesPerRadian * sum.rms_rad, kDegreesPerRadian * sum.predicted_rms_rad);
  return table + "</tr></table></div>\n";
}

std::string Sentence(const ChainExperiment& experiment) {
  const WaySum &chained = experiment.sums[kChained], &direct = experiment.sums[kDirect],
               &graph = experiment.sums[kGraph];
  return fmt::format(
      "<p>Rms over the visits, in brackets what is expected. Over all routes the graph errs by {:.2f} of the chain's "
      "error and {:.2f} of the direct calibration's in translation, by {:.2f} and {:.2f} in rotation. A direct "
      "calibration errs by {:.2f} of the chain's error: where two sensors have nothing or little in common to see, a "
      "chain of neighbours that have can do as well.</p>\n",
      graph.rms_m / chained.rms_m, graph.rms_m / direct.rms_m, graph.rms_rad / chained.rms_rad,
      graph.rms_rad / direct.rms_rad, direct.rms_m / chained.rms_m);
}

}  // namespace

Section ChainSection(const ChainExperiment& experiment) {
  Section section;
  const std::string caption = "Dots: one visit each. Dashed: rms that the edges' joint covariance lets expect.";
  section.html = fmt::format(
      "<h2>(c) Chained, direct, or from the graph</h2>\n<p>The pose between two sensors of the virtual MARS Mapper, "
      "from "
      "the same {} visits as in (b): composed of the edges along a chain round the robot, calibrated directly, or "
      "taken "
      "from the graph of all edges. Errors against the truth.</p>\n",
      experiment.visits);
  section.html +=
      Figure("chain-translation",
             Plot(experiment, "Translation error", "mm", 1e3, &WayErrors::error_m, &WayErrors::predicted_m2), caption,
             section);
  section.html += Figure(
      "chain-rotation",
      Plot(experiment, "Rotation error", "deg", kDegreesPerRadian, &WayErrors::error_rad, &WayErrors::predicted_rad2),
      caption, section);
  section.html += Table(experiment) + Sentence(experiment);
  return section;
}

}  // namespace rigcal::paper
