// All that one session's sensors saw, as one least-squares problem on raw observations: corners in pictures, plane
// moments of plates in clouds, poses of a tracker, relative poses known from elsewhere. README.md has the equations.
//
// A place is a pose of the reference sensor in a world: the tracker's, or that of the boards that stand still, one per
// capture. A board that does not stand still is a world of its own in every capture, and that capture's place is the
// reference sensor's pose in the frame of the board.
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <vector>

#include "server/calib/camera/projection.h"
#include "server/calib/camera/seen_corners.h"
#include "server/calib/joint/problem/spline_field.h"
#include "server/calib/motion/local_path.h"
#include "server/calib/planes/plane_moments.h"
#include "server/math/se3.h"
#include "server/model/sensors/pose_table.h"
#include "server/model/sessions/session.h"

namespace rigcal::calib::joint {

constexpr int kNone = -1;

// Indices into the lists of SessionProblem; `board` kNone where the place's world is the board itself.
struct Where {
  int sensor = kNone, place = kNone, board = kNone;
  int target = kNone;  // which board it is, for its points and its scale
};

struct CornersSeen : Where {
  int camera = kNone;   // whose lens: a sensor that was moved is two sensors with one lens
  SeenCorners corners;  // indices of the target's points
};
struct PlateSeen : Where {
  PlaneMoments moments;  // of range_sigma_m of its lidar: a chi-square of `points` at sigma factor 1
};
// By a tracker of its body, the sensor. Its world is the place's; of a second tracker it is the frame `board`.
struct PoseTold : Where {
  Se3 T_world_body;  // for the capture's instant, as it is told; of a second tracker from its first pose
  Stamp stamp;       // of that instant, by the tracker's clock
  int clock =
      kNone;  // whose lateness moves the pose along `path`; kNone: the body stands still, or none knows how it moves
  LocalPath path;
};
// Log(T_a_b^-1 T_ref_a^-1 T_ref_b) of covariance Omega^-1.
struct RelativeKnown {
  int sensor_a = kNone, sensor_b = kNone;
  Se3 T_a_b;
  Matrix6d Omega = Matrix6d::Zero();
  int dof = 0;  // behind Omega; 0: known
};

struct Lens {
  CameraModel model = CameraModel::kPinholeRadtan;
  std::vector<int> refined;                           // of the intrinsics, by index; the others stay
  IntrinsicsVector given = IntrinsicsVector::Zero();  // where a sigma pulls
  IntrinsicsVector sigma = IntrinsicsVector::Zero();  // 0: nothing pulls
  PictureSize picture = {};                           // empty: no field of shifts is looked for
  bool is_given = false;                              // its intrinsics are those of session.yaml, which `given` has
  bool is_exact = false;                              // likewise, without a sigma
  bool is_freed = false;                              // was given, and contradicted: estimated instead
  double pupil_sigma_m = 0.0;                         // of SessionState::pupil_shift_m; 0: not estimated
};

// A tracker's clock: what it tells for an instant is where its body was some time before, none by N(0, sigma_s^2).
struct PoseClock {
  SensorId tracker;
  double sigma_s = 0.0;
  std::shared_ptr<const PoseTable> path;  // that the tracker told; never null
};

// What stands still in the world: a board, or the world in which another tracker than the one whose world this is tells
// its poses, with the origin where its body was at its first capture.
struct StillFrame {
  TargetId board;
  SensorId tracker;
};

struct SessionProblem {
  std::vector<SensorId> sensors;
  int reference = 0;  // has the identity pose
  std::vector<CaptureId> captures;
  std::vector<int> capture_of_place;  // ascending
  std::vector<StillFrame> boards;     // and other trackers' worlds; their poses in the world are unknown
  int held_board = kNone;  // of `boards`: its pose is the world's frame; kNone where a tracker tells the world
  std::vector<Target> targets;
  std::vector<std::vector<Eigen::Vector3d>> target_points;       // TargetPoints of each
  std::vector<std::vector<Eigen::Vector3d>> target_bend_shapes;  // BendShapes of each
  std::vector<Lens> cameras;
  std::vector<double> range_bias_sigma_m;  // per sensor; 0: no bias is estimated
  std::vector<PoseClock> clocks;           // one that no pose depends on is not estimated
  std::vector<double> slant_bias_sigma_m;  // per sensor; likewise
  std::vector<double> bend_sigma_m;        // per target; likewise
  std::vector<double> strain_sigma_ratio;  // per target; likewise
  std::vector<CornersSeen> corners;
  std::vector<PlateSeen> plates;
  std::vector<PoseTold> poses;
  std::vector<RelativeKnown> relatives;
};

// visit(look) with the Where of every look: corners, then plates, then poses, each in its order.
template <typename Visit>
void ForEachLook(const SessionProblem& problem, const Visit& visit) {
  for (const Where& look : problem.corners) visit(look);
  for (const Where& look : problem.plates) visit(look);
  for (const Where& look : problem.poses) visit(look);
}
// The name of the capture that a place stands for.
[[nodiscard]] const CaptureId& CaptureAt(const SessionProblem& problem, int place);

// Indices of sensors by name; of one that moved, which is in the problem several times, the one that was seen last.
[[nodiscard]] std::map<SensorId, int> LastOfEach(const SessionProblem& problem);

struct SessionState {
  std::vector<Se3> T_ref_sensor;             // per sensor
  std::vector<IntrinsicsVector> intrinsics;  // per camera of the problem
  std::vector<Se3> T_world_board;            // per frame that stands still
  std::vector<Se3> T_world_ref;              // per place
  std::vector<double> board_scale_ratio;     // per target: its points are larger than told by this part
  std::vector<double> range_bias_m;          // per sensor: its ranges are too short by this
  std::vector<double> clock_late_s;          // per clock
  // Per camera: its entrance pupil lies this towards what is seen at 45 degrees to its axis, 2 sin(angle)^2 of it at
  // another angle.
  std::vector<double> pupil_shift_m;
  std::vector<double> slant_bias_m;           // per sensor: and by this more where rays meet a plate at 60 degrees
  std::vector<Eigen::Vector3d> board_bend_m;  // per target: its points are deeper by this along the shapes of bends
  std::vector<Eigen::Vector3d> print_strain_ratio;  // per target: of its print, in its plane: xx, yy, xy
  std::vector<Eigen::VectorXd>
      field_px;                   // per camera, or none: coefficients of what shifts its pictures beyond the model
  std::vector<double> field_dof;  // per camera, or none: as many of its numbers have the coefficients taken up
};

// How noisy each sensor is: of corners px, of plates a factor on range noise, of a tracker m and rad. `sigma_rad` of a
// camera: by how much its looks err as a whole (observation.h, LookError), as an angle; 0: not at all.
struct SensorNoise {
  double sigma = 1.0, sigma_rad = 0.0;
  double burst_share = 0.0;  // of a corner's variance: what pictures of one burst have in common
};

// Where each unknown stands in the vector of all that captures share; kNone: held. Behind the last unknown the
// reference sensor has six columns too, and behind these the held board: they are never moved, but tell what their
// observations say against their poses.
struct Layout {
  std::vector<int> pose;    // per sensor, six
  std::vector<int> lens;    // per camera, as many as refined
  std::vector<int> board;   // per frame that stands still, six
  std::vector<int> scale;   // per target, one
  std::vector<int> bias;    // per sensor, one
  std::vector<int> clock;   // per clock, one
  std::vector<int> slant;   // per sensor, one
  std::vector<int> pupil;   // per camera, one
  std::vector<int> bend;    // per target, three
  std::vector<int> strain;  // per target, three
  int size = 0;             // without those that are never moved
  int columns = 0;          // with them
};
// In the order of the members above; held: the reference, the held board, lenses without refined numbers, clocks that
// no pose depends on, and scales, biases, pupils, bends and strains without a sigma.
[[nodiscard]] Layout LayoutOf(const SessionProblem& problem);

// The state moved by `step` of the layout (right tangents) and by six numbers per place.
[[nodiscard]] SessionState Moved(const SessionProblem& problem, const Layout& layout, const SessionState& state,
                                 const Eigen::VectorXd& step, const std::vector<Vector6d>& place_steps);

}  // namespace rigcal::calib::joint
