#include "server/calib/stereo/pair_start.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/calib/core/robust.h"

namespace rigcal::calib {
namespace {

// Two captures agree on T_a_b within the error of rough intrinsics: so many radians, and so much of the board's
// distance.
constexpr double kAngleTolerance_rad = 0.1;
constexpr double kDistanceToleranceRatio = 0.15;
// The vote is quadratic in their number.
constexpr std::size_t kVotersMax = 80;
// A rival has at least this part of the winner's voters.
constexpr double kRivalRatio = 0.75;

using Hypotheses = std::vector<Se3>;  // T_a_b of one capture, one per combination of candidates

Hypotheses HypothesesOf(const PoseCandidates& capture) {
  Hypotheses hypotheses;
  for (const Se3& T_a_board : capture.T_a_board)
    for (const Se3& T_b_board : capture.T_b_board) hypotheses.push_back(T_a_board * T_b_board.Inverse());
  return hypotheses;
}

double SquaredDiscrepancy(const Se3& T, const Se3& S, double distance_m) {
  const Se3 difference = T.Inverse() * S;
  const double angle = difference.Log().tail<3>().norm() / kAngleTolerance_rad;
  const double shift = difference.p_m.norm() / (kDistanceToleranceRatio * distance_m);
  return angle * angle + shift * shift;
}

// At most 1: beyond, it does not matter how far.
double Disagreement(const Se3& T, const Se3& S, double distance_m) {
  return std::min(1.0, SquaredDiscrepancy(T, S, distance_m));
}

// The hypothesis of a capture that is nearest to T.
const Se3& Nearest(const Hypotheses& hypotheses, const Se3& T, double distance_m) {
  return *std::min_element(hypotheses.begin(), hypotheses.end(), [&](const Se3& left, const Se3& right) {
    return Disagreement(T, left, distance_m) < Disagreement(T, right, distance_m);
  });
}

double Score(const Se3& T, const std::vector<Hypotheses>& voters, double distance_m) {
  double score = 0;
  for (const Hypotheses& voter : voters) score += Disagreement(T, Nearest(voter, T, distance_m), distance_m);
  return score;
}

std::size_t Supporters(const Se3& T, const std::vector<Hypotheses>& voters, double distance_m) {
  return static_cast<std::size_t>(std::count_if(voters.begin(), voters.end(), [&](const Hypotheses& voter) {
    return Disagreement(T, Nearest(voter, T, distance_m), distance_m) < 1.0;
  }));
}

std::vector<Hypotheses> Voters(const std::vector<PoseCandidates>& captures) {
  std::vector<Hypotheses> all;
  for (const PoseCandidates& capture : captures)
    if (Hypotheses hypotheses = HypothesesOf(capture); !hypotheses.empty()) all.push_back(std::move(hypotheses));
  return SpreadOver(all, kVotersMax);
}

// The hypothesis with the least score of those that are `allowed`; null: none is.
template <typename Allowed>
const Se3* BestOf(const std::vector<Hypotheses>& voters, double distance_m, const Allowed& allowed) {
  const Se3* best = nullptr;
  double best_score = std::numeric_limits<double>::infinity();
  for (const Hypotheses& voter : voters)
    for (const Se3& T : voter) {
      if (!allowed(T)) continue;
      if (const double score = Score(T, voters, distance_m); score < best_score) best = &T, best_score = score;
    }
  return best;
}

// Median per tangent axis of what lies near T.
Se3 MedianNear(const Se3& T, const std::vector<Hypotheses>& voters, double distance_m) {
  std::vector<Vector6d> near;
  for (const Hypotheses& voter : voters) {
    const Se3& nearest = Nearest(voter, T, distance_m);
    if (Disagreement(T, nearest, distance_m) < 1.0) near.push_back((T.Inverse() * nearest).Log());
  }
  Vector6d median;
  for (int axis = 0; axis < 6; ++axis) {
    std::vector<double> values;
    for (const Vector6d& xi : near) values.push_back(xi[axis]);
    median[axis] = MedianOf(values);
  }
  return T * Se3::Exp(median);
}

}  // namespace

std::optional<Se3> ConsensusOf(const std::vector<PoseCandidates>& captures) {
  const std::vector<Hypotheses> voters = Voters(captures);
  if (voters.empty()) return std::nullopt;
  const double distance_m = MedianDistance_m(captures);
  return MedianNear(*BestOf(voters, distance_m, [](const Se3&) { return true; }), voters, distance_m).Normalized();
}

std::vector<Se3> RivalsOf(const std::vector<PoseCandidates>& captures, const Se3& T_a_b, std::size_t count_max) {
  const std::vector<Hypotheses> voters = Voters(captures);
  const double distance_m = MedianDistance_m(captures);
  const double needed = kRivalRatio * static_cast<double>(Supporters(T_a_b, voters, distance_m));
  std::vector<Se3> all{T_a_b};
  const auto is_rival = [&](const Se3& T) {
    return std::all_of(all.begin(), all.end(),
                       [&](const Se3& other) { return Disagreement(other, T, distance_m) >= 1.0; }) &&
           static_cast<double>(Supporters(T, voters, distance_m)) >= needed;
  };
  while (all.size() <= count_max) {
    const Se3* best = BestOf(voters, distance_m, is_rival);
    if (best == nullptr) break;
    all.push_back(MedianNear(*best, voters, distance_m).Normalized());
  }
  return {all.begin() + 1, all.end()};
}

double Discrepancy(const Se3& T, const Se3& S, double distance_m) {
  return std::sqrt(SquaredDiscrepancy(T, S, distance_m));
}

double MedianDistance_m(const std::vector<PoseCandidates>& captures) {
  std::vector<double> distances;
  for (const PoseCandidates& capture : captures)
    if (!capture.T_a_board.empty()) distances.push_back(capture.T_a_board.front().p_m.norm());
  return distances.empty() ? 0.0 : MedianOf(distances);
}

}  // namespace rigcal::calib
