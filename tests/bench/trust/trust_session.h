// A session that breaks a calibration's assumptions, and what the service says of it beside what is true.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/sim/truth.h"
#include "tests/bench/rig/second_tracker.h"
#include "tests/bench/trust/told.h"

namespace rigcal {

struct HostileVisit {
  sim::Options options;
  bool two_cameras = false;                       // the robot has its front cameras only
  std::vector<SensorId> only = {};                // the robot has these sensors only; empty: all
  bool no_tracker = false;                        // nobody tells where its body is
  std::optional<OtherWorld> second_tracker = {};  // with a second tracker, the mast
  bool single_tags = false;                       // each board is one large tag
  bool found_plates = false;      // boards are searched for in whole clouds, instead of cut out by their truth
  double aspect_ratio = 0.0;      // of every camera the fx that is given is too long by this part
  bool exchanged_lenses = false;  // the first two cameras are given each other's intrinsics
  bool bound = false;             // with the Cramer-Rao bound
  int visits = 1;                 // of one robot, one after the other: seeds from options.seed on
  int next_visits = 0;            // whose true poses the told ones are held against, instead of those of the session
};

// One sensor's told pose against the truth: Log(told^-1 true), right tangent.
struct PoseFigures {
  bool known = false;
  std::vector<Vector6d> errors;         // one, or one per next visit
  std::optional<Vector6d> error_after;  // after a bump: of the pose and the reference's as the session left them
  Matrix6d covariance = Matrix6d::Zero();
  double limit = 0.0;  // of T^2 in the 95 % region
  std::optional<sim::BoundSigma> bound;
};

struct JudgedVisit {
  HostileVisit visit;
  sim::Experiment experiment;  // of the first visit
  Told told;
  std::map<SensorId, PoseFigures> poses;  // without the reference
  double judge_s = 0.0;                   // from the features to the verdict, wall
};

[[nodiscard]] sim::Experiment ExperimentOf(const HostileVisit& visit, std::uint64_t seed);
[[nodiscard]] JudgedVisit JudgeVisit(const HostileVisit& visit);

}  // namespace rigcal
