// The sentences of tracker-lidar calibration. Each names the sensors and captures it is about, and what to do.
#pragma once

#include <vector>

#include "server/calib/tracker_lidar/tracker_lidar.h"

namespace rigcal::calib {

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
