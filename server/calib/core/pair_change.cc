#include "server/calib/core/pair_change.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "server/calib/core/capture_blocks.h"
#include "server/math/covariance.h"
#include "server/math/statistics.h"
#include "server/math/tangent.h"

namespace rigcal::calib {
namespace {

constexpr double kRounding = 1e-9;  // of scatter scaled to unit diagonal: less is a direction that nothing tells
constexpr double kPower = 0.95, kPowerSigmas = 1.645;  // P(z < kPowerSigmas) = kPower

struct Influences {
  std::vector<std::string> ids;  // in the order in which captures were taken
  Eigen::Matrix<double, 6, Eigen::Dynamic> x;
};
Influences InfluencesOf(std::vector<BlockVector> blocks) {
  std::sort(blocks.begin(), blocks.end(), [](const BlockVector& a, const BlockVector& b) {
    return TakenBefore()(CaptureId(a.block_id), CaptureId(b.block_id));
  });
  const auto m = static_cast<Eigen::Index>(blocks.size());
  Influences influences;
  influences.x.resize(6, m);
  for (Eigen::Index i = 0; i < m; ++i) {
    influences.ids.push_back(blocks[static_cast<std::size_t>(i)].block_id);
    influences.x.col(i) = blocks[static_cast<std::size_t>(i)].d;
  }
  const Vector6d mean = influences.x.rowwise().mean();
  influences.x = -static_cast<double>(m - 1) * (influences.x.colwise() - mean);
  return influences;
}

struct PseudoInverse {
  Matrix6d matrix = Matrix6d::Zero();
  int rank = 0;
};
PseudoInverse InverseOf(const Matrix6d& S) {
  const Vector6d scale = UnitDiagonal(S);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> axes(scale.asDiagonal() * S * scale.asDiagonal());
  PseudoInverse inverse;
  Vector6d inverted = Vector6d::Zero();
  for (int i = 0; i < 6; ++i)
    if (axes.eigenvalues()[i] > kRounding) inverted[i] = 1 / axes.eigenvalues()[i], ++inverse.rank;
  const Matrix6d half = scale.asDiagonal() * axes.eigenvectors();
  inverse.matrix = half * inverted.asDiagonal() * half.transpose();
  return inverse;
}

// A change before block `at`.
struct Change {
  Eigen::Index at = 0;
  Vector6d step = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero(), information = Matrix6d::Zero();  // of the step
  double statistic = 0.0, dof = 0.0;                                       // an F of `rank` and `dof`
  int rank = 0;
};

// As how many blocks that do not err alike these count: neighbours have in common what they are seen to, all axes
// together, and two standard errors of it more.
double IndependentBlocks(const Eigen::Matrix<double, 6, Eigen::Dynamic>& within, const PseudoInverse& of_scatter) {
  const Eigen::Index m = within.cols();
  const auto numbers = static_cast<double>(of_scatter.rank * m);
  double seen = 0.0;
  for (Eigen::Index i = 1; i < m; ++i) seen += within.col(i - 1).dot(of_scatter.matrix * within.col(i)) / numbers;
  const double alike = std::clamp(seen + 2 / std::sqrt(numbers), 0.0, 0.95);
  return static_cast<double>(m) * (1 - alike) / (1 + alike);
}

Change ChangeAt(const Influences& influences, Eigen::Index at) {
  const Eigen::Index m = influences.x.cols(), after = m - at;
  Change change;
  change.at = at;
  const Vector6d before = influences.x.leftCols(at).rowwise().mean(),
                 then = influences.x.rightCols(after).rowwise().mean();
  change.step = then - before;
  Eigen::Matrix<double, 6, Eigen::Dynamic> within = influences.x;
  within.leftCols(at).colwise() -= before;
  within.rightCols(after).colwise() -= then;
  const Matrix6d S = within * within.transpose() / static_cast<double>(m - 2);
  const PseudoInverse inverse = InverseOf(S);
  if (inverse.rank == 0) return change;
  const double count = IndependentBlocks(within, inverse);
  const double of_means = static_cast<double>(m * m) / (static_cast<double>(at * after) * count);
  change.rank = inverse.rank;
  change.covariance = of_means * S;
  change.information = inverse.matrix / of_means;
  change.dof = std::max(0.0, count - 1 - change.rank);  // of Hotelling's T^2, with a scatter of `count` - 2
  change.statistic =
      change.step.dot(change.information * change.step) * change.dof / ((change.dof + change.rank - 1) * change.rank);
  return change;
}

bool TellsChanges(const std::vector<BlockVector>& blocks) { return blocks.size() >= kBlocksForChange; }

double LooksAt(std::size_t blocks, std::size_t pairs) {
  return static_cast<double>((blocks - 2 * kSideBlocksMin + 1) * std::max<std::size_t>(1, pairs));
}

double WorstSigma(const Matrix6d& covariance, int at) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance.block<3, 3>(at, at), Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, axes.eigenvalues()[2]));
}

}  // namespace

std::optional<PairChange> FindPairChange(const std::vector<BlockVector>& blocks, std::size_t pairs) {
  if (!TellsChanges(blocks)) return std::nullopt;
  const Influences influences = InfluencesOf(blocks);
  const auto least = static_cast<Eigen::Index>(kSideBlocksMin);
  Change likeliest;
  for (Eigen::Index at = least; at + least <= influences.x.cols(); ++at)
    if (const Change change = ChangeAt(influences, at); change.rank > 0 && change.statistic > likeliest.statistic)
      likeliest = change;
  if (likeliest.rank == 0) return std::nullopt;
  const double odds =
      std::min(1.0, LooksAt(blocks.size(), pairs) * FisherTail(likeliest.statistic, likeliest.rank, likeliest.dof));
  if (!IsMove(likeliest.step, likeliest.information, odds)) return std::nullopt;
  const auto first = static_cast<std::size_t>(likeliest.at);
  return PairChange{influences.ids[first - 1], influences.ids[first], likeliest.step, likeliest.information, odds};
}

SmallestMove SmallestPairChange(const std::vector<BlockVector>& blocks, std::size_t pairs) {
  SmallestMove told{kAnyMove_m, kAnyMove_rad, static_cast<int>(blocks.size())};
  if (!TellsChanges(blocks)) return told;
  const Influences influences = InfluencesOf(blocks);
  const Change half_way = ChangeAt(influences, influences.x.cols() / 2);
  if (half_way.rank < 6) return told;
  const double limit = FisherQuantile(kMovedOdds / LooksAt(blocks.size(), pairs), half_way.rank, half_way.dof);
  const double sigmas = std::sqrt(FisherNoncentrality(limit, half_way.rank, half_way.dof, kPower));
  const auto told_from = [&](int at, double least) {
    const double sigma = WorstSigma(half_way.covariance, at);
    return std::max(sigmas * sigma, least + (kMovedMinSigmas + kPowerSigmas) * sigma);
  };
  told.m = std::min(kAnyMove_m, told_from(tangent::kTranslation, kMovedMin_m));
  told.rad = std::min(kAnyMove_rad, told_from(tangent::kRotation, kMovedMin_rad));
  return told;
}

}  // namespace rigcal::calib
