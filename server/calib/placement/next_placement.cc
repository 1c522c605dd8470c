#include "server/calib/placement/next_placement.h"

#include <algorithm>
#include <limits>

#include "server/base/process/parallel_for.h"

namespace rigcal::calib::placement {
namespace {

constexpr double kLeastGain = 1e-3;  // of what is missing: less is no advice

// Where each camera saw a board.
struct StandBefore {
  std::size_t camera, board;
  Stand stand;
};

std::vector<StandBefore> StandsOf(const PlannedRig& rig, const std::vector<PlannedCapture>& captures) {
  std::vector<StandBefore> stands;
  for (const PlannedCapture& capture : captures)
    for (const PlannedLook& look : capture.looks)
      stands.push_back({look.camera, capture.board, StandOf(look.T_camera_board, rig.boards[capture.board])});
  return stands;
}

bool WasThere(const std::vector<StandBefore>& stands, const Candidate& candidate) {
  return std::any_of(stands.begin(), stands.end(), [&](const StandBefore& before) {
    return before.camera == candidate.camera && before.board == candidate.capture.board &&
           AreAlike(before.stand, candidate.stand);
  });
}

struct Best {
  std::optional<Candidate> candidate;
  std::vector<PoseSoFar> poses;
  double sum = 0.0;
};

// One number of a stand moved by a step, `part` of the largest.
std::vector<Stand> Neighbours(const Stand& at, double part) {
  constexpr double kSight_rad = 0.08, kDistance_ratio = 0.15, kTilt_rad = 0.17, kTiltMax_rad = 0.87;
  std::vector<Stand> around;
  for (const double step : {-part, part}) {
    Stand right = at, up = at, farther = at, turned = at, leant = at;
    right.right_rad += step * kSight_rad;
    up.up_rad += step * kSight_rad;
    farther.distance_m *= 1 + step * kDistance_ratio;
    turned.tilt_right_rad = std::clamp(at.tilt_right_rad + step * kTilt_rad, -kTiltMax_rad, kTiltMax_rad);
    leant.tilt_up_rad = std::clamp(at.tilt_up_rad + step * kTilt_rad, -kTiltMax_rad, kTiltMax_rad);
    around.insert(around.end(), {right, up, farther, turned, leant});
  }
  return around;
}

class Planner {
 public:
  Planner(const PlannedRig& rig, const std::vector<PlannedCapture>& captures)
      : rig_(rig), captures_(captures), unknowns_(rig), ties_(rig.cameras.size()) {
    std::vector<PartOfInformation> parts;
    for (const PlannedCapture& capture : captures) {
      parts.push_back(InformationOf(rig, unknowns_, capture));
      ties_.Add(capture);
    }
    covariance_ = CovarianceBy(rig, unknowns_, parts);
  }

  PlacementAdvice Run() {
    PlacementAdvice advice;
    advice.poses = PosesBy(rig_, unknowns_, covariance_.diagonal(), ties_);
    const std::vector<Candidate> candidates = CandidatesOf(rig_);
    advice.out_of_reach = out_of_reach_ = OutOfReach(candidates);
    advice.untested = ties_.Untested(rig_);
    const bool all_known = AllKnown(advice);
    if (all_known) untested_ = advice.untested;
    advice.is_enough = all_known && advice.untested.empty();
    if (advice.is_enough) return advice;
    if (const Best best = BestOf(candidates, advice.poses); best.candidate) advice.next = Told(best, advice.poses);
    return advice;
  }

 private:
  [[nodiscard]] std::vector<std::size_t> OutOfReach(const std::vector<Candidate>& candidates) const {
    PairTies possible = ties_;
    for (const Candidate& candidate : candidates) possible.Add(candidate.capture);
    const std::vector<int> tied = possible.TiedBy(rig_.reference, 1);
    std::vector<std::size_t> out;
    for (std::size_t c = 0; c < tied.size(); ++c)
      if (tied[c] == 0) out.push_back(c);
    return out;
  }

  // What untested pairs lack after a capture, among what is missing.
  [[nodiscard]] double MissingOfTests(const PlannedCapture& capture) const {
    int lacking = 0;
    for (const UntestedPair& pair : untested_) {
      const auto looks = [&](std::size_t camera) {
        return std::any_of(capture.looks.begin(), capture.looks.end(),
                           [&](const PlannedLook& look) { return look.camera == camera; });
      };
      lacking += pair.lacking - (looks(pair.a) && looks(pair.b) ? 1 : 0);
    }
    return kMissingOfACapture * lacking;
  }

  [[nodiscard]] double MissingAfter(const std::vector<PoseSoFar>& poses, const PlannedCapture& capture) const {
    return MissingOf(poses, out_of_reach_) + MissingOfTests(capture);
  }

