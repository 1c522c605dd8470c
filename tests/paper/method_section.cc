#include <fmt/format.h>

#include <cmath>

#include "tests/paper/method_experiment.h"
#include "tests/paper/plots.h"

namespace rigcal::paper {
namespace {

constexpr const char *kTranslation = "#4269d0", *kRotation = "#efb118";
constexpr double kDegreesPerRadian = 57.29577951308232;

std::vector<double> Sigmas(const MethodPair& pair, int first_axis) {
  std::vector<double> sigmas;
  for (const MethodSample& sample : pair.samples)
    for (int axis = first_axis; axis < first_axis + 3; ++axis)
      sigmas.push_back(std::abs(sample.difference[axis]) / sample.sigma_difference[axis]);
  return sigmas;
}

std::string Plot(const MethodFamily& family) {
  std::vector<GroupName> groups;
  Strips translation{"translation, per axis", kTranslation, {}, {}}, rotation{"rotation, per axis", kRotation, {}, {}};
  for (const MethodPair& pair : family.pairs) {
    groups.emplace_back(pair.a.str(), pair.b.str());
    translation.values.push_back(Sigmas(pair, 0));
    rotation.values.push_back(Sigmas(pair, 3));
    for (Strips* strips : {&translation, &rotation}) strips->expected.push_back(3);
  }
  return PlotStrips("Difference of two methods", "sigmas", groups, {translation, rotation}, Scale::kLinear);
}

// Rms over the visits of the norm of one part of a vector, translation in mm, rotation in degrees.
std::string Norms(const MethodPair& pair, Vector6d MethodSample::*part) {
  double translation = 0, rotation = 0;
  for (const MethodSample& sample : pair.samples) {
    translation += (sample.*part).head<3>().squaredNorm();
    rotation += (sample.*part).tail<3>().squaredNorm();
  }
  const double count = std::max<double>(1, static_cast<double>(pair.samples.size()));
  return fmt::format("<td class='tight'>{:.3g} mm<br>{:.2g} deg</td>", 1e3 * std::sqrt(translation / count),
                     kDegreesPerRadian * std::sqrt(rotation / count));
}

std::string Table(const MethodFamily& family) {
  std::string table = fmt::format(
      "<div class='table' tabindex='0'><table><tr><th>pair</th><th>sigma: {0}</th><th>sigma: {1}</th><th>error: "
      "{0}</th><th>error: "
      "{1}</th><th>difference</th><th>sigma of it</th></tr>\n",
      family.first, family.second);
  for (const MethodPair& pair : family.pairs) {
    table += fmt::format("<tr><th>{}, {}</th>", pair.a.str(), pair.b.str());
    for (const auto part : {&MethodSample::sigma_first, &MethodSample::sigma_second, &MethodSample::error_first,
                            &MethodSample::error_second, &MethodSample::difference, &MethodSample::sigma_difference})
      table += Norms(pair, part);
    table += "</tr>\n";
  }
  return table + "</table></div>\n";
}

std::string Verdict(const MethodFamily& family) {
  return fmt::format(
      "<p>Of {} differences (visits, pairs and axes) {:.1f} % are within 3 of their sigmas; their rms is {:.2f} "
      "sigmas. {}"
      "</p>\n",
      family.coordinates, 100 * family.within_3_sigma_ratio, family.rms_sigmas,
      family.within_3_sigma_ratio < 0.95
          ? "The methods differ by more than the captures explain: that part is the method's own."
          : (family.rms_sigmas < 0.7
                 ? "The sigmas are careful: they hold more than the methods differ by."
                 : "The captures explain the difference: no uncertainty of the method is left over."));
}

}  // namespace

Section MethodSection(const MethodExperiment& experiment) {
  Section section;
  section.html =
      "<h2>(d) The uncertainty of the method</h2>\n<p>The paper names two sources of a pair's uncertainty, the method "
      "and "
      "the data, and its jackknife sees the data only. So one pair is calibrated by two methods from the same "
      "captures, "
      "and their difference is held against its own sigma: errors that both share (corners, lenses) cancel in it, "
      "whatever a method adds of its own does not. Rms over the visits of (b).</p>\n";
  for (std::size_t k = 0; k < experiment.families.size(); ++k) {
    const MethodFamily& family = experiment.families[k];
    section.html += fmt::format("<h3>{} against {}</h3>\n", family.first, family.second);
    section.html += Figure(fmt::format("method-{}", k + 1), Plot(family),
                           "Dots: one axis of one visit each. Dashed: 3 sigmas.", section);
    section.html += Table(family) + Verdict(family);
  }
  return section;
}

}  // namespace rigcal::paper
