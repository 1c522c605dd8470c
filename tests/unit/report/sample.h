// A robot for the report's tests: five cameras, a tracker that nothing reaches, one failed edge, one planar edge.
#pragma once

#include <cmath>
#include <string>

#include "server/base/digests/sha256.h"
#include "server/report/render.h"

namespace rigcal::report {

constexpr std::int64_t kDay_ns = 86'400'000'000'000;

inline Uncertainty SampleUncertainty(double sigma_m, double sigma_rad, int dof) {
  Matrix6d Omega = Matrix6d::Zero();
  for (int axis = 0; axis < 6; ++axis) {
    const double sigma = (axis < 3 ? sigma_m : sigma_rad) * (1.0 + 0.25 * (axis % 3));
    Omega(axis, axis) = 1.0 / (sigma * sigma);
  }
  return FromInformation(Omega, dof > 0 ? UncertaintySource::kJackknife : UncertaintySource::kGiven, dof);
}

inline Se3 SamplePose(double x_m, double y_m, double z_m, double yaw_rad) {
  Se3 T;
  T.p_m = {x_m, y_m, z_m};
  T.q = Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  return T;
}

inline Edge SampleEdge(const std::string& a, const std::string& b, const Se3& T_a_b) {
  Edge edge;
  edge.robot = RobotId("mapper-01");
  edge.frame_a = SensorId(a);
  edge.frame_b = SensorId(b);
  edge.id = EdgeId(Sha256Of("edge " + a + b).str());
  edge.T_a_b = T_a_b;
  edge.state = EdgeState::kGood;
  edge.method = "stereo";
  edge.session = SessionId(Sha256Of("session").str());
  edge.uncertainty = SampleUncertainty(0.00021, 0.0004, 8);
  return edge;
}

inline void AddCaptures(Edge& edge) {
  for (int i = 1; i <= 9; ++i) {
    const std::string name = "0" + std::to_string(i);
    const bool used = i != 5;
    edge.captures.push_back(
        {CaptureId(name), used ? 0.14 + 0.02 * i : 0.0, used, used ? "" : "board not found in right"});
    for (const auto& sensor : {edge.frame_a, edge.frame_b})
      edge.evidence.push_back({sensor.str() + " / " + name + (used ? ": 54 corners" : ": no board"), sensor,
                               CaptureId(name), Digest(Sha256Of("picture" + name + sensor.str()).str()), "jpg"});
  }
  edge.figures = {{"rms_px", 0.2231}, {"captures", 8}, {"baseline_m", 0.08318}, {"epipolar_error_px", 0.1834}};
  edge.uncertainty.contributions.push_back({"board size 25 mm \xC2\xB1 0.02 mm", Matrix6d::Identity() * 4e-10});
}

inline Edge FailedEdge() {
  Edge edge = SampleEdge("front_left", "rear", Se3());
  edge.state = EdgeState::kFailed;
  edge.diagnoses = {{"too_few_captures",
                     "Only 2 of 9 captures show the board to both front_left and rear; 3 are needed.",
                     "Take at least 6 more captures with the board where the two pictures overlap."}};
  for (int i = 1; i <= 3; ++i)
    edge.captures.push_back({CaptureId("0" + std::to_string(i)), 0.31, i < 3, i < 3 ? "" : "board cut off in rear"});
  return edge;
}

inline void AddPose(formats::RevisionInput& revision, const std::string& sensor, bool known, const Se3& T,
                    double sigma_m) {
  SensorPose pose{SensorId(sensor), known, T, Matrix6d::Zero()};
  for (int axis = 0; axis < 6 && sigma_m > 0; ++axis)
    pose.covariance(axis, axis) = std::pow((axis < 3 ? sigma_m : 2 * sigma_m) * (1.0 + 0.2 * (axis % 3)), 2);
  revision.solution.poses.push_back(pose);
}

inline ReportInput SampleReport() {
  ReportInput input;
  input.number = 7;
  input.created_at = *ParseIso("2026-01-31T12:00:00Z");
  input.digest = Sha256Of("document");
  input.software_version = "0.1.0";
  auto& revision = input.revision;
  revision.robot = RobotId("mapper-01");
  revision.reference = SensorId("front_left");
  revision.verdict = {VerdictLevel::kWarn, "One edge failed: front_left to rear; the sensor tracker has no pose.",
                      "Repeat the session for front_left and rear, and connect tracker."};
  const auto T_right = SamplePose(0.08318, 0.0004, -0.0012, 0.0087), T_rear = SamplePose(-0.41, 0.02, -0.3, 3.1),
             T_lidar = SamplePose(0.05, 0.03, 0.21, 1.57), T_top = SamplePose(0.1, -0.2, 0.4, -0.4);
  Edge overlap = SampleEdge("front_left", "front_right", T_right);
  AddCaptures(overlap);
  Edge planar = SampleEdge("front_right", "top", T_right.Inverse() * T_top);
  Matrix6d Omega = planar.uncertainty.Omega;
  Omega(tangent::kZ, tangent::kZ) = 0.0;
  planar.uncertainty = FromInformation(Omega, UncertaintySource::kGiven, 0);
  planar.diagnoses = {
      {"planar_motion", "The motion was planar: nothing is known along z.", "Tilt the robot between captures."}};
  revision.edges = {overlap,
                    SampleEdge("front_left", "lidar", T_lidar),
                    SampleEdge("front_right", "rear", T_right.Inverse() * T_rear),
                    SampleEdge("rear", "lidar", T_rear.Inverse() * T_lidar),
                    planar,
                    FailedEdge()};
  revision.edges[1].session = SessionId();
  revision.edges[1].method = "given";
  AddPose(revision, "front_left", true, Se3(), 0);
  AddPose(revision, "front_right", true, T_right, 0.0002);
  AddPose(revision, "lidar", true, T_lidar, 0.0011);
  AddPose(revision, "rear", true, T_rear, 0.0023);
  AddPose(revision, "top", true, T_top, 0.0009);
  AddPose(revision, "tracker", false, Se3(), 0);
  double size = 0.0;
  for (const Edge& edge : revision.edges) {
    if (edge.state == EdgeState::kFailed) continue;
    EdgeResidual residual{edge.id, true, Vector6d::Zero(), 0.0};
    residual.e << 0.0001 * ++size, -0.00005, 0.00002, 0.0002, 0.0001, -0.0003;
    residual.weighted = residual.e.dot(edge.uncertainty.Omega * residual.e);
    revision.solution.residuals.push_back(residual);
  }
  revision.solution.converged = true;
  revision.solution.before = {4.1e-6, 2.2e-6, 1.9e-6};
  revision.solution.after = {3.2e-7, 1.7e-7, 1.5e-7};
  revision.solution.cost = 6.3;
  revision.solution.dof = 6;
  for (const Evidence& picture : revision.edges[0].evidence) input.evidence.push_back(picture.digest);
  input.evidence.pop_back();
  return input;
}

inline std::string PageOf(const ReportInput& input) { return RenderRevision(input, "{}").value().at("index.html"); }

// The part of the page from `start` to the next `end`; empty where it does not start.
inline std::string Between(const std::string& page, const std::string& start, const std::string& end) {
  const auto from = page.find(start);
  return from == std::string::npos ? "" : page.substr(from, page.find(end, from) - from);
}

inline std::string RowOf(const std::string& page, const std::string& heading) {
  return Between(page, "<th scope=\"row\">" + heading, "</tr>");
}

inline int CountOf(const std::string& text, const std::string& part) {
  int count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

}  // namespace rigcal::report
