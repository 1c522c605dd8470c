#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "tests/bench/rig_coverage.h"

namespace rigcal {
namespace {

constexpr double kRad = M_PI / 180;
constexpr int kCaptures = 20;
constexpr std::size_t kLidarCaptures = 2;
// Of the body's axis, rms: multiples 0, 0.5, 1, 2, 3, 5, 10 of the tracker's noise, then of a degree.
constexpr double kTilts_deg[] = {0, 0.025, 0.05, 0.1, 0.15, 0.25, 0.5, 1, 2, 3, 5, 10};

struct MotionScore {
  double worst_edge = 0, worst_pose = 0, axis_deg = 0;
  double edge_squares = 0, pose_squares = 0;  // sums of squared errors over variances, of so many
  int edge_claims = 0, pose_claims = 0;
  int edges_open = 0, edges_failed = 0, poses_unknown = 0, body_known = 0, body_unsaid = 0, visits = 0;
};

double Mean(double sum, int count) { return count > 0 ? sum / count : 0.0; }

// The direction in which an edge knows no translation, of b's frame; what it does not know may be more than that.
Eigen::Vector3d OpenTranslation(const Uncertainty& uncertainty) {
  const Eigen::MatrixXd& open = uncertainty.unobservable_basis;
  const Eigen::JacobiSVD<Eigen::MatrixXd> turns(open.bottomRows(3), Eigen::ComputeFullV);
  return Eigen::Vector3d(open.topRows(3) * turns.matrixV().rightCols(1)).normalized();
}

// What a lidar and its partner leave open is a matter of surfaces and boards, not of the axis of the motion.
bool IsByMotion(const Edge& edge) { return edge.method != "lidar_lidar" && edge.method != "lidar_camera"; }

double AxisOff_deg(const RigCase& rig, const Edge& edge) {
  const Se3& T_body_b = rig.session.experiment.rig.SensorOf(edge.frame_b).T_body_sensor;
  const Eigen::Vector3d upright_b = T_body_b.R().transpose() * Eigen::Vector3d::UnitZ();
  return std::acos(std::min(1.0, std::abs(OpenTranslation(edge.uncertainty).dot(upright_b)))) / kRad;
}

void AddEdges(const RigCase& rig, MotionScore& score) {
  for (const Edge& edge : rig.edges) {
    if (edge.state != EdgeState::kGood) continue;
    const Vector6d error = EdgeError(rig, edge);
    score.worst_edge = std::max(score.worst_edge, WorstClaim(error, edge.uncertainty));
    score.edge_squares += error.dot(edge.uncertainty.Omega * error);
    score.edge_claims += edge.uncertainty.rank;
    if (edge.uncertainty.rank == 6) continue;
    ++score.edges_open;
    if (IsByMotion(edge)) score.axis_deg = std::max(score.axis_deg, AxisOff_deg(rig, edge));
  }
}

void AddPose(const RigCase& rig, const SensorPose& pose, MotionScore& score) {
  const Vector6d error = PoseError(rig, pose);
  score.worst_pose = std::max(score.worst_pose, WorstAxis(error, pose.covariance));
  score.pose_squares += error.cwiseAbs2().cwiseQuotient(pose.covariance.diagonal()).sum();
  score.pose_claims += 6;
}

void Add(const RigCase& rig, MotionScore& score) {
  AddEdges(rig, score);
  const SensorId body("body");
  for (const SensorPose& pose : rig.solution.poses) {
    if (pose.sensor == rig.session.header.reference) continue;
    if (!pose.known) ++score.poses_unknown;
    if (pose.known) AddPose(rig, pose, score);
    if (pose.sensor != body) continue;
    const bool said =
        std::any_of(rig.solution.diagnoses.begin(), rig.solution.diagnoses.end(), [](const Diagnosis& diagnosis) {
          return diagnosis.code == "not_observable" && diagnosis.what.find("sensor body ") != std::string::npos;
        });
    score.body_known += pose.known;
    score.body_unsaid += !pose.known && !said;
  }
  score.edges_failed += CountFailed(rig.edges);
  ++score.visits;
}

MotionScore ScoreOf(sim::MotionKind motion, double tilt_deg, int seeds, int first) {
  MotionScore score;
  for (int seed = first; seed < first + seeds; ++seed) {
    sim::Options options;
    options.seed = static_cast<std::uint64_t>(seed);
    options.captures = kCaptures;
    options.motion = motion;
    options.tilt_rms_rad = tilt_deg * kRad;
    Add(Calibrated(RecordFeatures(MarsMapper(options), kLidarCaptures)), score);
  }
  return score;
}

}  // namespace

void PrintMotions(int seeds, int first) {
  const char* comma = "";
  for (const auto& [name, motion] :
       {std::pair("planar", sim::MotionKind::kPlanar), std::pair("on_the_spot", sim::MotionKind::kSpot)}) {
    std::printf("%s\"%s\": [", comma, name);
    comma = "";
    for (const double tilt_deg : kTilts_deg) {
      const MotionScore score = ScoreOf(motion, tilt_deg, seeds, first);
      std::printf(
          "%s\n  {\"tilt_deg\": %.3f, \"worst_edge_sigmas\": %.3f, \"worst_pose_sigmas\": %.3f, "
          "\"edge_mean_square\": %.3f, \"pose_mean_square\": %.3f, \"pose_claims\": %d, \"axis_deg\": %.4f, "
          "\"edges_open\": %d, \"edges_failed\": %d, \"poses_unknown\": %d, \"body_known\": %d, \"body_unsaid\": %d, "
          "\"visits\": %d}",
          comma, tilt_deg, score.worst_edge, score.worst_pose, Mean(score.edge_squares, score.edge_claims),
          Mean(score.pose_squares, score.pose_claims), score.pose_claims, score.axis_deg, score.edges_open,
          score.edges_failed, score.poses_unknown, score.body_known, score.body_unsaid, score.visits);
      std::fflush(stdout);
      comma = ",";
    }
    std::printf("]");
    comma = ",\n";
  }
}

}  // namespace rigcal
