#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "tests/bench/rig/rig_coverage.h"

namespace rigcal {
namespace {

constexpr double kRad = M_PI / 180;
constexpr int kCaptures = 20;
constexpr std::size_t kMotionLidarCaptures = 2;
// Of the body's axis, rms: multiples 0, 0.5, 1, 2, 3, 5, 10 of the tracker's noise, then of a degree.
constexpr double kTilts_deg[] = {0, 0.025, 0.05, 0.1, 0.15, 0.25, 0.5, 1, 2, 3, 5, 10};

struct MotionScore {
  double worst_edge = 0, worst_axis = 0, worst_pose = 0, axis_deg = 0;
  double edge_squares = 0, pose_squares = 0;  // sums of squared errors over variances, of so many
  int edge_claims = 0, edge_claims_beyond = 0, pose_claims = 0;
  int edges_open = 0, edges_failed = 0, poses_unknown = 0, body_known = 0, body_unsaid = 0, visits = 0;
};

double Mean(double sum, int count) { return count > 0 ? sum / count : 0.0; }

// The direction in which an edge knows no translation, of b's frame; what it does not know may be more than that.
Eigen::Vector3d OpenTranslation(const Uncertainty& uncertainty) {
  const Eigen::MatrixXd& open = uncertainty.unobservable_basis;
  const Eigen::JacobiSVD<Eigen::MatrixXd> turns(open.bottomRows(3), Eigen::ComputeFullV);
  return Eigen::Vector3d(open.topRows(3) * turns.matrixV().rightCols(1)).normalized();
}

const Sensor& SensorNamed(const RigCase& rig, const SensorId& id) {
  const std::vector<Sensor>& sensors = rig.session.header.sensors;
  return *std::find_if(sensors.begin(), sensors.end(), [&](const Sensor& sensor) { return sensor.id == id; });
}

// What two lidars leave open is a matter of surfaces.
bool NamesAxis(const Edge& edge) { return edge.method != "lidar_lidar"; }

// Across the plane in which the boards' true normals nearly lie, frame a.
Eigen::Vector3d AcrossNormals(const RigCase& rig, const Edge& edge) {
  const sim::Experiment& experiment = rig.session.experiment;
  const SensorId& camera = rig.session.seen.views.contains(edge.frame_a) ? edge.frame_a : edge.frame_b;
  const Eigen::Matrix3d R_world_plate = experiment.rig.BoardOf(*SensorNamed(rig, camera).sees).T_world_plate.R();
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < experiment.captures.size(); ++k) {
    const auto at = std::find_if(edge.captures.begin(), edge.captures.end(),
                                 [&](const CaptureResidual& one) { return one.capture == experiment.captures[k]; });
    if (at == edge.captures.end() || !at->used) continue;
    const Eigen::Vector3d normal_a = experiment.T_world_sensor(edge.frame_a, k).R().transpose() * R_world_plate.col(2);
    sum += normal_a * normal_a.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum).eigenvectors().col(0);
}

// Of the axis that a lidar and a camera name.
double AcrossOff_deg(const RigCase& rig, const Edge& edge) {
  const Eigen::Vector3d axis_a(edge.figures.at("axis_a_x_ratio"), edge.figures.at("axis_a_y_ratio"),
                               edge.figures.at("axis_a_z_ratio"));
  return std::acos(std::min(1.0, std::abs(axis_a.dot(AcrossNormals(rig, edge))))) / kRad;
}

double AxisOff_deg(const RigCase& rig, const Edge& edge) {
  if (edge.method == "lidar_camera") return AcrossOff_deg(rig, edge);
  const Se3& T_body_b = rig.session.experiment.rig.SensorOf(edge.frame_b).T_body_sensor;
  const Eigen::Vector3d upright_b = T_body_b.R().transpose() * Eigen::Vector3d::UnitZ();
  return std::acos(std::min(1.0, std::abs(OpenTranslation(edge.uncertainty).dot(upright_b)))) / kRad;
}

void AddEdges(const RigCase& rig, MotionScore& score) {
  for (const Edge& edge : rig.edges) {
    if (edge.state != EdgeState::kGood) continue;
    const Vector6d error = EdgeError(rig, edge);
    const Eigen::VectorXd sigmas = ClaimedSigmas(error, edge.uncertainty);
    score.worst_edge = std::max(score.worst_edge, sigmas.maxCoeff());
    score.worst_axis = std::max(score.worst_axis, WorstKnownAxis(error, edge.uncertainty));
    score.edge_claims_beyond += static_cast<int>((sigmas.array() > 4.0).count());
    score.edge_squares += error.dot(edge.uncertainty.Omega * error);
    score.edge_claims += edge.uncertainty.rank;
    if (edge.uncertainty.rank == 6) continue;
    ++score.edges_open;
    if (NamesAxis(edge)) score.axis_deg = std::max(score.axis_deg, AxisOff_deg(rig, edge));
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
    Add(Calibrated(RecordFeatures(MarsMapper(options), kMotionLidarCaptures)), score);
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
          "%s\n  {\"tilt_deg\": %.3f, \"worst_edge_sigmas\": %.3f, \"worst_edge_axis_sigmas\": %.3f, "
          "\"worst_pose_sigmas\": %.3f, "
          "\"edge_claims\": %d, \"edge_claims_beyond_4\": %d, \"edge_mean_square\": %.3f, \"pose_mean_square\": %.3f, "
          "\"pose_claims\": %d, \"axis_deg\": %.4f, "
          "\"edges_open\": %d, \"edges_failed\": %d, \"poses_unknown\": %d, \"body_known\": %d, \"body_unsaid\": %d, "
          "\"visits\": %d}",
          comma, tilt_deg, score.worst_edge, score.worst_axis, score.worst_pose, score.edge_claims,
          score.edge_claims_beyond, Mean(score.edge_squares, score.edge_claims),
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
