#include "server/model/edges/uncertainty.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "server/base/text.h"

namespace rigcal {
namespace {

constexpr int kDofMax = 1'000'000'000;  // one more is a number too

Status Refuse(const std::string& what, const std::string& cure) { return Fail(ErrorCode::kInvalidInput, what, cure); }

std::string RankText(int rank) { return std::to_string(rank) + " of 6"; }

Status CheckInformation(const Matrix6d& Omega) {
  if (!Omega.allFinite()) return Refuse("information: an entry is not finite", "Give 36 finite numbers.");
  if (!IsPositiveSemidefinite(Omega))
    return Refuse("information: the matrix is not symmetric and positive semi-definite",
                  "Give the inverse of a covariance; check the order [x y z rx ry rz] and the units m and rad.");
  return {};
}

Status CheckBlock(const BlockVector& block) {
  if (block.block_id.empty() || !IsPrintableUtf8(block.block_id))
    return Refuse("block id " + Quoted(block.block_id) + " is not readable text", "Name the capture of each block.");
  if (!block.d.allFinite())
    return Refuse("block vector of " + Quoted(block.block_id) + " is not finite", "Give 6 finite numbers.");
  return {};
}

Status CheckBlocks(const Uncertainty& uncertainty) {
  for (const BlockVector& block : uncertainty.blocks) RIGCAL_TRY(CheckBlock(block));
  const std::size_t count = uncertainty.blocks.size();
  if (uncertainty.source == UncertaintySource::kJackknife && count < 2)
    return Refuse("blocks: a jackknife uncertainty has " + std::to_string(count) + " block vectors",
                  "Give at least two, or name another source.");
  return {};
}

Status CheckNumbers(const Uncertainty& uncertainty) {
  if (uncertainty.dof < 0)
    return Refuse("dof: " + std::to_string(uncertainty.dof) + " is negative", "Give 0 where the uncertainty is known.");
  if (uncertainty.dof > kDofMax)
    return Refuse("dof: " + std::to_string(uncertainty.dof) + " is more than anyone has measured",
                  "Give the number of captures less one, or 0 where the uncertainty is known.");
  const double ratio = uncertainty.jackknife_ratio;
  if (!(ratio >= 0.0 && ratio <= 1.0))
    return Refuse("jackknife_ratio: it is not between 0 and 1",
                  "Give what the blocks made of the covariance, or leave it away.");
  if (ratio > 0.0 && uncertainty.source != UncertaintySource::kJackknife)
    return Refuse("jackknife_ratio: the source is " + NameOf(uncertainty.source) + ", not jackknife",
                  "Leave it away, or name the source.");
  return {};
}

Status CheckContributions(const std::vector<Contribution>& contributions) {
  for (const Contribution& part : contributions) {
    if (part.name.empty() || !IsPrintableUtf8(part.name))
      return Refuse("contribution " + Quoted(part.name) + " is not readable text", "Name what it comes from.");
    if (!IsPositiveSemidefinite(part.covariance))
      return Refuse("contribution " + Quoted(part.name) + ": the covariance is not positive semi-definite",
                    "Give a symmetric 6x6 covariance in m and rad.");
    for (const Vector6d& shift : part.shifts)
      if (!shift.allFinite())
        return Refuse("contribution " + Quoted(part.name) + ": a shift is not finite", "Give finite numbers, or none.");
  }
  return {};
}

}  // namespace

std::string NameOf(UncertaintySource source) {
  switch (source) {
    case UncertaintySource::kJackknife:
      return "jackknife";
    case UncertaintySource::kModel:
      return "model";
    case UncertaintySource::kGiven:
      return "given";
    case UncertaintySource::kAssumed:
      return "assumed";
  }
  return "assumed";
}

Result<UncertaintySource> UncertaintySourceOf(const std::string& name) {
  for (UncertaintySource source : {UncertaintySource::kJackknife, UncertaintySource::kModel, UncertaintySource::kGiven,
                                   UncertaintySource::kAssumed})
    if (NameOf(source) == name) return source;
  return Fail(ErrorCode::kInvalidInput, "source " + Quoted(name) + " of an uncertainty is not known",
              "Use jackknife, model, given or assumed.");
}

Uncertainty FromInformation(const Matrix6d& Omega, UncertaintySource source, int dof) {
  ObservableSubspace observable = Observable(Omega);
  Uncertainty uncertainty;
  uncertainty.Omega = Omega;
  uncertainty.rank = observable.rank;
  uncertainty.dof = dof;
  uncertainty.source = source;
  uncertainty.covariance = observable.covariance;
  uncertainty.unobservable_basis = std::move(observable.unobservable_basis);
  return uncertainty;
}

Result<Uncertainty> FromCovariance(const Matrix6d& covariance, UncertaintySource source, int dof) {
  const auto refused = [](const std::string& why) {
    return Fail(
        ErrorCode::kInvalidInput, "covariance: " + why,
        "Give a positive definite 6x6 covariance, order [x y z rx ry rz], in m and rad; where a direction is not "
        "known, give the information matrix instead.");
  };
  if (!covariance.allFinite()) return refused("an entry is not finite");
  if (!IsPositiveSemidefinite(covariance)) return refused("the matrix is not symmetric and positive definite");
  const ObservableSubspace inverse = Observable(covariance);
  if (inverse.rank < 6) return refused("the matrix is singular, its rank is " + RankText(inverse.rank));
  Uncertainty uncertainty = FromInformation(inverse.covariance, source, dof);
  if (uncertainty.rank < 6) return refused("the matrix is too badly conditioned to invert");
  uncertainty.covariance = Symmetrized(covariance);
  return uncertainty;
}

Status Validate(const Uncertainty& uncertainty) {
  RIGCAL_TRY(CheckInformation(uncertainty.Omega));
  const ObservableSubspace observable = Observable(uncertainty.Omega);
  const int rank = observable.rank;
  if (!observable.covariance.allFinite())
    return Refuse("information: the matrix is too badly conditioned to invert",
                  "Check the units of its entries; they are for m and rad.");
  if (uncertainty.rank != rank)
    return Refuse(
        "rank: " + std::to_string(uncertainty.rank) + " is given, the information matrix has rank " + RankText(rank),
        "Leave the rank away or correct it.");
  RIGCAL_TRY(CheckNumbers(uncertainty));
  RIGCAL_TRY(CheckBlocks(uncertainty));
  return CheckContributions(uncertainty.contributions);
}

AxisSigma SigmaOf(const Uncertainty& uncertainty, int axis) {
  constexpr double kUnobservableShare = 1e-6;
  if (axis < 0 || axis > 5 || uncertainty.rank == 0) return {};
  const auto& unobservable = uncertainty.unobservable_basis;
  if (unobservable.cols() > 0 && unobservable.row(axis).norm() > kUnobservableShare) return {};
  const double variance = uncertainty.covariance(axis, axis);
  if (!(variance >= 0.0) || !std::isfinite(variance)) return {};
  return {true, std::sqrt(variance)};
}

}  // namespace rigcal
