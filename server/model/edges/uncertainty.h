// The uncertainty of a pairwise pose T_a_b, whole: as it is kept in memory, on the wire, in SQL and in JSON.
#pragma once

#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/math/covariance.h"

namespace rigcal {

enum class UncertaintySource { kJackknife, kModel, kGiven, kAssumed };  // "jackknife" | "model" | "given" | "assumed"
// The spelling in documents, and back: kInvalidInput, with the known ones, for any other.
[[nodiscard]] std::string NameOf(UncertaintySource source);
[[nodiscard]] Result<UncertaintySource> UncertaintySourceOf(const std::string& name);

// d = Log(T^-1 T_(i)) of the answer without block i; right tangent at b, [m m m rad rad rad].
struct BlockVector {
  std::string block_id;  // the capture's id
  Vector6d d = Vector6d::Zero();
};
// Only the vectors, in their order.
[[nodiscard]] inline std::vector<Vector6d> VectorsOf(const std::vector<BlockVector>& blocks) {
  std::vector<Vector6d> d;
  for (const BlockVector& block : blocks) d.push_back(block.d);
  return d;
}

// A part of the covariance that given constants bring (board size, given intrinsics): already inside Omega.
struct Contribution {
  std::string name;
  Matrix6d covariance = Matrix6d::Zero();
  // Per constant, what one sigma of it changes (right tangent at b); the covariance is the sum of their squares. Edges
  // of one session with a contribution of one name err by them together. Empty: not known, taken as the edge's own.
  std::vector<Vector6d> shifts = {};
};

struct Uncertainty {
  Matrix6d Omega = Matrix6d::Zero();  // information, positive semi-definite, as received or estimated
  int rank = 0;                       // of Omega
  int dof = 0;  // degrees of freedom behind the estimate (m - 1 for a jackknife); 0: known exactly
  UncertaintySource source = UncertaintySource::kAssumed;
  Matrix6d covariance = Matrix6d::Zero();                       // on the observable subspace (derived from Omega)
  Eigen::Matrix<double, 6, Eigen::Dynamic> unobservable_basis;  // 6 x (6 - rank) (derived from Omega)
  std::vector<BlockVector> blocks;
  std::vector<Contribution> contributions;
  // As edges of before tell it: what the blocks made of the covariance without contributions; 0: not told.
  double jackknife_ratio = 0.0;
};

// Fills rank, covariance and unobservable_basis from Omega.
[[nodiscard]] Uncertainty FromInformation(const Matrix6d& Omega, UncertaintySource source, int dof);
// Covariance must be positive definite.
[[nodiscard]] Result<Uncertainty> FromCovariance(const Matrix6d& covariance, UncertaintySource source, int dof);
// Finite, symmetric, positive semi-definite, with a finite inverse where it has rank; rank and block vectors
// consistent. The error names the field.
[[nodiscard]] Status Validate(const Uncertainty& uncertainty);

// Standard deviations for people. NaN never: an unobservable axis has no number.
struct AxisSigma {
  bool known = false;
  double value = 0.0;
};  // m or rad
// `axis` as in tangent.h, 0 to 5; not known: outside of that, unobservable by more than 1e-6, or not finite.
[[nodiscard]] AxisSigma SigmaOf(const Uncertainty& uncertainty, int axis);

}  // namespace rigcal