  [[nodiscard]] bool AllKnown(const PlacementAdvice& advice) const {
    for (std::size_t c = 0; c < advice.poses.size(); ++c)
      if (advice.poses[c].of_tolerance > 1 &&
          !std::binary_search(advice.out_of_reach.begin(), advice.out_of_reach.end(), c))
        return false;
    return true;
  }

  [[nodiscard]] std::vector<PoseSoFar> PosesWith(const PlannedCapture& capture) const {
    PairTies ties = ties_;
    ties.Add(capture);
    const PartOfInformation part = ExpectedInformation(rig_, unknowns_, capture);
    return PosesBy(rig_, unknowns_, VariancesWith(covariance_, part, unknowns_.size), ties);
  }

  // Takes the candidate if the sum falls by it.
  bool Take(const Candidate& candidate, const std::vector<StandBefore>& stands, Best& best) const {
    if (WasThere(stands, candidate)) return false;
    std::vector<PoseSoFar> then = PosesWith(candidate.capture);
    const double sum = MissingAfter(then, candidate.capture);
    if (!(sum < best.sum)) return false;
    best = {candidate, std::move(then), sum};
    return true;
  }

  // Each is tried by itself, on as many threads as there are; then the first of the least is taken.
  void TakeLeast(const std::vector<Candidate>& candidates, const std::vector<StandBefore>& stands, Best& best) const {
    std::vector<double> sums(candidates.size(), std::numeric_limits<double>::infinity());
    ParallelFor(candidates.size(), [&](std::size_t i) {
      if (!WasThere(stands, candidates[i]))
        sums[i] = MissingAfter(PosesWith(candidates[i].capture), candidates[i].capture);
    });
    const auto least = std::min_element(sums.begin(), sums.end());
    if (least != sums.end()) Take(candidates[static_cast<std::size_t>(least - sums.begin())], stands, best);
  }

  [[nodiscard]] Best BestOf(const std::vector<Candidate>& candidates, const std::vector<PoseSoFar>& now) const {
    const std::vector<StandBefore> stands = StandsOf(rig_, captures_);
    Best best;
    const double missing = MissingAfter(now, PlannedCapture());
    best.sum = missing - kLeastGain * std::min(missing, 1.0);  // a pose that is not known at all drowns the others
    TakeLeast(candidates, stands, best);
    constexpr int kRoundsMax = 6;
    for (const double part : {1.0, 0.5})
      for (int round = 0; best.candidate && round < kRoundsMax; ++round)
        if (!TakeNeighbour(part, stands, best)) break;
    return best;
  }

  bool TakeNeighbour(double part, const std::vector<StandBefore>& stands, Best& best) const {
    const Candidate from = *best.candidate;
    bool is_better = false;
    for (const Stand& stand : Neighbours(from.stand, part))
      if (const auto near = CandidateAt(rig_, from.capture.board, from.camera, stand))
        is_better |= Take(*near, stands, best);
    return is_better;
  }

  [[nodiscard]] NextPlacement Told(const Best& best, const std::vector<PoseSoFar>& now) const {
    NextPlacement next;
    next.capture = best.candidate->capture;
    next.board = next.capture.board;
    double most = -1;
    for (std::size_t c = 0; c < now.size(); ++c) {
      const double gain = MissingOf(now[c]) - MissingOf(best.poses[c]);
      if (gain > most) most = gain, next.of = c;
    }
    SetSigmas(now[next.of], best.poses[next.of], next);
    next.camera = best.candidate->camera;
    for (const PlannedLook& look : next.capture.looks)
      if (look.camera == next.of) next.camera = look.camera;
    for (const PlannedLook& look : next.capture.looks)
      if (look.camera == next.camera) next.T_camera_board = look.T_camera_board;
    next.stand = StandOf(next.T_camera_board, rig_.boards[next.board]);
    return next;
  }

  static void SetSigmas(const PoseSoFar& now, const PoseSoFar& then, NextPlacement& next) {
    const bool is_focal = now.focal_sigma_ratio / kFocalSigmaMax_ratio > now.pose_of_tolerance;
    next.axis = is_focal ? kFocalAxis : now.worst_axis;
    next.sigma_now = is_focal ? now.focal_sigma_ratio : now.sigma[now.worst_axis];
    next.sigma_then = is_focal ? then.focal_sigma_ratio : then.sigma[now.worst_axis];
  }

  const PlannedRig& rig_;
  const std::vector<PlannedCapture>& captures_;
  UnknownsOfRig unknowns_;
  PairTies ties_;
  Eigen::MatrixXd covariance_;
  std::vector<std::size_t> out_of_reach_;
  std::vector<UntestedPair> untested_;  // once every pose is within its tolerance
};

}  // namespace

PlacementAdvice AdviseOn(const PlannedRig& rig, const std::vector<PlannedCapture>& captures) {
  return Planner(rig, captures).Run();
}

}  // namespace rigcal::calib::placement
