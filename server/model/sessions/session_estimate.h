// What one joint refinement of a session's raw observations says of the robot during that visit.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/math/ball_distance.h"
#include "server/math/se3.h"
#include "server/model/diagnosis.h"
#include "server/model/sensors/lens_misfit.h"
#include "server/model/sensors/refined_lens.h"
#include "server/model/sensors/tracker_clock.h"
#include "server/model/sessions/why_held_back.h"

namespace rigcal {

// Changes less likely than this by chance are told: of 1,000 sessions in which nothing moved, less than one is accused.
constexpr double kMovedOdds = 5e-4;
// A step that may as well be smaller than both (SquaredDistanceFromBalls within 3 sigmas) is not told: no lens and no
// mount is known that well.
constexpr double kMovedMin_m = 0.001, kMovedMin_rad = 0.001, kMovedMinSigmas = 3.0;
// Both: `step` (right tangent, m and rad) with its information, and its odds by chance.
[[nodiscard]] inline bool IsMove(const Vector6d& step, const Matrix6d& information, double odds) {
  return odds < kMovedOdds &&
         SquaredDistanceFromBalls(step, information, kMovedMin_m, kMovedMin_rad) >= kMovedMinSigmas * kMovedMinSigmas;
}

// What a camera was moved by, as one of its lens: the later captures are as well or better explained by another focal
// length.
struct FocalChange {
  double focal_ratio = 0.0, sigma_ratio = 0.0;  // after over before, less 1
  bool surely = false;                          // of the two the lens, beyond doubt; else nobody can tell

