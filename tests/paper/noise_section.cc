#include <fmt/format.h>

#include "tests/paper/noise_experiment.h"
#include "tests/paper/plots.h"

namespace rigcal::paper {
namespace {

constexpr const char* kNoiseColour = "#ff725c";
constexpr const char* kOptimisedColour = "#4269d0";
constexpr double kDegreesPerRadian = 57.29577951308232;

std::string Plot(const NoiseExperiment& experiment, const std::string& title, const std::string& unit,
                 double NoiseSums::*part) {
  Series noise{"noise of the edges", kNoiseColour, {}, experiment.expected_noise.*part};
  Series optimised{"optimised graph", kOptimisedColour, {}, experiment.expected_optimised.*part};
  for (const NoiseSet& set : experiment.sets) {
    noise.values.push_back(set.noise.*part);
    optimised.values.push_back(set.optimised.*part);
  }
  return PlotSeries(title, unit, {noise, optimised});
}

std::string Row(const std::string& name, double noise, double optimised, double predicted) {
  return fmt::format("<tr><th>{}</th><td>{:.4g}</td><td>{:.4g}</td><td>{:.4f}</td><td>{:.4f}</td></tr>\n", name, noise,
                     optimised, optimised / noise, predicted);
}

std::string Table(const NoiseExperiment& experiment) {
  const NoiseSums noise = MeanNoise(experiment), optimised = MeanOptimised(experiment);
  const NoiseSums &before = experiment.expected_noise, &after = experiment.expected_optimised;
  return "<div class='table' tabindex='0'><table><tr><th>sum</th><th>noise of the "
         "edges</th><th>optimised</th><th>ratio</th><th>predicted</th></tr>\n" +
         Row("translation, m&sup2;", noise.translation_m2, optimised.translation_m2,
             after.translation_m2 / before.translation_m2) +
         Row("rotation, rad&sup2;", noise.rotation_rad2, optimised.rotation_rad2,
             after.rotation_rad2 / before.rotation_rad2) +
         Row("whitened e<sup>T</sup>&Omega;e", noise.whitened, optimised.whitened, after.whitened / before.whitened) +
         "</table></div>\n";
}

}  // namespace

Section NoiseSection(const NoiseExperiment& experiment) {
  Section section;
  section.html = fmt::format(
      "<h2>(a) Noise before and after optimisation</h2>\n<p>A graph of 4 vertices and 6 edges, {} data sets, each with "
      "another rig; normal noise of {:.0f} mm and {:.2f} deg per axis on every edge. Sums over the edges of the "
      "squared "
      "errors against the truth.</p>\n",
      experiment.sets.size(), experiment.sigma_m * 1e3, experiment.sigma_rad * kDegreesPerRadian);
  const std::string caption =
      "Dots: one data set each. Dashed: the mean that the linear prediction J H<sup>-1</sup> J<sup>T</sup> gives. "
      "Right: "
      "median, quartiles and extremes.";
  section.html +=
      Figure("noise-translation", Plot(experiment, "Translation error", "m&#178;", &NoiseSums::translation_m2), caption,
             section);
  section.html += Figure("noise-rotation", Plot(experiment, "Rotation error", "rad&#178;", &NoiseSums::rotation_rad2),
                         caption, section);
  section.html += Table(experiment);
  const double largest = LargestRatio(experiment);
  section.html += fmt::format(
      "<p>The graph keeps (N<sub>V</sub> - 1) / N<sub>E</sub> = 3/6 of the noise. The largest ratio of whitened sums "
      "in "
      "one set is {:.3f}: {}.</p>\n",
      largest,
      largest < 1 ? "in every set the graph is nearer to the truth than its edges"
                  : "in some sets the edges are nearer");
  return section;
}

}  // namespace rigcal::paper
