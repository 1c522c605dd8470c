// What every estimator does with its captures and given constants: leave one out, move one, put the uncertainty
// together.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "server/calib/core/capture_blocks.h"
#include "server/calib/core/directions.h"
#include "server/model/edges/uncertainty.h"
#include "server/model/sensors/features.h"
#include "server/model/sensors/target.h"
#include "server/model/sessions/session.h"

namespace rigcal::calib {

// Of a problem that is solved again, without some captures or with a constant moved: a step that loses what linear
// residuals would, to this part of it, ends it. About three times that part of the move is left out.
constexpr double kLinearAgain_ratio = 3e-4;

// The answer without block i.
using WithoutBlock = std::function<Result<Se3>(std::size_t block_idx)>;
// d = Log(T^-1 T_(i)) of every block, in parallel; in the order of the names. The error names the block without which
// there is no answer.
[[nodiscard]] Result<std::vector<BlockVector>> LeaveOneOut(const std::vector<std::string>& block_ids, const Se3& T_a_b,
                                                           const WithoutBlock& without);

// A constant that was given with a sigma.
struct GivenConstant {
  std::string name;                                // constants of one name, side by side, are one contribution
  std::function<Result<Se3>(double steps)> T_a_b;  // the answer with the constant moved by `steps` sigma
};
// The answer with all boards larger by a part of their size.
using WithSize = std::function<Result<Se3>(double larger_ratio)>;
// "size of board ID", solved anew at every call. Without a sigma nothing is added.
void AddBoardSize(const Target& board, double sigma_ratio, const WithSize& solved,
                  std::vector<GivenConstant>& constants);
// Of the contribution of a camera's given intrinsics.
[[nodiscard]] std::string IntrinsicsName(const SensorId& camera);
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

// What errs of a lidar's ranges alike in all captures: all of them by one bias, and beams of a turning lidar each by a
// constant of its own. Which beam took a point is not said: points whose elevation is the same to 1.5 degrees count as
// of one beam, the same groups in every problem of a lidar.

constexpr std::size_t kBeamGroups = 60;
// By elevation above the plane across the lidar's z, about which beams turn; what is steeper belongs to the last.
[[nodiscard]] std::size_t BeamGroupOf(const Eigen::Vector3f& p_m);
// Of the contribution of these constants: the same in all edges of the lidar, group by group, so that a graph knows
// them for the same.
[[nodiscard]] std::string SingleBeamsOf(const SensorId& lidar);

void MarkBeams(const PlanePatch& patch, std::vector<char>& seen);  // `seen`: kBeamGroups long
// The patch with the ranges of one group longer.
[[nodiscard]] PlanePatch WithBeamsMoved(PlanePatch patch, std::size_t group, double longer_m);

// The answer with all ranges, or those of one group of beams, longer by so much.
using WithRanges = std::function<Result<Se3>(double longer_m)>;
using WithBeams = std::function<Result<Se3>(std::size_t group, double longer_m)>;
// "range bias of LIDAR", solved anew at every call. Without a sigma nothing is added.
void AddRangeBias(const SensorId& lidar, double sigma_m, const WithRanges& solved,
                  std::vector<GivenConstant>& constants);
// Every group errs by the lidar's range_bias_sigma_m alone as well; those not in `seen` leave the answer T_a_b. One
// constant per group, so that edges of a lidar share them by their order.
void AddBeams(const Sensor& lidar, const std::vector<char>& seen, const Se3& T_a_b, const WithBeams& solved,
              std::vector<GivenConstant>& constants);

}  // namespace rigcal::calib
