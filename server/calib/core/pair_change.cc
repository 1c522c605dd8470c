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
  Matrix6d matrix = Matrix6d::Zero(), half = Matrix6d::Zero();  // half^T half is the matrix
  int rank = 0;
};
PseudoInverse InverseOf(const Matrix6d& S) {
  const Vector6d scale = UnitDiagonal(S);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> axes(scale.asDiagonal() * S * scale.asDiagonal());
  PseudoInverse inverse;
  Vector6d inverted = Vector6d::Zero();
  for (int i = 0; i < 6; ++i)
    if (axes.eigenvalues()[i] > kRounding) inverted[i] = 1 / axes.eigenvalues()[i], ++inverse.rank;
  inverse.half = inverted.cwiseSqrt().asDiagonal() * axes.eigenvectors().transpose() * scale.asDiagonal();
  inverse.matrix = inverse.half.transpose() * inverse.half;
  return inverse;
}

// A change before block `at`.
struct Change {
  Eigen::Index at = 0;
  Vector6d step = Vector6d::Zero();
  Matrix6d information = Matrix6d::Zero();  // of the step
  double statistic = 0.0, dof = 0.0;        // an F of `rank` and `dof`
  int rank = 0;
};

using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// What r of the same side, so many blocks apart, have in common, as a part of their squares.
double AlikeAt(const Columns& r, Eigen::Index at, Eigen::Index apart) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i + apart < r.cols(); ++i)
    if (i >= at || i + apart < at) sum += r.col(i).dot(r.col(i + apart));
  return sum / std::max(r.squaredNorm(), 1e-300);
}

// Of blocks that err alike, the part that would tell as much if they did not: 1 / (1 + 2 sum rho_k), over the distances
// k up to the first at which nothing is in common (Geyer 1992, initial sequence estimator). `numbers` stand behind each
// rho; of the first two standard errors more than is seen.
double IndependentPart(const Columns& r, Eigen::Index at, double numbers) {
  double sum = 0.0;
  for (Eigen::Index apart = 1; 2 * apart < r.cols(); ++apart) {
    const double alike = AlikeAt(r, at, apart) + (apart == 1 ? 2 / std::sqrt(numbers) : 0.0);
    if (alike <= 0) break;
    sum += alike;
  }
  return 1 / (1 + 2 * sum);
}

// By how much the difference of both means scatters more than the pooled scatter says, as the shorter side may scatter
// more than the other.
double UnevenScatter(const Eigen::VectorXd& along, Eigen::Index at) {
  const auto m = static_cast<double>(along.size()), m1 = static_cast<double>(at), m2 = m - m1;
  const double v1 = along.head(at).squaredNorm() / (m1 - 1),
               v2 = along.tail(along.size() - at).squaredNorm() / (m2 - 1);
  const double pooled = along.squaredNorm() / (m - 2) * (1 / m1 + 1 / m2);
  return pooled > 0 ? std::max(1.0, (v1 / m1 + v2 / m2) / pooled) : 1.0;
}

// A side's mean influence is its part of what is known, not of the blocks: by what a step looks longer than it is.
double StepSeen(const Columns& within, const PseudoInverse& of_scatter, Eigen::Index at) {
  const auto m = static_cast<double>(within.cols()), m1 = static_cast<double>(at);
  const auto known = [&](const auto& part) { return (of_scatter.matrix * part).cwiseProduct(part).sum(); };
  const double first = known(within.leftCols(at)) / known(within);
  return std::clamp(first * (1 - first) * m * m / (m1 * (m - m1)), 0.1, 1.0);
}

// The blocks before `at` and from it on.
struct Sides {
  Vector6d difference = Vector6d::Zero();  // of their means
  Columns within;
  Matrix6d S = Matrix6d::Zero();
  PseudoInverse inverse;
};
Sides SidesOf(const Influences& influences, Eigen::Index at) {
  const Eigen::Index m = influences.x.cols(), after = m - at;
  const Vector6d before = influences.x.leftCols(at).rowwise().mean(),
                 then = influences.x.rightCols(after).rowwise().mean();
  Sides sides;
  sides.difference = then - before;
  sides.within = influences.x;
  sides.within.leftCols(at).colwise() -= before;
  sides.within.rightCols(after).colwise() -= then;
  sides.S = sides.within * sides.within.transpose() / static_cast<double>(m - 2);
  sides.inverse = InverseOf(sides.S);
  return sides;
}

// Of a step along `direction`: its covariance and the degrees of freedom of Hotelling's T^2, with a scatter of the
// blocks that count, less two.
struct Known {
  Matrix6d covariance = Matrix6d::Zero(), information = Matrix6d::Zero();
  double seen = 1.0, dof = 0.0;
};
Known KnownAlong(const Vector6d& direction, const Sides& sides, Eigen::Index at) {
  const auto m = static_cast<double>(sides.within.cols()), m1 = static_cast<double>(at);
  const Eigen::VectorXd along = sides.within.transpose() * (sides.inverse.matrix * direction);
  Known known;
  known.seen = StepSeen(sides.within, sides.inverse, at);
  Columns step = Columns::Zero(6, sides.within.cols());
  step.row(0) = along;
  const double of_all = IndependentPart(sides.inverse.half * sides.within, at, m * sides.inverse.rank),
               of_step = IndependentPart(step, at, m);
  const double of_means =
      m / (m1 * (m - m1) * std::min(of_all, of_step)) * UnevenScatter(along, at) / (known.seen * known.seen);
  known.covariance = of_means * sides.S;
  known.information = sides.inverse.matrix / of_means;
  known.dof = std::max(0.0, m * of_all - 1 - sides.inverse.rank);
  return known;
}

