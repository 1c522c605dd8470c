// What every estimator does with its captures and given constants: leave one out, move one, put the uncertainty
// together.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/calib/core/capture_blocks.h"
#include "server/calib/core/directions.h"
#include "server/model/uncertainty.h"

namespace rigcal::calib {

// The answer without block i.
using WithoutBlock = std::function<Result<Se3>(std::size_t block_idx)>;
// d = Log(T^-1 T_(i)) of every block, in parallel; in the order of the names. The error names the block without which
// there is no answer.
[[nodiscard]] Result<std::vector<BlockVector>> LeaveOneOut(const std::vector<std::string>& block_ids, const Se3& T_a_b,
                                                           const WithoutBlock& without);

// Only the vectors, in their order.
[[nodiscard]] std::vector<Vector6d> VectorsOf(const std::vector<BlockVector>& blocks);

// A constant that was given with a sigma.
struct GivenConstant {
  std::string name;                                // constants of one name, side by side, are one contribution
  std::function<Result<Se3>(double steps)> T_a_b;  // the answer with the constant moved by `steps` sigma
};
// Sum of (dT/dtheta) sigma^2 (dT/dtheta)^T per name, by central differences over one sigma either way; in parallel.
[[nodiscard]] Result<std::vector<Contribution>> ContributionsOf(const std::vector<GivenConstant>& constants);

// Jackknife or model, whichever is larger, the model alone where there are no blocks, and the contributions. `carrying`
// is the number of blocks with captures that carry T_a_b: degrees of freedom count them also for the model, whose
// residuals are not independent.
[[nodiscard]] Result<Uncertainty> UncertaintyOf(const Matrix6d& C_model, std::vector<BlockVector> blocks,
                                                std::vector<Contribution> contributions, std::size_t carrying);

// The same where the answer is estimated along some directions only (orthonormal columns, right tangent at b): the rest
// carries no information.
[[nodiscard]] Result<Uncertainty> UncertaintyAlong(const Directions& free, const Eigen::MatrixXd& C_model_along,
                                                   std::vector<BlockVector> blocks,
                                                   std::vector<Contribution> contributions, std::size_t carrying);

}  // namespace rigcal::calib