  bool operator==(const FocalChange&) const = default;
};

// A sensor that had two poses during the session, or one whose lens changed.
struct SensorMovedWithin {
  SensorId sensor;
  CaptureId last_before, first_after;
  Vector6d step = Vector6d::Zero();      // T_after = T_before Exp(step), right tangent at the sensor, m and rad
  double odds = 1.0;                     // of so large a change anywhere in the session by chance, at most
  std::optional<FocalChange> lens = {};  // then `step` is what it would be as a move
  SensorId or_sensor = {};               // this one may have moved instead, nothing in the session tells which; or none
  TargetId or_board = {};                // likewise
  SensorId or_world_of = {};             // likewise: the world in which this tracker tells its poses
};

// A board that was taken to stand still and did not, or the world of a tracker: its two places are told apart, unless
// one was seen too little.
struct BoardMovedWithin {
  TargetId board;  // empty: the world of `world_of`
  CaptureId last_before, first_after;
  Vector6d step = Vector6d::Zero();  // T_after = T_before Exp(step), right tangent at the board, m and rad
  double odds = 1.0;                 // as of a sensor
  TargetId or_board = {};            // this one may have moved instead; or none
  SensorId world_of = {};            // a tracker
};

// One sensor's look in one capture that contradicts all others and was held back, or that took no part: nothing tells
// where its board stood, or by all others that was behind the camera.
struct HeldBackLook {
  SensorId sensor;
  CaptureId capture;
  // The only other sensor that saw that place: either of the two may be wrong; empty: several did.
  SensorId against = {};
  WhyHeldBack why = WhyHeldBack::kContradicts;
};

// A lidar whose ranges are too long (negative: too short) by this where its beam meets a surface at 60 degrees of
// incidence, surely; taken out of the poses.
struct SlantBias {
  SensorId lidar;
  double too_long_m = 0.0, sigma_m = 0.0;
};

// A board that surely looks bent, by this from the lowest to the highest point of its plate; taken out of the poses.
struct BoardBend {
  TargetId board;
  double height_m = 0.0, sigma_m = 0.0;
  bool is_the_board = false;           // false: a lens may make it look so, nothing in the session tells which
  std::vector<SensorId> seen_by = {};  // cameras, sorted; estimates of before name none
};

// A board whose print is surely longer in one direction than in the other, by this part of its size; taken out of the
// poses.
struct PrintStretch {
  TargetId board;
  double longer_ratio = 0.0, sigma_ratio = 0.0;
  int corners_along = 0,
      corners_across = 0;              // inner corners in the longer direction and across it; 0: along a diagonal
  std::vector<SensorId> seen_by = {};  // cameras, sorted
};

// A camera whose given intrinsics surely are not those of its lens: poses are by numbers that were estimated with them.
struct ContradictedLens {
  SensorId camera;
  double shift_px = 0.0;   // rms over its corners: by how far the given numbers project elsewhere
  double shift_rad = 0.0;  // the same as the angle of a ray
  SensorId like = {};      // the camera that was given what fits this one; or none
};

// A camera whose pictures are off as a whole from capture to capture, beyond its corners' noise, by this angle (1
// sigma): it sits loose, was not triggered with the others, or moved while it exposed. It is in the sigmas.
struct LookScatter {
  SensorId camera;
  double sigma_rad = 0.0;
};

// A sensor whose last captures contradict all others: it was moved before them, too late for a run of captures to tell,
// or they are of another instant.
struct LateContradiction {
  SensorId sensor;
  CaptureId first;          // of its last
  int captures = 0;         // from it on in which the sensor saw something
  SensorId or_sensor = {};  // this one may have been moved instead; or none
  TargetId or_board = {};   // likewise: the only board that it saw in them, where that stands still
  bool or_world = false;    // of a tracker: it may have told them from another origin instead
};

// A lidar that saw boards where everyone else says they are, and from one capture on saw none there: it was moved by
// more than boards are looked for in its clouds, or something hides them. Its later captures took no part.
struct LostSight {
  SensorId sensor;
  CaptureId last_seen, first_lost;
  int seen = 0, lost = 0;  // captures before the loss and from it on in which it was looked at
  double odds = 1.0;       // of so clean a change anywhere in the session by chance, at most
};

// Two sensors whose relative pose, told by their clouds alone, contradicts all that was seen besides: it took no part.
struct ContradictedPair {
  SensorId a, b;
  Vector6d off = Vector6d::Zero();  // T_a_b = T_a_b_told Exp(off), right tangent at b, m and rad
  double odds = 1.0;                // of so much by chance, at most
};

// The smallest move of a sensor, half-way through the session, that would be told with a probability of 95 %, in the
// direction that is seen worst.
constexpr double kAnyMove_m = 1e3, kAnyMove_rad = 3.14159265358979;  // nothing would be told
struct SmallestMove {
  double m = kAnyMove_m, rad = kAnyMove_rad;
  int captures = 0;  // in which the sensor saw something
};

struct RefinedPose {
  SensorId sensor;
  Se3 T_ref_sensor;
  double dof = 0.0;                                // behind its covariance; 0: known
  std::optional<SmallestMove> smallest_move = {};  // estimates of before have none
};

// Captures that the covariance takes as one, and the sensor whose pose they move by most of its sigmas (T^2 of the
// group's influence, its root); none: they move nobody.
struct CaptureGroup {
  std::vector<CaptureId> captures;
  SensorId sensor = {};
  double sigmas = 0.0;
};

// How noisy a sensor is by the residuals of the session; 0: it has none of the kind.
struct ResidualNoise {
  SensorId sensor;
  double corner_px = 0.0;                       // of one coordinate of a corner
  double range_ratio = 0.0;                     // of ranges, over what the points of its plates scatter by
  double position_m = 0.0, rotation_rad = 0.0;  // of a tracker's poses; of a camera's looks as a whole: rotation
};

// Of a sensor that no refinement looked at: the smallest move that its pairs would have told, one by one.
struct SmallestMoveByPairs {
  SensorId sensor;
  SmallestMove move;
};

// Code of `why_not` where a session says enough to be refined as a whole, and that failed.
constexpr const char* kRefinementFailed = "refinement_failed";

struct SessionEstimate {
  SessionId session;
  std::string made_by;  // estimator and sizes of boards, where it comes from a store; not part of its document
  SensorId reference;
  std::vector<Diagnosis> why_not;  // not empty: there is no estimate; of what is below only `moved` and `by_pairs` have
                                   // a meaning, as pairs tell it, and `islands`
  std::vector<CaptureGroup> groups;  // in the order of time
  std::vector<ResidualNoise> noise;  // by sensor; of one that moved as it was last
  std::vector<RefinedPose> poses;    // sorted by sensor; the sensors that took part; one that moved: its last pose
  // Of the poses in their order, the reference left out: six rows each, right tangents at the sensors. `common` is the
  // part of it that errs alike on every visit (given constants, lenses); without rows: none.
  Eigen::MatrixXd covariance, common;
  // By camera; those whose lens was refined, a lens that changed as it was last. They belong to `poses`: together they
  // project to where corners were seen, which neither does with what the camera's pictures alone say.
  std::vector<RefinedLens> lenses;
  std::vector<SensorMovedWithin> moved;  // the most certain first
  std::vector<BoardMovedWithin> boards_moved;
  std::vector<HeldBackLook> held_back;                // by sensor, then capture; those that contradict first
  std::vector<LensMisfit> misfits;                    // by camera; taken out of the poses as far as they are known
  std::vector<SlantBias> slants;                      // by lidar
  std::vector<PupilShift> pupil_shifts;               // by camera
  std::vector<BoardBend> bends;                       // by board
  std::vector<PrintStretch> stretches;                // by board
  std::vector<ContradictedLens> contradicted_lenses;  // by camera
  std::vector<LookScatter> look_scatter;              // by camera
  std::vector<TrackerClock> clocks;                   // by tracker; those that told their path
  std::vector<LateContradiction> late;                // by sensor
  std::vector<LostSight> lost_sights;                 // by sensor
  std::vector<ContradictedPair> contradicted;         // the furthest beyond chance first
  std::vector<SmallestMoveByPairs> by_pairs;          // by sensor; of those that are not in `poses`
  // Sensors that nothing in the session ties to the reference, each group of them refined by itself against one of its
  // own. They have no islands.
  std::vector<SessionEstimate> islands;
};

// Each followed by its islands, as estimates of the same session, the order kept. What people are told of an island
// besides poses, lenses and noise is with the first part of the session that has poses; moves are with the first part.
[[nodiscard]] std::vector<SessionEstimate> IslandsApart(std::vector<SessionEstimate> estimates);

// Of each camera what the first of `estimates` (the newest, of a list from the newest on) says in which it took part,
// if it bends; those without an estimate say nothing.
[[nodiscard]] std::vector<LensMisfit> NewestMisfits(const std::vector<SessionEstimate>& estimates);

// First of the six rows of a pose; -1: the reference, which has none.
[[nodiscard]] inline int RowOf(const SessionEstimate& estimate, std::size_t pose) {
  if (estimate.poses[pose].sensor == estimate.reference) return -1;
  int row = 0;
  for (std::size_t i = 0; i < pose; ++i) row += estimate.poses[i].sensor == estimate.reference ? 0 : 6;
  return row;
}

}  // namespace rigcal
