#include <fmt/format.h>

#include <cmath>

#include "tests/paper/global_experiment.h"
#include "tests/paper/plots.h"

namespace rigcal::paper {
namespace {

constexpr const char *kBefore = "#ff725c", *kFull = "#4269d0", *kDiagonal = "#3ca951";
constexpr double kDegreesPerRadian = 57.29577951308232;

std::string Plot(const GlobalRuns& runs, const std::string& title) {
  Series before{"before", kBefore, {}, runs.full.predicted_before};
  Series full{"after, full information", kFull, {}, runs.full.predicted_after};
  Series diagonal{"after, diagonal information", kDiagonal, {}, runs.diagonal.predicted_after};
  for (const GlobalSample& sample : runs.full.samples) {
    before.values.push_back(sample.before.total);
    full.values.push_back(sample.after.total);
  }
  for (const GlobalSample& sample : runs.diagonal.samples) diagonal.values.push_back(sample.after.total);
  return PlotSeries(title, "m&#178; + rad&#178;", {before, full, diagonal});
}

std::string Cell(double seen, double predicted) {
  return fmt::format("<td class='tight'>{:.3g} ({:.3g})</td>", seen, predicted);
}

std::string Row(const std::string& name, const GlobalRun& run) {
  const GlobalSample mean = run.Mean();
  return "<tr><th>" + name + "</th>" + Cell(mean.before.total, run.predicted_before) +
         Cell(mean.after.total, run.predicted_after) +
         Cell(mean.after.total / mean.before.total, run.predicted_after / run.predicted_before) +
         Cell(1e3 * std::sqrt(mean.pose_m2), 1e3 * std::sqrt(run.predicted_pose_m2)) +
         Cell(kDegreesPerRadian * std::sqrt(mean.pose_rad2), kDegreesPerRadian * std::sqrt(run.predicted_pose_rad2)) +
         "</tr>\n";
}

std::string Table(const GlobalExperiment& experiment) {
  return "<div class='table' tabindex='0'><table><tr><th>mean "
         "(predicted)</th><th>before</th><th>after</th><th>ratio</th><th>poses, "
         "mm</th><th>poses, deg</th></tr>\n" +
         Row("visits, full", experiment.visits.full) + Row("visits, diagonal", experiment.visits.diagonal) +
         Row("drawn, full", experiment.realistic.full) + Row("drawn, diagonal", experiment.realistic.diagonal) +
         Row("drawn, the paper's noise, full", experiment.paper.full) +
         Row("drawn, the paper's noise, diagonal", experiment.paper.diagonal) +
         fmt::format(
             "<tr class='sum'><th>the paper's robot</th><td>{}</td><td>{}</td><td>{:.3f}</td><td></td><td></td>"
             "</tr></table></div>\n",
             kPaperBefore, kPaperAfter, kPaperAfter / kPaperBefore);
}

std::string Introduction(const GlobalExperiment& experiment) {
  return fmt::format(
      "<h2>(b) The MARS Mapper: E<sub>global</sub> before and after</h2>\n<p>{} visits to the virtual MARS Mapper, {} "
      "captures each, {} sensors; every edge by the estimators of the server, from noisy corners, plate points, "
      "tracker "
      "poses and whole lidar scans. {} edges were solved in every visit. <i>Before</i>: poses composed along the "
      "spanning tree of the most certain edges. <i>Full</i> information is the inverse of the jackknife's covariance, "
      "<i>diagonal</i> one over each variance, as in the paper. Errors of the poses are against the truth, rms over "
      "the "
      "sensors.</p>\n",
      experiment.visits.full.samples.size(), experiment.captures, experiment.sensors,
      experiment.edges_min < 59 ? fmt::format("At least {} of 59", experiment.edges_min) : "All 59");
}

std::string RealisticSentence(const GlobalExperiment& experiment) {
  const GlobalSample mean = experiment.visits.full.Mean();
  return fmt::format(
      "<p>At the noise of good sensors one edge errs by {:.1f} mm and {:.3f} deg, and E<sub>global</sub> falls from "
      "{:.2g} to {:.2g}: far below the paper's {} and {}.</p>\n",
      1e3 * experiment.edge_rms_m, kDegreesPerRadian * experiment.edge_rms_rad, mean.before.total, mean.after.total,
      kPaperBefore, kPaperAfter);
}

std::string PaperSentence(const GlobalExperiment& experiment) {
  const GlobalSample full = experiment.paper.full.Mean(), diagonal = experiment.paper.diagonal.Mean();
  return fmt::format(
      "<p>For the paper's {} before optimisation, errors of independent edges must be {:.0f} times as large: {:.0f} mm "
      "and {:.1f} deg. Optimisation then leaves {:.2f} of it (full) or {:.2f} (diagonal), as predicted, while the "
      "paper "
      "reports {:.2f}. Noise does not leave that much once 48 loops are closed. An error of another kind does: an edge "
      "that contradicts all others and has little weight counts in full before and after.</p>\n",
      kPaperBefore, experiment.noise_factor, 1e3 * experiment.noise_factor * experiment.edge_rms_m,
      kDegreesPerRadian * experiment.noise_factor * experiment.edge_rms_rad, full.after.total / full.before.total,
      diagonal.after.total / diagonal.before.total, kPaperAfter / kPaperBefore);
}

std::string NoisySentence(const GlobalExperiment& experiment) {
  if (experiment.noisy_pairs.empty()) return {};
  std::string html = fmt::format(
      "<p>Sensors {:.0f} times as noisy (corners, ranges, tracker, lenses) do not give such a graph. What the "
      "estimators of four pairs say:</p>\n<div class='table' tabindex='0'><table>\n",
      experiment.noise_factor);
  for (const NoisyPair& pair : experiment.noisy_pairs)
    html += fmt::format("<tr><th>{}</th><td class='text'>{}</td></tr>\n", pair.method,
                        pair.refusal.empty()
                            ? fmt::format("{}, {}: errs by {:.1f} mm and {:.2f} deg", pair.a.str(), pair.b.str(),
                                          1e3 * pair.error_m, kDegreesPerRadian * pair.error_rad)
                            : "refused: " + Escaped(pair.refusal));
  return html + "</table></div>\n";
}

std::string InformationSentence(const GlobalExperiment& experiment) {
  const GlobalSample full = experiment.realistic.full.Mean(), diagonal = experiment.realistic.diagonal.Mean();
  return fmt::format(
      "<p>Which information is better? E<sub>global</sub> after optimisation is {:.2g} with the diagonal one and "
      "{:.2g} "
      "with the full one, but with the diagonal one the poses err {:.2f} times as much in translation and {:.2f} times "
      "in "
      "rotation. E<sub>global</sub> counts every edge alike, so the worst edges rule it: a smaller one is not a better "
      "rig. The weighted cost tells more: {:.1f} on average where {} degrees of freedom let expect {}; and of the "
      "noise, "
      "weighted, the graph keeps {:.4f}, where it has 11 poses for 59 edges: {:.4f}.</p>\n",
      diagonal.after.total, full.after.total, std::sqrt(diagonal.pose_m2 / full.pose_m2),
      std::sqrt(diagonal.pose_rad2 / full.pose_rad2), full.cost, experiment.dof, experiment.dof, full.whitened_ratio,
      experiment.WhitenedExpected());
}

std::string SharedSentence(const GlobalExperiment& experiment) {
  const GlobalSample visits = experiment.visits.full.Mean(), drawn = experiment.realistic.full.Mean();
  return fmt::format(
      "<p>Edges of one visit share its captures, and what they share they agree on: E<sub>global</sub> after "
      "optimisation is {:.2g} and the cost {:.0f}, where independent edges give {:.2g} and {:.0f}. That is no sign of "
      "a "
      "better rig: the poses err {:.2f} times as much as those of independent edges. The prediction for the visits "
      "takes "
      "the captures out one by one through the whole graph and says {:.2f} mm; seen are {:.2f} mm.</p>\n",
      visits.after.total, visits.cost, drawn.after.total, drawn.cost, std::sqrt(visits.pose_m2 / drawn.pose_m2),
      1e3 * std::sqrt(experiment.visits.full.predicted_pose_m2), 1e3 * std::sqrt(visits.pose_m2));
}

}  // namespace

Section GlobalSection(const GlobalExperiment& experiment) {
  Section section;
  const std::string dashes = " Dashed: what the linear prediction says of the mean.";
  section.html = Introduction(experiment);
  section.html += Figure("global-visits", Plot(experiment.visits, "Estimated edges"),
                         "E<sub>global</sub> of each visit." + dashes, section);
  section.html +=
      Figure("global-paper-noise", Plot(experiment.paper, "Noise as large as the paper's"),
             "E<sub>global</sub> with errors drawn from the edges' covariances, edges independent." + dashes, section);
  section.html += Table(experiment) + RealisticSentence(experiment) + PaperSentence(experiment) +
                  NoisySentence(experiment) + InformationSentence(experiment) + SharedSentence(experiment);
  return section;
}

}  // namespace rigcal::paper
