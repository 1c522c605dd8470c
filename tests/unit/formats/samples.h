// Values with which the tests of the formats work, and the golden files beside them.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "server/formats/documents.h"

namespace rigcal::formats::samples {

inline std::string FileText(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

// The golden file's bytes. A change of a format is made on purpose: RIGCAL_WRITE_GOLDEN=1 writes the file anew.
inline void ExpectGolden(const std::string& name, const std::string& actual) {
  const std::string path = std::string(RIGCAL_SOURCE_DIR) + "/tests/golden/" + name;
  if (std::getenv("RIGCAL_WRITE_GOLDEN") != nullptr) std::ofstream(path, std::ios::binary) << actual;
  EXPECT_EQ(actual, FileText(path)) << path;
}

inline Digest SomeDigest(char digit) { return Digest(std::string(64, digit)); }

inline Manifest SampleManifest() {
  Manifest manifest;
  SessionHeader& header = manifest.header;
  header.robot = RobotId("mapper-01");
  header.rig_model = "mars-mapper";
  header.captured_at = {1769860800123456789};
  header.operator_name = "Ada \"the\" Ångström";
  header.reference = SensorId("left");
  header.targets.push_back({TargetId("board"), 9, 6, 0.025, 5e-05, "A1"});
  Sensor right;
  right.id = SensorId("right");
  right.sees = TargetId("board");
  right.intrinsics = CameraIntrinsics{535.4, 539.25, 327.125, 1.0 / 3.0, {-0.29, 0.11, 0.0013, -0.0003, 0.0}};
  right.intrinsics_sigma = {0.8, 0.8, 1.1, 1.0, 0.005, 0.03, 0.0002, 0.0002, 1e-7};
  right.T_ref_nominal = Se3{{0.083, 0.0, -0.0}, Eigen::Quaterniond(0.8, 0.0, 0.6, 0.0)};
  Sensor left;
  left.id = SensorId("left");
  header.sensors = {right, left};
  header.conditions = {{"temperature", "21 C"}, {"place", "hall 2"}};
  manifest.payloads = {{"left/01.png", SensorId("left"), CaptureId("01"), SomeDigest('a'), 123},
                       {"right/01.jpg", SensorId("right"), CaptureId("01"), SomeDigest('b'), 2147483648}};
  return manifest;
}

// Six different variances and cross terms: an entry at the wrong place shows.
inline Matrix6d SampleCovariance() {
  Vector6d sigma;
  sigma << 1e-4, 2e-4, 3e-4, 4e-3, 5e-3, 6e-3;
  Matrix6d covariance = sigma.cwiseAbs2().asDiagonal();
  covariance(0, 4) = covariance(4, 0) = 1e-7;
  covariance(1, 3) = covariance(3, 1) = -2e-7;
  return covariance;
}

// Near the inverse, in round numbers: the golden bytes must not depend on how a compiler rounds an inverse.
inline Matrix6d SampleInformation() {
  Vector6d diagonal;
  diagonal << 1.25e8, 3e7, 1.125e7, 7e4, 4.5e4, 27777.75;
  Matrix6d information = diagonal.asDiagonal();
  information(0, 4) = information(4, 0) = -5e5;
  information(1, 3) = information(3, 1) = 3.75e5;
  return information;
}

inline Edge SampleEdge() {
  Edge edge;
  edge.id = EdgeId(std::string(64, '1'));
  edge.robot = RobotId("mapper-01");
  edge.frame_a = SensorId("left");
  edge.frame_b = SensorId("right");
  edge.T_a_b = Se3{{0.0833, 0.0004, -1.0 / 3.0}, Eigen::Quaterniond(0.8, 0.36, -0.0, 0.48)};
  edge.uncertainty.Omega = SampleInformation();
  edge.uncertainty.rank = 6;
  edge.uncertainty.dof = 12;
  edge.uncertainty.source = UncertaintySource::kJackknife;
  edge.uncertainty.covariance = SampleCovariance();
  edge.uncertainty.blocks = {{"01", Vector6d::LinSpaced(6, 1e-5, 6e-5)}, {"02", Vector6d::LinSpaced(6, -1e-5, 4e-5)}};
  edge.uncertainty.contributions = {{"square_size_m", 0.25 * SampleCovariance()}};
  edge.uncertainty.jackknife_ratio = 0.625;
  edge.method = "stereo";
  edge.session = SessionId(std::string(64, 'c'));
  edge.state = EdgeState::kGood;
  edge.diagnoses = {{"few_captures", "only 13 captures", "Take 20 or more."}};
  edge.figures = {{"rms_px", 0.19}, {"captures", 13.0}};
  edge.captures = {{CaptureId("01"), 0.21, true, ""}, {CaptureId("02"), 0.0, false, "board not found in right/02.png"}};
  edge.evidence = {{"left / 01: 54 corners", SensorId("left"), CaptureId("01"), SomeDigest('d'), "jpg"}};
  return edge;
}

inline Edge SampleFailedEdge() {
  Edge edge;
  edge.id = EdgeId(std::string(64, '0'));
  edge.robot = RobotId("mapper-01");
  edge.frame_a = SensorId("left");
  edge.frame_b = SensorId("up");
  edge.method = "stereo";
  edge.session = SessionId(std::string(64, 'c'));
  edge.diagnoses = {{"too_few_captures", "left and up have no capture in common", "Show both the board at once."}};
  return edge;
}

// Rotation about z is not observed.
inline Edge SamplePlanarEdge() {
  Edge edge = SampleEdge();
  edge.id = EdgeId(std::string(64, '2'));
  edge.frame_b = SensorId("lidar");
  edge.session = SessionId();
  edge.method = "given";
  Vector6d information, variance;
  information << 1e6, 1e6, 1e6, 1e4, 1e4, 0.0;
  variance << 1e-6, 1e-6, 1e-6, 1e-4, 1e-4, 0.0;
  edge.uncertainty = Uncertainty();
  edge.uncertainty.Omega = information.asDiagonal();
  edge.uncertainty.rank = 5;
  edge.uncertainty.source = UncertaintySource::kGiven;
  edge.uncertainty.covariance = variance.asDiagonal();
  edge.uncertainty.unobservable_basis = Vector6d::Unit(tangent::kRz);
  edge.captures.clear();
  edge.evidence.clear();
  edge.diagnoses.clear();
  return edge;
}

inline RevisionInput SampleRevision() {
  RevisionInput input;
  input.robot = RobotId("mapper-01");
  input.reference = SensorId("left");
  input.edges = {SampleFailedEdge(), SampleEdge(), SamplePlanarEdge()};
  for (Edge& edge : input.edges) edge.uncertainty.blocks.clear();
  input.verdict = {VerdictLevel::kWarn, "Nothing checks the result.", "Add a third sensor pair."};
  GraphSolution& solution = input.solution;
  solution.converged = true;
  solution.poses = {{SensorId("left"), true, Se3{}, Matrix6d::Zero()},
                    {SensorId("lidar"), true, input.edges[2].T_a_b, SampleCovariance()},
                    {SensorId("up"), false, Se3{}, Matrix6d::Zero()}};
  solution.residuals = {{input.edges[1].id, true, Vector6d::LinSpaced(6, 1e-6, 2e-6), 0.75},
                        {input.edges[2].id, false, Vector6d::Zero(), 0.0}};
  solution.before = {0.3, 0.2, 0.1};
  solution.after = {0.03, 0.02, 0.01};
  solution.cost = 1.25;
  solution.dof = 6;
  solution.iterations = 4;
  solution.diagnoses = {{"not_connected", "sensor up", "Calibrate it against another sensor."}};
  const EdgeId stereo = input.edges[1].id, planar = input.edges[2].id;
  solution.influences.judged = true;
  solution.influences.edges = {{stereo, true, 3.5, SensorId("lidar"), Vector6d::LinSpaced(6, 0.001, 0.002), 2.25},
                               {planar, false, 0.0, SensorId(), Vector6d::Zero(), 0.0}};
  solution.cycles.judged = true;
  solution.cycles.why_not = "Longer loops were left out.";
  solution.cycles.examined = 3, solution.cycles.tested = 2, solution.cycles.failing = 1;
  const std::vector<SensorId> sensors = {SensorId("left"), SensorId("right")};
  solution.cycles.worst = {{{stereo, planar}, sensors, Vector6d::LinSpaced(6, 0.01, 0.02), true, 90.0, 6, 12.5, 45.0},
                           {{planar, stereo}, sensors, Vector6d::LinSpaced(6, 0.03, 0.04)}};
  return input;
}

// Every bit of every double differs from a round number.
class RandomValues {
 public:
  double Number() { return normal_(engine_); }
  Vector6d Vector() {
    Vector6d values;
    for (double& value : values) value = Number();
    return values;
  }
  Matrix6d PositiveDefinite() {
    Matrix6d factor;
    for (int i = 0; i < 6; ++i) factor.col(i) = Vector();
    return Symmetrized(factor * factor.transpose() + Matrix6d::Identity());
  }
  Se3 Pose() { return Se3::Exp(Vector()); }

 private:
  std::mt19937_64 engine_{20260131};
  std::normal_distribution<double> normal_;
};

}  // namespace rigcal::formats::samples
