#include "server/report/certificate/figures.h"

#include <algorithm>
#include <cmath>

#include "server/math/statistics.h"
#include "server/report/text/sigmas.h"

namespace rigcal::report {
namespace {

constexpr double kProbability = 0.95, kFoundCoverage = 2.0;

// The larger of three axes, one sigma; absent: not known.
std::optional<double> WorstAxisSigma(const Matrix6d& covariance, int first_axis) {
  const double variance = covariance.diagonal().segment<3>(first_axis).maxCoeff();
  if (!covariance.diagonal().allFinite() || !(variance > 0.0)) return std::nullopt;
  return std::sqrt(variance);
}

Conformity DecisionOf(const CertifiedFigure& figure) {
  if (!figure.limit) return Conformity::kNoLimit;
  if (figure.sigma && *figure.sigma > *figure.limit) return Conformity::kBeyond;
  return figure.U ? Decide(0.0, *figure.U, *figure.limit) : Conformity::kOpen;
}

CertifiedFigure FigureOf(std::optional<double> sigma, std::optional<double> k, std::optional<double> limit) {
  CertifiedFigure figure{sigma, {}, limit};
  if (k && sigma) figure.U = *k * *sigma;
  figure.decision = DecisionOf(figure);
  return figure;
}

RestSigma SigmasOf(const SensorPose& pose, const formats::RevisionInput& revision) {
  if (!pose.known) return WorstSigmaOf(AxesOf(pose, revision.solution.R_ref_robot));
  return {WorstAxisSigma(pose.covariance, tangent::kTranslation), WorstAxisSigma(pose.covariance, tangent::kRotation)};
}

FoundFigure FoundFigureOf(const SensorFound& found, int first_axis, std::optional<double> limit, bool needs_all) {
  FoundFigure figure;
  figure.limit = limit;
  if (limit) figure.decision = Conformity::kWithin;
  int measured = 0;
  for (int axis = first_axis; axis < first_axis + 3; ++axis) {
    if (!IsMeasured(found, axis)) continue;
    ++measured;
    const double off = std::abs(found.change(axis)), U = kFoundCoverage * found.sigma(axis);
    if (off >= figure.off.value_or(0.0)) figure.off = off, figure.U = U;
    if (found.left) figure.left = std::max(figure.left.value_or(0.0), std::abs((*found.left)(axis)));
    if (limit) figure.decision = std::max(figure.decision, Decide(off, U, *limit));
  }
  if (limit && (measured == 0 || (needs_all && measured < 3)))
    figure.decision = std::max(figure.decision, Conformity::kOpen);
  return figure;
}

}  // namespace

Conformity Decide(double off, double U, double limit) {
  if (std::abs(off) + U <= limit) return Conformity::kWithin;
  return std::abs(off) - U > limit ? Conformity::kBeyond : Conformity::kOpen;
}

Conformity Worse(Conformity a, Conformity b) {
  if (a == Conformity::kNoLimit || b == Conformity::kNoLimit) return Conformity::kNoLimit;
  return std::max(a, b);
}

std::optional<double> CoverageFactor(const SensorPose& pose) {
  if (pose.known && pose.dof == 0.0) return std::sqrt(ChiSquareQuantile(kProbability, 1.0));
  if (!(pose.dof > 0.0)) return std::nullopt;
  const double k = StudentQuantile(0.5 * (1.0 + kProbability), pose.dof);
  return std::isfinite(k) ? std::optional(k) : std::nullopt;
}

CertifiedPose CertifiedPoseOf(const SensorPose& pose, const formats::RevisionInput& revision) {
  CertifiedPose certified;
  certified.k = CoverageFactor(pose);
  const std::optional<PoseLimit> limit = ToleranceOf(revision, pose.sensor);
  const RestSigma sigma = SigmasOf(pose, revision);
  certified.shift = FigureOf(sigma.m, certified.k, limit ? std::optional(limit->m) : std::nullopt);
  certified.turn = FigureOf(sigma.rad, certified.k, limit ? std::optional(limit->rad) : std::nullopt);
  certified.decision = Worse(certified.shift.decision, certified.turn.decision);
  return certified;
}

FoundFigures FoundFiguresOf(const SensorFound& found, const std::optional<PoseLimit>& limit, bool needs_all) {
  FoundFigures figures;
  figures.shift =
      FoundFigureOf(found, tangent::kTranslation, limit ? std::optional(limit->m) : std::nullopt, needs_all);
  figures.turn = FoundFigureOf(found, tangent::kRotation, limit ? std::optional(limit->rad) : std::nullopt, needs_all);
  figures.decision = Worse(figures.shift.decision, figures.turn.decision);
  return figures;
}

}  // namespace rigcal::report
