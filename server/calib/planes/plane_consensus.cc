#include "server/calib/planes/plane_consensus.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "server/base/process/parallel_for.h"
#include "server/calib/core/robust.h"

namespace rigcal::calib {
namespace {

// How far a patch may be from its board: few beams sample a plate coarsely, so its centre is rough.
constexpr double kAngleTolerance_rad = 0.2, kCentreTolerance_m = 0.3;
// While the pose is wrong, boards move about: tolerances begin so many times as wide.
constexpr std::array<double, 9> kWidths = {4, 4, 3, 2, 2, 1.5, 1, 1, 1},
                                kWidthsNearNominal = {2, 2, 1.5, 1, 1, 1, 1, 1, 1};
// Of the lidar's position on the body.
constexpr double kNominalSigma_m = 0.3, kAnywhereSigma_m = 1.0;
constexpr std::size_t kProposersMax = 40, kScoutsMax = 12, kBoardsMax = 12, kScoutsAgreeMin = 3;
constexpr int kStarts = 240, kRefinedMax = 8;
constexpr double kConvincingRatio = 0.7;  // of the captures, and of a patch's agreement
constexpr double kOtherAngle_rad = 0.3, kOtherShift_m = 0.5;

// Squared, in units of the tolerances.
double Disagreement(const BoardPlane& patch, const BoardPlane& board) {
  const double shift = (patch.centre_m - board.centre_m).norm() / kCentreTolerance_m;
  if (shift > kWidths.front()) return shift * shift;
  const double angle = AngleBetween_rad(patch.normal, board.normal) / kAngleTolerance_rad;
  return angle * angle + shift * shift;
}

struct Placed {
  std::size_t capture_idx = 0, patch_idx = 0;
  BoardPlane world;
  bool taken = false;
};

BoardPlane InWorld(const Se3& T_world_lidar, const BoardPlane& patch) {
  return {T_world_lidar.q * patch.normal, T_world_lidar * patch.centre_m};
}

std::vector<Placed> PlacedUnder(const std::vector<PlacedPatches>& captures, const Se3& T_body_lidar) {
  std::vector<Placed> placed;
  for (std::size_t k = 0; k < captures.size(); ++k) {
    const Se3 T_world_lidar = captures[k].T_world_body * T_body_lidar;
    for (std::size_t i = 0; i < captures[k].patches.size(); ++i)
      placed.push_back({k, i, InWorld(T_world_lidar, captures[k].patches[i]), false});
  }
  return placed;
}

// Of every capture the patch that agrees best with a board, among those not taken yet.
std::vector<std::size_t> MembersOf(const std::vector<Placed>& placed, const BoardPlane& board, double width) {
  std::vector<std::size_t> members;
  double best = 0;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (placed[i].taken) continue;
    const double now = Disagreement(placed[i].world, board);
    if (!(now < width * width)) continue;
    if (members.empty() || placed[members.back()].capture_idx != placed[i].capture_idx) {
      members.push_back(i);
      best = now;
    } else if (now < best) {
      members.back() = i;
      best = now;
    }
  }
  return members;
}

BoardPlane MeanOf(const std::vector<Placed>& placed, const std::vector<std::size_t>& members) {
  BoardPlane mean{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (const std::size_t i : members) {
    mean.normal += placed[i].world.normal;
    mean.centre_m += placed[i].world.centre_m / static_cast<double>(members.size());
  }
  mean.normal.normalize();
  return mean;
}

struct Cluster {
  BoardPlane board;
  std::vector<std::size_t> members;  // of the placed patches
};

// The place that most captures see a patch at, then the next, until too few agree.
std::vector<Cluster> ClustersOf(std::vector<Placed>& placed, double width, std::size_t captures_min) {
  std::vector<Cluster> clusters;
  while (clusters.size() < kBoardsMax) {
    std::vector<std::size_t> best;
    double best_sum = 0;
    for (const Placed& seed : placed) {
      if (seed.taken) continue;
      const std::vector<std::size_t> members = MembersOf(placed, seed.world, width);
      double sum = 0;
      for (const std::size_t i : members) sum += 1 - Disagreement(placed[i].world, seed.world) / (width * width);
      if (members.size() >= captures_min && sum > best_sum) best = members, best_sum = sum;
    }
    if (best.empty()) break;
    const BoardPlane board = MeanOf(placed, best);
    best = MembersOf(placed, board, width);
    if (best.size() < captures_min) break;
    for (const std::size_t i : best) placed[i].taken = true;
    clusters.push_back({MeanOf(placed, best), std::move(best)});
  }
  return clusters;
}

struct Prior {
  Eigen::Vector3d position_m;
  double sigma_m = 0.0;
};

// One Gauss-Newton step of the pose on the patches' distances from their boards; the boards follow. The position is
// drawn to where it was thought to be, the rotation only slowed down: what the motion does not tell stays.
Se3 StepTowards(const std::vector<PlacedPatches>& captures, const std::vector<Placed>& placed,
                const std::vector<Cluster>& clusters, const Se3& T, const Prior& prior) {
  using Rows = Eigen::Matrix<double, 6, 6>;
  const double per_m2 = 1 / (prior.sigma_m * prior.sigma_m);
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  H.diagonal() << Eigen::Vector3d::Constant(per_m2), Eigen::Vector3d::Ones();
  g.head<3>() = per_m2 * (T.R().transpose() * (T.p_m - prior.position_m));
  for (const Cluster& cluster : clusters) {
    Rows J_mean = Rows::Zero();
    std::vector<Rows> J;
    for (const std::size_t i : cluster.members) {
      const PlacedPatches& capture = captures[placed[i].capture_idx];
      const BoardPlane& patch = capture.patches[placed[i].patch_idx];
      const Eigen::Matrix3d R = (capture.T_world_body * T).R();
      Rows rows = Rows::Zero();
      rows.topLeftCorner<3, 3>() = R / kCentreTolerance_m;
      rows.topRightCorner<3, 3>() = -R * Hat(patch.centre_m) / kCentreTolerance_m;
      rows.bottomRightCorner<3, 3>() = -R * Hat(patch.normal) / kAngleTolerance_rad;
      J_mean += rows / static_cast<double>(cluster.members.size());
      J.push_back(rows);
    }
    for (std::size_t m = 0; m < J.size(); ++m) {
      const BoardPlane& world = placed[cluster.members[m]].world;
      Vector6d r;
      r << (world.centre_m - cluster.board.centre_m) / kCentreTolerance_m,
          (world.normal - cluster.board.normal) / kAngleTolerance_rad;
      const Rows centred = J[m] - J_mean;
      H += centred.transpose() * centred;
      g += centred.transpose() * r;
    }
  }
  return (T * Se3::Exp(-H.ldlt().solve(g))).Normalized();
}

struct Attempt {
  Se3 T_body_lidar;
  std::vector<BoardPlane> boards;
  double score = 0.0;
  std::size_t supporters = 0, patches = 0;
};

template <typename Widths>
Attempt AttemptFrom(const std::vector<PlacedPatches>& captures, const Se3& start, const Prior& prior,
                    const Widths& widths, std::size_t captures_min) {
  Attempt attempt{start, {}, 0.0, 0, 0};
  for (const double width : widths) {
    std::vector<Placed> placed = PlacedUnder(captures, attempt.T_body_lidar);
    const std::vector<Cluster> clusters = ClustersOf(placed, width, captures_min);
    if (clusters.empty()) return attempt;
    attempt.T_body_lidar = StepTowards(captures, placed, clusters, attempt.T_body_lidar, prior);
  }
  std::vector<Placed> placed = PlacedUnder(captures, attempt.T_body_lidar);
  std::vector<char> supports(captures.size(), 0);
  for (const Cluster& cluster : ClustersOf(placed, 1.0, captures_min)) {
    attempt.boards.push_back(cluster.board);
    for (const std::size_t i : cluster.members) {
      attempt.score += 1 - Disagreement(placed[i].world, cluster.board);
      supports[placed[i].capture_idx] = 1;
      ++attempt.patches;
    }
  }
  attempt.supporters = static_cast<std::size_t>(std::count(supports.begin(), supports.end(), 1));
  return attempt;
}

// Rotations spread evenly (Alexa 2022, super-Fibonacci spirals).
Se3 StartAt(int i) {
  const double s = i + 0.5, t = s / kStarts, r = std::sqrt(t), R = std::sqrt(1 - t);
  const double alpha = 2 * M_PI * s / std::sqrt(2.0), beta = 2 * M_PI * s / 1.533751168755204288118041;
  Se3 start;
  start.q = Eigen::Quaterniond(R * std::cos(beta), r * std::sin(alpha), r * std::cos(alpha), R * std::sin(beta));
  return start.Normalized();
}

bool IsAnother(const Se3& T, const Se3& S) {
  const Vector6d apart = (T.Inverse() * S).Log();
  return apart.tail<3>().norm() > kOtherAngle_rad || apart.head<3>().norm() > kOtherShift_m;
}

// From rotations all round: scouted on a few captures, the best refined on more.
std::vector<Attempt> AttemptsAllRound(const std::vector<PlacedPatches>& captures, std::size_t captures_min) {
  const Prior anywhere{Eigen::Vector3d::Zero(), kAnywhereSigma_m};
  const std::vector<PlacedPatches> scouts = SpreadOver(captures, kScoutsMax);
  const std::size_t scouts_min = std::max(kScoutsAgreeMin, captures_min * scouts.size() / captures.size());
  std::vector<Attempt> scouted(kStarts);
  ParallelFor(scouted.size(), [&](std::size_t i) {
    scouted[i] = AttemptFrom(scouts, StartAt(static_cast<int>(i)), anywhere, kWidths, scouts_min);
  });
  std::stable_sort(scouted.begin(), scouted.end(),
                   [](const Attempt& x, const Attempt& y) { return x.score > y.score; });
  std::vector<Attempt> refined;
  for (const Attempt& attempt : scouted) {
    if (refined.size() == kRefinedMax || attempt.boards.empty()) break;
    if (std::any_of(refined.begin(), refined.end(),
                    [&](const Attempt& other) { return !IsAnother(other.T_body_lidar, attempt.T_body_lidar); }))
      continue;
    refined.push_back(AttemptFrom(captures, attempt.T_body_lidar, anywhere, kWidthsNearNominal, captures_min));
  }
  return refined;
}

// The boards' patches under a pose, boards where `boards` are. Of a capture's patches that could be the same board the
// one that agrees best is.
std::vector<std::optional<std::size_t>> BoardsOf(const PlacedPatches& capture, const Se3& T_body_lidar,
                                                 const std::vector<BoardPlane>& boards) {
  const Se3 T_world_lidar = capture.T_world_body * T_body_lidar;
  std::vector<std::optional<std::size_t>> board_of(capture.patches.size());
  for (std::size_t b = 0; b < boards.size(); ++b) {
    std::optional<std::size_t> best;
    double least = 1;
    for (std::size_t i = 0; i < capture.patches.size(); ++i) {
      if (board_of[i]) continue;
      const double now = Disagreement(InWorld(T_world_lidar, capture.patches[i]), boards[b]);
      if (now < least) best = i, least = now;
    }
    if (best) board_of[*best] = b;
  }
  return board_of;
}

PlaneConsensus ConsensusOf(const std::vector<PlacedPatches>& captures, const Attempt& attempt) {
  PlaneConsensus consensus;
  consensus.T_body_lidar = attempt.T_body_lidar;
  consensus.boards = attempt.boards;
  consensus.score = attempt.score;
  for (const PlacedPatches& capture : captures) {
    consensus.board_of_patch.push_back(BoardsOf(capture, attempt.T_body_lidar, attempt.boards));
    const auto& boards = consensus.board_of_patch.back();
    if (std::any_of(boards.begin(), boards.end(), [](const auto& board) { return board.has_value(); }))
      ++consensus.supporters;
  }
  return consensus;
}

}  // namespace

std::optional<PlaneConsensus> FindStaticBoards(const std::vector<PlacedPatches>& captures,
                                               const std::optional<Se3>& nominal, std::size_t captures_min) {
  const std::vector<PlacedPatches> spread = SpreadOver(captures, kProposersMax);
  std::optional<Attempt> best;
  if (nominal) {
    best = AttemptFrom(spread, *nominal, {nominal->p_m, kNominalSigma_m}, kWidthsNearNominal, captures_min);
    if (static_cast<double>(best->supporters) >= kConvincingRatio * static_cast<double>(spread.size()) &&
        best->score >= kConvincingRatio * static_cast<double>(best->patches))
      return ConsensusOf(captures, *best);
  }
  const std::vector<Attempt> all_round = AttemptsAllRound(spread, captures_min);
  for (const Attempt& attempt : all_round)
    if (!best || attempt.score > best->score) best = attempt;
  if (!best || best->boards.empty()) return std::nullopt;
  PlaneConsensus consensus = ConsensusOf(captures, *best);
  for (const Attempt& attempt : all_round) {
    if (!IsAnother(attempt.T_body_lidar, best->T_body_lidar) || attempt.score <= consensus.other_score) continue;
    consensus.other = attempt.T_body_lidar;
    consensus.other_score = attempt.score;
  }
  return consensus;
}

}  // namespace rigcal::calib
