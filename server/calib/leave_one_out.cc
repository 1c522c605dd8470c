#include "server/calib/leave_one_out.h"

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

}  // namespace

Result<std::vector<BlockVector>> LeaveOneOut(const std::vector<std::string>& block_ids, const WithoutBlock& without) {
  std::vector<std::optional<Result<Vector6d>>> vectors(block_ids.size());
  ParallelFor(vectors.size(), [&](std::size_t i) { vectors[i] = without(i); });
  std::vector<BlockVector> blocks;
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    if (!*vectors[i])
      return Fail(ErrorCode::kInvalidInput, "without capture " + block_ids[i] + " the pair cannot be solved",
                  "Take more captures like it, so that the result does not hang on a single one.");
    blocks.push_back({block_ids[i], **vectors[i]});
  }
  return blocks;
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
  }
  return contributions;
}

Result<Uncertainty> UncertaintyOf(const Matrix6d& C_model, std::vector<BlockVector> blocks,
                                  std::vector<Contribution> contributions, std::size_t captures) {
  const int m = static_cast<int>(captures);
  Matrix6d C = C_model;
  if (!blocks.empty()) {
    std::vector<Vector6d> d;
    for (const BlockVector& block : blocks) d.push_back(block.d);
    C = ShrinkTowardsModel(JackknifeCovariance(d), C_model, m);
  }
  for (const Contribution& contribution : contributions) C += contribution.covariance;
  const auto source = blocks.empty() ? UncertaintySource::kModel : UncertaintySource::kJackknife;
  RIGCAL_ASSIGN(Uncertainty uncertainty, FromCovariance(C, source, m - 1));
  uncertainty.blocks = std::move(blocks);
  uncertainty.contributions = std::move(contributions);
  return uncertainty;
}

}  // namespace rigcal::calib