Change ChangeAt(const Influences& influences, Eigen::Index at) {
  const Sides sides = SidesOf(influences, at);
  Change change;
  change.at = at;
  change.rank = sides.inverse.rank;
  if (change.rank == 0) return change;
  const Known known = KnownAlong(sides.difference, sides, at);
  change.step = sides.difference / known.seen;
  change.information = known.information;
  change.dof = known.dof;
  change.statistic =
      change.step.dot(change.information * change.step) * change.dof / ((change.dof + change.rank - 1) * change.rank);
  return change;
}

Change Likeliest(const Influences& influences) {
  const auto least = static_cast<Eigen::Index>(kSideBlocksMin);
  Change likeliest;
  for (Eigen::Index at = least; at + least <= influences.x.cols(); ++at)
    if (const Change change = ChangeAt(influences, at); change.rank > 0 && change.statistic > likeliest.statistic)
      likeliest = change;
  return likeliest;
}

double LooksAt(std::size_t blocks, std::size_t pairs) {
  return static_cast<double>((blocks - 2 * kSideBlocksMin + 1) * std::max<std::size_t>(1, pairs));
}

// A side that falls apart by itself: then the pair drifts, or captures of one place err alike, and no move is told.
bool FallsApart(const Influences& influences, Eigen::Index first, Eigen::Index count) {
  constexpr double kOdds = 1e-3;
  if (count < 2 * static_cast<Eigen::Index>(kSideBlocksMin)) return false;
  Influences side;
  side.x = influences.x.middleCols(first, count);
  side.x.colwise() -= side.x.rowwise().mean().eval();
  const Change change = Likeliest(side);
  const double looks = LooksAt(static_cast<std::size_t>(count), 1);
  return change.rank > 0 && looks * FisherTail(change.statistic, change.rank, change.dof) < kOdds;
}

bool TellsChanges(const std::vector<BlockVector>& blocks) { return blocks.size() >= kBlocksForChange; }

// The axis of translation or of rotation (`part`) along which S is largest.
Vector6d WorstAxis(const Matrix6d& S, int part) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(S.block<3, 3>(part, part));
  Vector6d axis = Vector6d::Zero();
  axis.segment<3>(part) = axes.eigenvectors().col(2);
  return axis;
}

double SmallestAlong(const Sides& sides, Eigen::Index at, int part, double least, double odds) {
  const Vector6d axis = WorstAxis(sides.S, part);
  const Known known = KnownAlong(axis, sides, at);
  const double limit = FisherQuantile(odds, sides.inverse.rank, known.dof);
  const double sigmas = std::sqrt(FisherNoncentrality(limit, sides.inverse.rank, known.dof, kPower));
  const double sigma = std::sqrt(axis.dot(known.covariance * axis));
  return std::max(sigmas * sigma, least + (kMovedMinSigmas + kPowerSigmas) * sigma);
}

}  // namespace

std::optional<PairChange> FindPairChange(const std::vector<BlockVector>& blocks, std::size_t pairs) {
  if (!TellsChanges(blocks)) return std::nullopt;
  const Influences influences = InfluencesOf(blocks);
  const Change likeliest = Likeliest(influences);
  if (likeliest.rank == 0) return std::nullopt;
  const double odds =
      std::min(1.0, LooksAt(blocks.size(), pairs) * FisherTail(likeliest.statistic, likeliest.rank, likeliest.dof));
  if (!IsMove(likeliest.step, likeliest.information, odds)) return std::nullopt;
  const Eigen::Index m = influences.x.cols();
  if (FallsApart(influences, 0, likeliest.at) || FallsApart(influences, likeliest.at, m - likeliest.at))
    return std::nullopt;
  const auto first = static_cast<std::size_t>(likeliest.at);
  return PairChange{influences.ids[first - 1], influences.ids[first], likeliest.step, likeliest.information, odds};
}

SmallestMove SmallestPairChange(const std::vector<BlockVector>& blocks, std::size_t pairs) {
  SmallestMove told{kAnyMove_m, kAnyMove_rad, static_cast<int>(blocks.size())};
  if (!TellsChanges(blocks)) return told;
  const Influences influences = InfluencesOf(blocks);
  const Eigen::Index half_way = influences.x.cols() / 2;
  const Sides sides = SidesOf(influences, half_way);
  if (sides.inverse.rank < 6) return told;
  const double odds = kMovedOdds / LooksAt(blocks.size(), pairs);
  told.m = std::min(kAnyMove_m, SmallestAlong(sides, half_way, tangent::kTranslation, kMovedMin_m, odds));
  told.rad = std::min(kAnyMove_rad, SmallestAlong(sides, half_way, tangent::kRotation, kMovedMin_rad, odds));
  return told;
}

}  // namespace rigcal::calib
