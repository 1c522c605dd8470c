#include "server/calib/core/leave_one_out.h"

#include <Eigen/Cholesky>
#include <optional>

#include "server/base/parallel_for.h"
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

std::vector<Vector6d> VectorsOf(const std::vector<BlockVector>& blocks) {
  std::vector<Vector6d> d;
  for (const BlockVector& block : blocks) d.push_back(block.d);
  return d;
}

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
  const auto source = blocks.empty() ? UncertaintySource::kModel : UncertaintySource::kJackknife;
  RIGCAL_ASSIGN(Uncertainty uncertainty, FromCovariance(C, source, DofOf(carrying)));
  uncertainty.blocks = std::move(blocks);
  uncertainty.contributions = std::move(contributions);
  return uncertainty;
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
  const auto source = blocks.empty() ? UncertaintySource::kModel : UncertaintySource::kJackknife;
  Uncertainty uncertainty =
      FromInformation(Symmetrized(free * information * free.transpose()), source, DofOf(carrying));
  uncertainty.blocks = std::move(blocks);
  uncertainty.contributions = std::move(contributions);
  return uncertainty;
}

}  // namespace rigcal::calib
