#include "server/calib/joint/problem/board_candidates.h"

#include <algorithm>
#include <cmath>

namespace rigcal::calib::joint {
namespace {

constexpr std::size_t kHypotheses = 60;  // of a consensus: more views than these only vote

bool Agrees(const Se3& x, const Se3& y) {
  return (x.p_m - y.p_m).norm() < kAgree_m && x.q.angularDistance(y.q) < kAgree_rad;
}

// T_board_turned: the board's frame after it is turned about its centre as TurnedIndex renumbers it.
Se3 TurnOf(const Target& target, int turn) {
  const double angle = 2 * M_PI * turn / SymmetryOf(target);
  const Eigen::Quaterniond q(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
  const Eigen::Vector3d centre = CentreOf(target);
  return {centre - q * centre, q};
}

}  // namespace

std::vector<Candidate> CandidatesOf(const CameraEstimate& camera, const Target& board, const CaptureId& capture) {
  std::vector<Candidate> candidates;
  for (const Se3& pose : camera.PosesOf(capture))
    for (int turn = 0; turn < SymmetryOf(board); ++turn) candidates.push_back({pose * TurnOf(board, turn), turn});
  return candidates;
}

std::optional<Se3> Agreed(const std::vector<std::vector<Se3>>& lists) {
  std::optional<Se3> best;
  std::size_t votes_of_best = 0;
  for (std::size_t i = 0; i < std::min(kHypotheses, lists.size()); ++i)
    for (const Se3& hypothesis : lists[i]) {
      const auto votes = static_cast<std::size_t>(std::count_if(lists.begin(), lists.end(), [&](const auto& list) {
        return std::any_of(list.begin(), list.end(), [&](const Se3& pose) { return Agrees(pose, hypothesis); });
      }));
      if (votes > votes_of_best) best = hypothesis, votes_of_best = votes;
    }
  return best;
}

}  // namespace rigcal::calib::joint
