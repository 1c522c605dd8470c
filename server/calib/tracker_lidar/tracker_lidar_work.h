// The numbers of a tracker-lidar problem as they shrink and improve, for tracker_lidar*.cc.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/calib/planes/plane_consensus.h"
#include "server/calib/tracker_lidar/tracker_lidar.h"
#include "server/model/edges/method.h"

namespace rigcal::calib {

constexpr std::size_t kTrackerLidarMin = RowOf(Method::kTrackerLidar).captures.least;  // captures of both
constexpr std::size_t kTrackerLidarForJackknife = 5;  // fewer: the uncertainty is the model's
constexpr std::size_t kTrackerLidarEnough = RowOf(Method::kTrackerLidar).captures.enough;  // fewer: a note says so

// A patch that is a board: which of the capture's, and what it is.
struct ChosenPatch {
  const PlanePatch* patch = nullptr;
  std::size_t board_idx = 0;
};

struct TrackerLidarWork {
  std::vector<std::size_t> captures;              // of the problem, those used
  std::vector<std::vector<ChosenPatch>> patches;  // side by side with them
  std::map<std::size_t, std::string> unused;      // of the problem's captures: why
  std::vector<std::size_t> contradicting;         // of those: the ones whose boards are elsewhere
  double range_sigma_m = 0.0;
  // On the variances that a tracker is taken to have. They begin high: what then is told is told with any noise below.
  double factor_translation = 100.0, factor_rotation = 100.0;
  StaticProblem problem;  // in a world whose origin is in the middle of the body's places
  StaticState state;
  StaticFit fit;
  PlaneReach reach;
  MotionReach motion;
};

// Patches of a capture that may be boards; one seen under two plates' names counts once.
[[nodiscard]] std::vector<const PlanePatch*> PatchesOf(const TrackerLidarCapture& capture);
// Captures with a pose and a patch, each once; which patches are boards. Leaves the start in `state`.
[[nodiscard]] OrDiagnosis<TrackerLidarWork> CollectPatches(const TrackerLidarProblem& problem);
// Solves, finds the tracker's noise, what contradicts and what is open, until nothing changes.
[[nodiscard]] OrDiagnosis<void> FitPatches(const TrackerLidarProblem& problem, TrackerLidarWork& work);
[[nodiscard]] TrackerLidarCheck CheckOf(const TrackerLidarWork& work, std::size_t position);
// The refinement's problem with the ranges of one group of beams longer.
[[nodiscard]] StaticProblem ProblemWithBeamsMoved(const TrackerLidarWork& work, std::size_t group, double longer_m);
// T_a_b of the edge, and its uncertainty.
[[nodiscard]] Se3 EdgePose(const TrackerLidarProblem& problem, const Se3& T_body_lidar);
[[nodiscard]] Result<Uncertainty> JackknifeTrackerLidar(const TrackerLidarProblem& problem,
                                                        const TrackerLidarWork& work);
[[nodiscard]] Matrix6d ModelInformation(const TrackerLidarWork& work);

// tracker_lidar_diagnoses.cc: the sentences. Each names the sensors and captures it is about, and what to do.
//
[[nodiscard]] Diagnosis TooFewPlaced(const TrackerLidarProblem& problem, std::size_t both);
[[nodiscard]] Diagnosis FewPlaced(const TrackerLidarProblem& problem, std::size_t used);  // a note
[[nodiscard]] Diagnosis NoStaticBoard(const TrackerLidarProblem& problem, std::size_t both, std::size_t supporters);
[[nodiscard]] Diagnosis AmbiguousPlaces(const TrackerLidarProblem& problem);
// The body did not move, or in a way that tells nothing with these boards.
[[nodiscard]] Diagnosis NothingTold(const TrackerLidarProblem& problem);
[[nodiscard]] Diagnosis PlacedContradict(const TrackerLidarProblem& problem, const std::vector<CaptureId>& captures);
[[nodiscard]] Diagnosis HighPlaneResidual(const TrackerLidarProblem& problem, const TrackerLidarEstimate& estimate);
[[nodiscard]] Diagnosis TrackerLidarNotSolvable(const TrackerLidarProblem& problem, const Error& error);
// Codes "planar_motion", "turning_on_the_spot", "pure_translation", "straight_line", "few_planes": notes on a good edge
// that say which direction is not known, and whether motion or boards are to blame. Nothing where all are.
[[nodiscard]] std::vector<Diagnosis> OpenDirections(const TrackerLidarProblem& problem,
                                                    const TrackerLidarEstimate& estimate);
// "cloud_unreadable", "board_not_found_in_cloud".
[[nodiscard]] std::vector<Diagnosis> MissedClouds(const TrackerLidarProblem& problem);

}  // namespace rigcal::calib
