// Measures the hand-eye calibration of two sensors of a session folder: hand_eye_measure SESSION A B prints one JSON
// object: the edge, and where both have captures the closed form by itself.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "server/calib/eye_to_hand/exchanged_roles.h"
#include "server/calib/motion/hand_eye.h"
#include "server/calib/motion/motion_start.h"
#include "server/detect/board.h"
#include "server/formats/sessions/poses.h"
#include "server/formats/sessions/session_folder.h"

namespace rigcal {
namespace {

using calib::HandEyeProblem;
using calib::HandEyeSide;

std::string ReadFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

const Sensor& SensorOf(const Manifest& manifest, const std::string& id) {
  for (const Sensor& sensor : manifest.header.sensors)
    if (sensor.id.str() == id) return sensor;
  std::fprintf(stderr, "no sensor %s\n", id.c_str());
  std::exit(2);
}

HandEyeSide SideOf(const std::filesystem::path& folder, const Manifest& manifest, const std::string& id) {
  HandEyeSide side;
  side.sensor = SensorOf(manifest, id);
  if (side.sensor.kind == SensorKind::kCamera) {
    for (const Target& target : manifest.header.targets)
      if (!side.board && (!side.sensor.sees || *side.sensor.sees == target.id)) side.board = target;
  }
  for (const Payload& payload : manifest.payloads) {
    if (payload.sensor != side.sensor.id) continue;
    const std::string bytes = ReadFile(folder / payload.path);
    if (side.board)
      side.views.emplace_back(payload.capture, detect::Detect(std::as_bytes(std::span(bytes)), *side.board).view);
    else
      side.poses = formats::ReadPoses(bytes, side.sensor.kind, payload.path).value();
  }
  std::sort(side.views.begin(), side.views.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  return side;
}

void PrintPose(const char* name, const Se3& T) {
  const Vector6d xi = T.Log();
  std::printf("\"%s_mm\": [%.4f, %.4f, %.4f], \"%s_rvec\": [%.6f, %.6f, %.6f], ", name, 1e3 * T.p_m.x(),
              1e3 * T.p_m.y(), 1e3 * T.p_m.z(), name, xi[3], xi[4], xi[5]);
}

// The poses of one side by capture.
std::map<CaptureId, Se3> PosesOf(const HandEyeSide& side) {
  std::map<CaptureId, Se3> poses;
  if (!side.board) {
    for (const TimedPose& pose : side.poses) poses[pose.capture] = pose.T_world_body;
    return poses;
  }
  const auto camera = calib::EstimateCamera({side.sensor, *side.board, side.views});
  if (!camera) return poses;
  for (const auto& [capture, T_cam_board] : camera->T_cam_board) poses[capture] = T_cam_board.Inverse();
  return poses;
}

Se3 ClosedFormPose(const HandEyeProblem& problem) {
  const auto a = PosesOf(problem.a), b = PosesOf(problem.b);
  std::vector<Se3> of_a, of_b;
  for (const auto& [capture, pose] : a) {
    if (!b.contains(capture)) continue;
    of_a.push_back(pose);
    of_b.push_back(b.at(capture));
  }
  return calib::ClosedFormOf(of_a, of_b).X;
}

void PrintClosedForm(const HandEyeProblem& problem) {
  if (problem.method == Method::kPoseStreams) return;
  if (problem.method != Method::kEyeToHand) return PrintPose("closed_form", ClosedFormPose(problem));
  const calib::ExchangedRoles roles = calib::WithRolesExchanged(problem);
  PrintPose("closed_form", calib::EdgePose(roles, ClosedFormPose(roles.hand_eye)));
}

int Measure(const std::filesystem::path& folder, const std::string& a, const std::string& b) {
  const auto manifest = formats::ReadSessionFolder(folder, {});
  if (!manifest) return std::fprintf(stderr, "%s\n", Sentence(manifest.error()).c_str()), 1;
  HandEyeProblem problem;
  problem.a = SideOf(folder, *manifest, a);
  problem.b = SideOf(folder, *manifest, b);
  problem.method = MethodFor(manifest->header, problem.a.sensor, problem.b.sensor).value();
  const auto start = std::chrono::steady_clock::now();
  const Edge edge = problem.method == Method::kEyeToHand ? calib::EstimateEyeToHandEdge(problem)
                                                         : calib::EstimateHandEyeEdge(problem);
  const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  std::printf("{\"state\": \"%s\", \"method\": \"%s\", \"diagnoses\": [",
              edge.state == EdgeState::kGood ? "good" : "failed", edge.method.c_str());
  for (std::size_t i = 0; i < edge.diagnoses.size(); ++i)
    std::printf("%s\"%s\"", i ? ", " : "", edge.diagnoses[i].code.c_str());
  std::printf("], ");
  for (const Diagnosis& diagnosis : edge.diagnoses)
    std::fprintf(stderr, "%s: %s\n", diagnosis.code.c_str(), diagnosis.what.c_str());
  PrintClosedForm(problem);
  PrintPose("T_a_b", edge.T_a_b);
  const Vector6d sigma = edge.uncertainty.covariance.diagonal().cwiseSqrt();
  std::printf("\"rank\": %d, \"sigma_mm\": [%.4f, %.4f, %.4f], \"sigma_deg\": [%.5f, %.5f, %.5f], ",
              edge.uncertainty.rank, 1e3 * sigma[0], 1e3 * sigma[1], 1e3 * sigma[2], 180 / M_PI * sigma[3],
              180 / M_PI * sigma[4], 180 / M_PI * sigma[5]);
  for (const auto& [name, value] : edge.figures) std::printf("\"%s\": %.9g, ", name.c_str(), value);
  std::printf("\"edge_ms\": %.1f}\n", ms);
  return edge.state == EdgeState::kGood ? 0 : 1;
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  if (argc != 4 || !std::filesystem::is_directory(argv[1])) {
    std::fprintf(stderr, "usage: hand_eye_measure SESSION A B\n");
    return 2;
  }
  return rigcal::Measure(argv[1], argv[2], argv[3]);
}
