// The sensor graph as a value, its solution, and a revision of it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "server/model/approval/validity.h"
#include "server/model/diagnosis.h"
#include "server/model/edges/edge.h"
#include "server/model/graph/insight.h"
#include "server/model/graph/measured_part.h"
#include "server/model/graph/suspects.h"
#include "server/model/graph/visit_scatter.h"
#include "server/model/sensors/lens_misfit.h"
#include "server/model/sensors/tracker_clock.h"
#include "server/model/sessions/why_held_back.h"

namespace rigcal {

// One measurement of the graph: the part of an Edge that solving needs.
struct GraphEdge {
  EdgeId id;
  SensorId frame_a, frame_b;
  Se3 T_a_b;
  Matrix6d Omega = Matrix6d::Zero();
  int rank = 6;
  int dof = 0;        // of the uncertainty's estimate; 0: known
  SessionId session;  // edges of one session share captures; empty: none
};

struct Graph {
  SensorId reference;             // has the identity pose
  std::vector<SensorId> sensors;  // sorted; includes the reference and sensors without any edge
  std::vector<GraphEdge> edges;   // any order; Solve sorts by id
};

// What the joint refinements of sessions made of a pose that the graph of pairs gave (graph/fusion/session_fusion.h).
struct FusedPose {
  Se3 T_ref_sensor_by_pairs;
  Matrix6d covariance_by_pairs = Matrix6d::Zero();  // right tangent at the sensor
  int sessions = 0;                                 // whose refinement tells this sensor
  // How the sensor's place scatters from visit to visit, 1 sigma per axis (root of the mean variance where axes are
  // unlike); it is in the pose's covariance. 0: it does not.
  double visit_sigma_m = 0.0, visit_sigma_rad = 0.0;
  // What its own visits alone tell of that, whatever was pooled; what other robots of the rig model told, where they
  // did; and what stands behind what was taken. Documents have the first two where there is the second.
  VisitScatter scatter = {};
  std::optional<VisitScatter> pooled_scatter = {};
  ScatterDof scatter_dof = {};
  std::optional<Vector6d> visit_variance = {};  // of each axis, where they are unlike
  // How the place goes from visit to visit without coming back, per axis: older visits count the less for it. 0: they
  // are too few, or of one day.
  double walk_m_per_sqrt_day = 0.0, walk_rad_per_sqrt_day = 0.0;
};

struct SensorPose {
  SensorId sensor;
  bool known = false;  // false: not connected to the reference, or not observable; then no numbers
  Se3 T_ref_sensor;
  Matrix6d covariance = Matrix6d::Zero();  // marginal, right tangent at the sensor; zero for the reference
  bool by_jackknife = false;               // covariance is the jackknife's through the graph; else it is analytic
  Matrix6d covariance_analytic = Matrix6d::Zero();  // H^-1: edges taken as independent; meaningful if by_jackknife
  // Behind the covariance (PooledDof over sessions and given constants): of the T^2 region of the pose.
  // Meaningful if by_jackknife; 0: nothing in it is estimated from captures.
  double dof = 0.0;
  // If not known: the directions that its edges leave free, as far as they were worked out. Right tangent at the
  // sensor, metres and radians; each has a coordinate of its own that is 1 in it and 0 in the others.
  std::vector<Vector6d> unobservable_basis = {};
  std::optional<FusedPose> fused = {};  // present: T_ref_sensor, covariance and dof are the fused ones
  // If not known, but for directions that are open: what was measured of it by pairs. Who needs a whole pose goes by
  // `known`.
  std::optional<MeasuredPart> measured_part = {};
  // Where the sensor was put: along what is open held, not measured. Null: not even part of its pose is known.
  [[nodiscard]] const Se3* Placed() const {
    return known ? &T_ref_sensor : measured_part ? &measured_part->T_ref_sensor : nullptr;
  }
};
// Six results of a pose that is known, whole or in part; else none. `R_ref_robot`: GraphSolution's.
[[nodiscard]] std::vector<AxisResult> AxesOf(const SensorPose& pose, const std::optional<Eigen::Matrix3d>& R_ref_robot);

// Where the sigmas of a known pose come from, as documents name it.
[[nodiscard]] inline std::string_view SigmaSourceOf(const SensorPose& pose) {
  return pose.fused ? "joint" : pose.by_jackknife ? "jackknife" : "analytic";
}

// A sensor that sat elsewhere in all sessions from one on than in those before, beyond what visits scatter by.
struct SensorMovedBetween {
  SensorId sensor;
  SessionId last_before, first_after;
  Vector6d step = Vector6d::Zero();  // T_after = T_before Exp(step), right tangent at the sensor, m and rad
  double odds = 1.0;                 // of so large a change between any two sessions by chance, at most
};

// Sessions whose joint refinement is in the poses, and the joint covariance of these.
struct FusedSessions {
  std::vector<SessionId> sessions;  // empty: the poses are those of the graph of pairs
  // Of each session the estimate that was fused, as SessionEstimate has it; empty: documents of before.
  std::vector<std::string> made_by;
  std::vector<SensorId> sensors;  // six rows each of `covariance`, right tangents; the reference has none
  Eigen::MatrixXd covariance;
  double next_visit_days = 0.0;  // so many days after the newest session sensors walk on in it (FusedPose::walk_...)
  // What one sensor said in one capture that counts for next to nothing, as against all others, or for nothing. By
  // session, sensor, capture.
  struct HeldBack {
    SessionId session;
    SensorId sensor;
    CaptureId capture;
    SensorId against = {};  // the only other sensor that saw that place: either may be wrong; empty: several did
    WhyHeldBack why = WhyHeldBack::kContradicts;
  };
  std::vector<HeldBack> held_back;
  // Of each tracker whose clock a session was asked about, by the newest of them; by tracker.
  struct ClockOfSession {
    SessionId session;
    TrackerClock clock;
  };
  std::vector<ClockOfSession> clocks;
  // Of the newest session: the captures that move a pose by most of its sigmas, and whose.
  struct Influential {
    SessionId session;
    std::vector<CaptureId> captures;
    SensorId sensor;
    double sigmas = 0.0;
  };
  std::optional<Influential> influential = {};
  std::vector<LensMisfit> lenses;         // of each camera what its newest session says, if it bends; by camera
  std::vector<SensorMovedBetween> moved;  // the most certain first; not part of documents, which have the verdict
  // Likewise, what sensors sat elsewhere by in one session than in the newest that tells of them, beyond what the two
  // err by, where a mount that scatters from visit to visit may explain it; the newest first.
  std::vector<SensorMovedBetween> apart;
};

// Of one edge at the solution; right tangent at frame_b, m and rad.
struct EdgeResidual {
  EdgeId edge;
  bool in_solution = false;  // false: its part of the graph is not connected to the reference
  // Log(T_ij_measured^-1 T_i^-1 T_j), at the solution, without its part along the directions that the edge leaves open.
  Vector6d e = Vector6d::Zero();
  double weighted = 0.0;  // e^T Omega e
  // T^2 = e^T C_e^+ e by the covariance of this very residual, which edges of shared captures correlate.
  bool by_jackknife = false;  // false: the rest has no meaning
  double t_squared = 0.0;
  int rank = 0;      // of C_e: directions in which other edges check this one
  double dof = 0.0;  // behind the estimate of C_e; 0: known
};

// (1/N_E) sum |e|^2 and its two parts (paper, eq. for E_global); directions that an edge leaves open are not counted.
struct GlobalError {
  double total = 0.0;
  double translation_m2 = 0.0;
  double rotation_rad2 = 0.0;
};

// The optimum, and all that is said of it. Poses and covariances in m and rad; `before`, `after` and `cost` have no
// common unit: E_global is unweighted (m^2 + rad^2), the cost in squared sigmas.
struct GraphSolution {
  bool converged = false;
  std::vector<SensorPose> poses;        // in the order of Graph::sensors
  std::vector<EdgeResidual> residuals;  // sorted by edge id
  GlobalError before, after;            // before: at the spanning-tree start
  double cost = 0.0;                    // sum e^T Omega e
  int dof = 0;                          // sum rank(Omega_e) - rank(H)
  int iterations = 0;
  std::vector<Diagnosis> diagnoses;  // unconnected sensors, weak directions, no convergence
  Suspects suspects;                 // not judged unless asked for
  Influences influences;             // likewise
  Cycles cycles;                     // likewise
  FusedSessions fused;               // likewise; residuals and errors are the graph's all the same
  // Columns: forward, left and up of the robot in the reference's frame; nothing: not known. Names of axes come from
  // it.
  std::optional<Eigen::Matrix3d> R_ref_robot = {};
};

// A numbered, stored, solved state. `document` is canonical JSON: same edges that count, same bytes; it does not hold
// its number, nor when it was made.
struct Revision {
  RobotId robot;
  int number = 0;
  Stamp created_at;
  Verdict verdict;
  std::string document;
  Digest digest;                            // of document
  std::int64_t edge_watermark = 0;          // the store's row number of the newest edge that it contains
  std::int64_t standing_watermark = 0;      // likewise, of the robot's newest standing that it counts
  std::optional<Stamp> calibrated_at = {};  // newest capture of its good edges (of pushed ones: stored); absent: none
  // By what it was judged: the number of the newest policy of all (policy_version.h), and the age that it allows.
  std::int64_t policy_watermark = 0, max_age_ns = kDefaultMaxAge_ns;
  // Likewise number of the newest of all rig models (rig_model.h); not kept, as the document has the version of its
  // own.
  std::int64_t rig_model_watermark = 0;
};

}  // namespace rigcal
