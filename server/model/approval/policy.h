// The limits that people set: what a calibration must keep for a robot to drive by it.
//
// A policy says as much as somebody wrote; what it leaves out is what a wider one says (Overlaid), and at last the
// default. The same value is one document, and the sum of those for all robots, for a rig model and for one robot.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "server/model/edges/edge.h"
#include "server/model/sessions/session.h"

namespace rigcal {

// Of a pose, or of how far two are apart: kept where neither is exceeded.
struct PoseLimit {
  double m = 0.0, rad = 0.0;
  friend bool operator==(const PoseLimit&, const PoseLimit&) = default;
};
// By the lengths of both halves of a tangent vector. What is as large as the limit keeps it.
[[nodiscard]] bool IsBeyond(const Vector6d& off, const PoseLimit& limit);
// How many times the limit, whichever half is larger.
[[nodiscard]] double TimesLimit(const Vector6d& off, const PoseLimit& limit);

inline constexpr PoseLimit kDefaultTolerance = {0.005, 0.005};
inline constexpr PoseLimit kDefaultMovedMin = {0.001, 0.00087266462599716479};  // 1 mm, 0.05 deg
inline constexpr PoseLimit kDefaultUnseenMove = {0.005, 0.00524};               // 5 mm, 0.3 deg
inline constexpr PoseLimit kDefaultResidualMax = {0.05, 0.05};
// Of fewer visits nobody can tell how a mount scatters, so that a wrong edge is found out; more are not fused either.
inline constexpr std::int64_t kDefaultVisitsInFull = 8, kVisitsInFullMin = 5, kVisitsInFullMax = 32;

// What holds for a sensor, or for a pair.
struct PoseLimits {
  // A pose that is less certain (any axis, 1 sigma) warns, as does a disagreement beyond it that may be chance.
  PoseLimit tolerance = kDefaultTolerance;
  // A move, or a disagreement, that chance does not explain fails from more than this on; below it, it is told.
  PoseLimit moved_min = kDefaultMovedMin;
  PoseLimit unseen_move = kDefaultUnseenMove;  // a session in which the sensor could have moved by more, unseen, warns
  friend bool operator==(const PoseLimits&, const PoseLimits&) = default;
};

// The same as far as somebody said it.
struct LimitWords {
  std::optional<double> tolerance_m = {}, tolerance_rad = {}, moved_min_m = {}, moved_min_rad = {}, unseen_move_m = {},
                        unseen_move_rad = {};
  // Of cameras whose focal length is known: the angle that so many pixels are; the smaller of both tolerances holds.
  std::optional<double> tolerance_px_at_10_m = {};
  // Results of a pose that need not be known: kRobotResults (pose_results.h), or FrameResultOf. None: all are needed.
  std::optional<std::set<std::string>> not_needed = {};
  friend bool operator==(const LimitWords&, const LimitWords&) = default;
};

// The words by name: as people write them ("tolerance_mm") and as they are kept ("tolerance_m").
struct LimitName {
  const char *name = "", *written = "", *kept = "";  // the last two: units
  double divisor = 1.0;                              // from what is written to what is kept
  std::optional<double> LimitWords::*value = nullptr;
  bool of_pairs = false;  // has a meaning for a pair, too
};
inline constexpr double kDegreesOfRadian = 57.29577951308232;
inline constexpr std::array<LimitName, 7> kLimitNames = {
    {{"tolerance", "mm", "m", 1000, &LimitWords::tolerance_m, true},
     {"tolerance", "deg", "rad", kDegreesOfRadian, &LimitWords::tolerance_rad, true},
     {"tolerance", "px_at_10_m", "px_at_10_m", 1, &LimitWords::tolerance_px_at_10_m, false},
     {"moved_min", "mm", "m", 1000, &LimitWords::moved_min_m, true},
     {"moved_min", "deg", "rad", kDegreesOfRadian, &LimitWords::moved_min_rad, true},
     {"unseen_move", "mm", "m", 1000, &LimitWords::unseen_move_m, false},
     {"unseen_move", "deg", "rad", kDegreesOfRadian, &LimitWords::unseen_move_rad, false}}};

// Who approves a revision that passes or warns, so that robots use it.
enum class ApprovalBy { kAutomatic, kPerson };  // "automatic" | "person"
[[nodiscard]] std::string NameOf(ApprovalBy by);
[[nodiscard]] ApprovalBy ApprovalByOf(const std::string& name);

struct Policy {
  LimitWords all;                          // of all sensors
  std::map<SensorId, LimitWords> sensors;  // of one: before `all`
  std::map<SensorPair, LimitWords> pairs;  // of two, a before b by name: before those of both; in pixels: nothing
  std::optional<double> residual_max_m, residual_max_rad;
  std::optional<std::int64_t> max_age_ns;    // a calibration that was measured longer ago is overdue
  std::optional<std::int64_t> captures_min;  // a pair that was measured from fewer warns
  std::optional<ApprovalBy> approval;        // automatic: a pass is approved as soon as it is there
  std::optional<bool> approve_warnings;      // and so is a warning
  std::optional<bool> approve_drift;         // and what a session leaves that found drift
  // So many of the newest sessions, and of the newest pushed edges of a pair, stay as they are in a revision; older
  // ones are merged.
  std::optional<std::int64_t> visits_in_full;
  // Odds of one false alarm or more when a session is tested against the calibration in use.
  std::optional<double> drift_false_alarm_ratio;
  // An edge beyond this quantile of its test is not explained by chance, corrected for the number of edges.
  double residual_probability = 0.999;
  std::map<SensorId, double> focal_px;  // of cameras, as far as it is known; never written
  friend bool operator==(const Policy&, const Policy&) = default;
};

// What `narrow` says, and where it says nothing what `wide` says. Key by key: what is said of a sensor holds for it
// whatever a narrower policy says of all sensors.
[[nodiscard]] Policy Overlaid(const Policy& wide, const Policy& narrow);

// "z of left": of kFrameResults, in the frame of a sensor. Without whose it would be another axis with another
// reference.
[[nodiscard]] std::string FrameResultOf(const std::string& name, const SensorId& sensor);
inline constexpr std::size_t kNotNeededMax = 64;  // of one sensor, or of all

// Of a sensor; of two, what is said of the pair, else the wider of theirs; of a walk over sensors that ends where it
// began, the widest of its pairs.
[[nodiscard]] PoseLimits LimitsOf(const Policy& policy, const SensorId& sensor);
[[nodiscard]] PoseLimits LimitsOf(const Policy& policy, const SensorId& a, const SensorId& b);
[[nodiscard]] PoseLimits LimitsOfLoop(const Policy& policy, std::span<const SensorId> sensors);
// Results of the sensor's pose that need not be known: what is said of the sensor, else of all.
[[nodiscard]] std::set<std::string> NotNeededOf(const Policy& policy, const SensorId& sensor);
// Of what cannot be tested, or accuses pairs whose session was refined as a whole: more than this fails all the same.
[[nodiscard]] PoseLimit ResidualMaxOf(const Policy& policy);

}  // namespace rigcal
