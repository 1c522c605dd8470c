// The captures of a stream of sensors that run freely: its still moments, on one clock.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "client/import/captures.h"
#include "client/import/intake.h"
#include "client/import/rig_map.h"
#include "client/moments/choose.h"
#include "client/moments/clocks.h"

namespace rigcal::importing {

// What is told of the choice.
struct MomentsTold {
  moments::MomentLimits limits;
  std::size_t moments = 0, chosen = 0;
  std::array<std::size_t, moments::kLeftOutReasons> left_out{};
  double least_motion_px = 0, least_motion_m = 0, usual_motion_px = 0, usual_motion_m = 0;  // of those that moved
  double worst_kept_px = 0, worst_kept_m = 0;
  struct Clock {
    std::string sensor;
    moments::SensorClock clock;
  };
  std::vector<Clock> clocks;  // of the cameras
};
// "27 of 812 moments are captures. Left out: 610 something moved (31 mm, 8.1 px in the middle; ...), 20 blurred, ..."
[[nodiscard]] std::string MomentsText(const MomentsTold& told);
// "left +27.03 ms (sigma 0.05), 19 ppm (sigma 2); right not known"; empty without cameras that have one.
[[nodiscard]] std::string ClocksText(const MomentsTold& told);

struct StillMoments {
  CapturePlan plan;  // as PlanCaptures gives it; stamps are those of the rig's clock
  MomentsTold told;
  std::vector<std::int64_t> unreadable;    // pictures of each sensor
  std::vector<std::string> first_trouble;  // of them
};

// Whether the map asks for it, or leaves it open and the bag is a stream (stream_kind.h).
[[nodiscard]] bool WantsStillMoments(const RigMap& map, const Intake& intake);
// Goes through the bag once. Nothing: no picture shows a board, and the map leaves it open what to take. kInvalidInput:
// there is no such moment, with how far the stillest moves.
[[nodiscard]] Result<std::optional<StillMoments>> FindStillMoments(const std::filesystem::path& bag, const RigMap& map,
                                                                   const Intake& intake, const Progress& progress);

}  // namespace rigcal::importing
