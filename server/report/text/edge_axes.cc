#include "server/report/text/edge_axes.h"

#include <algorithm>
#include <cmath>

#include "server/model/edges/merged_edge.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

std::string InUnit(double value, int axis) { return axis < tangent::kRotation ? SigmaMm(value) : SigmaDeg(value); }

std::string SourceText(const Edge& edge) {
  const Uncertainty& uncertainty = edge.uncertainty;
  if (IsMerged(edge)) return "\xCF\x83 from those of its edges.";
  switch (uncertainty.source) {
    case UncertaintySource::kJackknife:
      return "\xCF\x83 from leaving out one of " + std::to_string(uncertainty.dof + 1UL) +
             " captures, or groups of captures, at a time.";
    case UncertaintySource::kModel:
      return "\xCF\x83 from the model alone: too few captures to test it.";
    case UncertaintySource::kGiven:
      return "\xCF\x83 as given with the edge.";
    case UncertaintySource::kAssumed:
      break;
  }
  return "\xCF\x83 is an assumption.";
}

// "z", or "(x 0.71, rz -0.71)": the entries of a direction that matter. Its sign has no meaning: the first is positive.
std::string DirectionText(const Vector6d& direction) {
  constexpr double kShown = 0.05;
  std::string text, name;
  int count = 0;
  double sign = 1.0;
  for (int axis = 0; axis < 6; ++axis) {
    if (std::abs(direction(axis)) <= kShown) continue;
    name = tangent::kNames[static_cast<std::size_t>(axis)];
    if (count++ == 0) sign = direction(axis) < 0 ? -1.0 : 1.0;
    text.append(count == 1 ? "(" : ", ").append(name).append(" ").append(Fixed(sign * direction(axis), 2));
  }
  return count == 1 ? name : text + ")";
}

}  // namespace

std::string AxisSigmaText(const Uncertainty& uncertainty, int axis) {
  const AxisSigma sigma = SigmaOf(uncertainty, axis);
  return sigma.known && std::isfinite(sigma.value) ? InUnit(sigma.value, axis) : "free";
}

std::string ThreeSigmas(const Uncertainty& uncertainty, int first_axis) {
  std::string text;
  for (int axis = first_axis; axis < first_axis + 3; ++axis)
    text += (text.empty() ? "" : " / ") + AxisSigmaText(uncertainty, axis);
  return text;
}

std::string SigmaKey(const Uncertainty& uncertainty, int first_axis) {
  double largest = -1.0;
  for (int axis = first_axis; axis < first_axis + 3; ++axis)
    if (const AxisSigma sigma = SigmaOf(uncertainty, axis); sigma.known && std::isfinite(sigma.value))
      largest = std::max(largest, sigma.value * (axis < tangent::kRotation ? kMmPerMetre : kDegPerRad));
  return largest < 0.0 ? "" : Significant(largest, 6);
}

std::string LargestSigma(const Uncertainty& uncertainty, int first_axis, const std::string& unit) {
  double largest = -1.0;
  std::string free;
  for (int axis = first_axis; axis < first_axis + 3; ++axis) {
    const AxisSigma sigma = SigmaOf(uncertainty, axis);
    if (sigma.known && std::isfinite(sigma.value))
      largest = std::max(largest, sigma.value);
    else
      free.append(free.empty() ? "" : " ").append(tangent::kNames[static_cast<std::size_t>(axis)]);
  }
  if (largest < 0.0) return "free";
  return InUnit(largest, first_axis) + unit + (free.empty() ? "" : ", free: " + free);
}

std::string ObservabilityText(const Edge& edge) {
  const Uncertainty& uncertainty = edge.uncertainty;
  const auto& basis = uncertainty.unobservable_basis;
  if (uncertainty.rank >= 6) return "All 6 directions are observed. " + SourceText(edge);
  std::string text = std::to_string(uncertainty.rank) + " of 6 directions are observed";
  for (Eigen::Index column = 0; column < basis.cols(); ++column)
    text += (column == 0 ? "; free: " : ", ") + DirectionText(basis.col(column));
  return text + ". " + SourceText(edge);
}

}  // namespace rigcal::report
