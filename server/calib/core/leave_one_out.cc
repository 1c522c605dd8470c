#include "server/calib/core/leave_one_out.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "server/base/process/parallel_for.h"
#include "server/math/jackknife.h"

namespace rigcal::calib {
namespace {

Result<Vector6d> ShiftOf(const GivenConstant& constant) {
  RIGCAL_ASSIGN(const Se3 plus, constant.T_a_b(1));
  RIGCAL_ASSIGN(const Se3 minus, constant.T_a_b(-1));
  return Vector6d(0.5 * (minus.Inverse() * plus).Log());
}

// With what the captures and the given constants add. Without blocks the model's stands for the captures.
Matrix6d CovarianceOf(const Matrix6d& C_model, const std::vector<BlockVector>& blocks,
                      const std::vector<Contribution>& contributions) {
  Matrix6d C = C_model;
  if (!blocks.empty()) C = JackknifeOrModel(VectorsOf(blocks), C_model);
  for (const Contribution& contribution : contributions) C += contribution.covariance;
  return C;
}

// At least one: none would say that nothing was estimated.
int DofOf(std::size_t carrying) { return carrying > 2 ? static_cast<int>(carrying) - 1 : 1; }

UncertaintySource SourceOf(const std::vector<BlockVector>& blocks) {
  return blocks.empty() ? UncertaintySource::kModel : UncertaintySource::kJackknife;
}

Uncertainty With(std::vector<BlockVector> blocks, std::vector<Contribution> contributions, Uncertainty uncertainty) {
  uncertainty.blocks = std::move(blocks);
  uncertainty.contributions = std::move(contributions);
  return uncertainty;
}

}  // namespace

Result<std::vector<BlockVector>> LeaveOneOut(const std::vector<std::string>& block_ids, const Se3& T_a_b,
                                             const WithoutBlock& without) {
  std::vector<std::optional<Result<Se3>>> poses(block_ids.size());
  ParallelFor(poses.size(), [&](std::size_t i) { poses[i] = without(i); });
  std::vector<BlockVector> blocks;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!*poses[i])
      return Fail(ErrorCode::kInvalidInput, "without capture " + block_ids[i] + " the pair cannot be solved",
                  "Take more captures like it, so that the result does not hang on a single one.");
    blocks.push_back({block_ids[i], (T_a_b.Inverse() * **poses[i]).Log()});
  }
  return blocks;
}

void AddBoardSize(const Target& board, double sigma_ratio, const WithSize& solved,
                  std::vector<GivenConstant>& constants) {
  if (!(sigma_ratio > 0)) return;
  constants.push_back({"size of board " + board.id.str(), [=](double steps) { return solved(steps * sigma_ratio); }});
}

std::string IntrinsicsName(const SensorId& camera) { return "intrinsics of " + camera.str(); }

Result<std::vector<Contribution>> ContributionsOf(const std::vector<GivenConstant>& constants) {
  std::vector<std::optional<Result<Vector6d>>> shifts(constants.size());
  ParallelFor(shifts.size(), [&](std::size_t i) { shifts[i] = ShiftOf(constants[i]); });
  std::vector<Contribution> contributions;
  for (std::size_t i = 0; i < constants.size(); ++i) {
    if (!*shifts[i]) return Fail(shifts[i]->error());
    if (contributions.empty() || contributions.back().name != constants[i].name)
      contributions.push_back({constants[i].name, Matrix6d::Zero()});
    contributions.back().covariance += **shifts[i] * (*shifts[i])->transpose();
    contributions.back().shifts.push_back(**shifts[i]);
  }
  return contributions;
}

Result<Uncertainty> UncertaintyOf(const Matrix6d& C_model, std::vector<BlockVector> blocks,
                                  std::vector<Contribution> contributions, std::size_t carrying) {
  const Matrix6d C = CovarianceOf(C_model, blocks, contributions);
  RIGCAL_ASSIGN(Uncertainty uncertainty, FromCovariance(C, SourceOf(blocks), DofOf(carrying)));
  return With(std::move(blocks), std::move(contributions), std::move(uncertainty));
}

Result<Uncertainty> UncertaintyAlong(const Directions& free, const Eigen::MatrixXd& C_model_along,
                                     std::vector<BlockVector> blocks, std::vector<Contribution> contributions,
                                     std::size_t carrying) {
  const Matrix6d onto = free * free.transpose(), C_model = free * C_model_along * free.transpose();
  for (BlockVector& block : blocks) block.d = onto * block.d;
  for (Contribution& contribution : contributions) {
    contribution.covariance = Symmetrized(onto * contribution.covariance * onto);
    for (Vector6d& shift : contribution.shifts) shift = onto * shift;
  }
  if (free.cols() == 6)
    return UncertaintyOf(Symmetrized(C_model), std::move(blocks), std::move(contributions), carrying);
  const Matrix6d C = CovarianceOf(C_model, blocks, contributions);
  const Eigen::MatrixXd along = free.transpose() * C * free;
  const Eigen::LLT<Eigen::MatrixXd> llt(along);
  if (llt.info() != Eigen::Success || !along.allFinite())
    return Fail(ErrorCode::kInvalidInput, "the covariance is not positive definite",
                "Take more captures from different places.");
  const Eigen::MatrixXd information = llt.solve(Eigen::MatrixXd::Identity(free.cols(), free.cols()));
  Uncertainty uncertainty =
      FromInformation(Symmetrized(free * information * free.transpose()), SourceOf(blocks), DofOf(carrying));
  return With(std::move(blocks), std::move(contributions), std::move(uncertainty));
}

namespace {

constexpr double kGroupsFrom_rad = -M_PI / 4, kGroup_rad = M_PI / 2 / kBeamGroups;

}  // namespace

std::size_t BeamGroupOf(const Eigen::Vector3f& p_m) {
  const double elevation_rad = std::atan2(p_m.z(), std::hypot(p_m.x(), p_m.y()));
  const double at = std::floor((elevation_rad - kGroupsFrom_rad) / kGroup_rad);
  return static_cast<std::size_t>(std::clamp(at, 0.0, kBeamGroups - 1.0));
}

std::string SingleBeamsOf(const SensorId& lidar) { return "range biases of single beams of " + lidar.str(); }

void MarkBeams(const PlanePatch& patch, std::vector<char>& seen) {
  for (const Eigen::Vector3f& p : patch.points_m) seen[BeamGroupOf(p)] = 1;
}

PlanePatch WithBeamsMoved(PlanePatch patch, std::size_t group, double longer_m) {
  for (Eigen::Vector3f& p : patch.points_m)
    if (BeamGroupOf(p) == group) p += static_cast<float>(longer_m) * p.normalized();
  return patch;
}

void AddRangeBias(const SensorId& lidar, double sigma_m, const WithRanges& solved,
                  std::vector<GivenConstant>& constants) {
  if (!(sigma_m > 0)) return;
  constants.push_back({"range bias of " + lidar.str(), [=](double steps) { return solved(steps * sigma_m); }});
}

void AddBeams(const Sensor& lidar, const std::vector<char>& seen, const Se3& T_a_b, const WithBeams& solved,
              std::vector<GivenConstant>& constants) {
  const double sigma_m = lidar.range_bias_sigma_m.value_or(0.0);
  if (!(sigma_m > 0)) return;
  for (std::size_t group = 0; group < seen.size(); ++group)
    constants.push_back({SingleBeamsOf(lidar.id), [=, is_seen = seen[group]](double steps) -> Result<Se3> {
                           return is_seen == 0 ? T_a_b : solved(group, steps * sigma_m);
                         }});
}

}  // namespace rigcal::calib
