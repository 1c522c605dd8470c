// Measures the lidar-camera calibration of one session folder: lidar_camera_measure SESSION [BOARD_POINTS] prints one
// JSON object. BOARD_POINTS: a folder of <capture>.pcd with the board's points only, to judge the patches that were
// chosen.
#include <Eigen/Eigenvalues>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "server/calib/lidar_camera/lidar_camera.h"
#include "server/detect/board.h"
#include "server/detect/clouds/cloud_board.h"
#include "server/formats/clouds/cloud.h"
#include "server/formats/sessions/payload_path.h"
#include "server/formats/sessions/session_folder.h"

namespace rigcal {
namespace {

using calib::LidarCameraProblem;

std::string ReadFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

Result<Cloud> CloudIn(const std::filesystem::path& path) {
  const std::string bytes = ReadFile(path);
  return formats::ReadCloud(std::as_bytes(std::span(bytes)), formats::SuffixOf(path.string()), path.filename());
}

CloudView CloudViewIn(const std::filesystem::path& path, const Target& board) {
  const Result<Cloud> cloud = CloudIn(path);
  if (cloud) return detect::DetectPlate(*cloud, board).view;
  CloudView view;
  view.why_not = Sentence(cloud.error());
  return view;
}

// The session's first camera, first lidar and first target.
LidarCameraProblem ProblemOf(const std::filesystem::path& folder, const Manifest& manifest) {
  LidarCameraProblem problem;
  for (const Sensor& sensor : manifest.header.sensors)
    (sensor.kind == SensorKind::kLidar ? problem.lidar : problem.camera) = sensor;
  problem.board = manifest.header.targets.front();
  std::map<CaptureId, calib::LidarCameraCapture> captures;
  for (const Payload& payload : manifest.payloads) {
    calib::LidarCameraCapture& capture = captures[payload.capture];
    capture.capture = payload.capture;
    if (payload.sensor == problem.lidar.id) {
      capture.cloud = CloudViewIn(folder / payload.path, problem.board);
    } else {
      const std::string bytes = ReadFile(folder / payload.path);
      capture.view = detect::Detect(std::as_bytes(std::span(bytes)), problem.board).view;
    }
  }
  for (auto& [id, capture] : captures) problem.captures.push_back(std::move(capture));
  return problem;
}

LidarCameraProblem Half(const LidarCameraProblem& problem, std::size_t remainder) {
  LidarCameraProblem half = problem;
  half.captures.clear();
  for (std::size_t i = 0; i < problem.captures.size(); ++i)
    if (i % 2 == remainder) half.captures.push_back(problem.captures[i]);
  return half;
}

// Largest |difference| / sqrt(sigma^2 + sigma^2) over the six axes; negative if one half gives no edge.
double HalvesRatio(const LidarCameraProblem& problem) {
  const Edge one = calib::EstimateLidarCameraEdge(Half(problem, 0)),
             two = calib::EstimateLidarCameraEdge(Half(problem, 1));
  if (one.state != EdgeState::kGood || two.state != EdgeState::kGood) return -1;
  const Vector6d difference = (one.T_a_b.Inverse() * two.T_a_b).Log();
  const Vector6d variance = one.uncertainty.covariance.diagonal() + two.uncertainty.covariance.diagonal();
  return (difference.array().abs() / variance.array().sqrt()).maxCoeff();
}

struct Plane {
  Eigen::Vector3d normal, centre_m;
};

Plane PlaneOf(const std::vector<Eigen::Vector3f>& points_m) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : points_m) mean += p.cast<double>() / static_cast<double>(points_m.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& p : points_m)
    scatter += (p.cast<double>() - mean) * (p.cast<double>() - mean).transpose();
  return {Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0), mean};
}

struct Judged {
  int near = 0, judged = 0;  // within 2 deg and 20 mm
  double worst_deg = 0, worst_mm = 0;
};

Judged JudgePatches(const LidarCameraProblem& problem, const calib::LidarCameraEstimate& estimate,
                    const std::filesystem::path& board_points) {
  Judged result;
  for (const auto& capture : problem.captures) {
    const auto patch = estimate.patch_idx.find(capture.capture);
    const auto truth = CloudIn(board_points / (capture.capture.str() + ".pcd"));
    if (patch == estimate.patch_idx.end() || !truth) continue;
    const Plane found = PlaneOf(capture.cloud->candidates[patch->second].points_m), given = PlaneOf(truth->points_m);
    const double deg = std::acos(std::min(1.0, std::abs(found.normal.dot(given.normal)))) * 180 / M_PI;
    const double mm = 1e3 * std::abs(found.normal.dot(given.centre_m - found.centre_m));
    ++result.judged;
    result.near += deg <= 2 && mm <= 20 ? 1 : 0;
    result.worst_deg = std::max(result.worst_deg, deg);
    result.worst_mm = std::max(result.worst_mm, mm);
  }
  return result;
}

// The answer from a nominal pose that is wrong by 10 degrees and 20 cm, against the one from none.
Vector6d ShiftByStart(LidarCameraProblem problem, const Se3& T_cam_lidar) {
  problem.T_cam_lidar_nominal = T_cam_lidar * Se3::Exp((Vector6d() << 0.12, -0.12, 0.1, 0.1, 0.1, -0.1).finished());
  const auto again = calib::EstimateLidarCamera(problem, nullptr, nullptr);
  return again ? Vector6d((T_cam_lidar.Inverse() * again->T_cam_lidar).Log()) : Vector6d(Vector6d::Constant(1e9));
}

template <typename Body>
double Milliseconds(const Body& body) {
  const auto start = std::chrono::steady_clock::now();
  body();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void PrintPose(const Se3& T_lidar_cam) {
  const Eigen::Matrix3d R = T_lidar_cam.R();
  std::printf("\"T_lidar_cam_rpy_rad\": [%.6f, %.6f, %.6f], \"T_lidar_cam_mm\": [%.3f, %.3f, %.3f], ",
              std::atan2(R(2, 1), R(2, 2)), std::asin(-R(2, 0)), std::atan2(R(1, 0), R(0, 0)),
              1e3 * T_lidar_cam.p_m.x(), 1e3 * T_lidar_cam.p_m.y(), 1e3 * T_lidar_cam.p_m.z());
}

void PrintSigma(const Edge& edge) {
  const Vector6d sigma = edge.uncertainty.covariance.diagonal().cwiseSqrt();
  std::printf("\"sigma_mm\": [%.3f, %.3f, %.3f], \"sigma_deg\": [%.4f, %.4f, %.4f], ", 1e3 * sigma[0], 1e3 * sigma[1],
              1e3 * sigma[2], 180 / M_PI * sigma[3], 180 / M_PI * sigma[4], 180 / M_PI * sigma[5]);
}

int Measure(const std::filesystem::path& folder, const std::filesystem::path& board_points) {
  const auto manifest = formats::ReadSessionFolder(folder, {});
  if (!manifest) return std::fprintf(stderr, "%s\n", Sentence(manifest.error()).c_str()), 1;
  LidarCameraProblem problem;
  const double detect_ms = Milliseconds([&] { problem = ProblemOf(folder, *manifest); });
  const auto estimate = calib::EstimateLidarCamera(problem, nullptr, nullptr);
  if (!estimate)
    return std::fprintf(stderr, "%s %s\n", estimate.error().what.c_str(), estimate.error().cure.c_str()), 1;
  Edge edge;
  const double edge_ms = Milliseconds([&] { edge = calib::EstimateLidarCameraEdge(problem); });
  int in_pictures = 0, in_clouds = 0;
  for (const auto& capture : problem.captures) {
    in_pictures += capture.view && capture.view->found ? 1 : 0;
    in_clouds += capture.cloud && capture.cloud->found ? 1 : 0;
  }
  const Judged judged = JudgePatches(problem, *estimate, board_points);
  const Vector6d shift = ShiftByStart(problem, estimate->T_cam_lidar);
  std::printf("{\"captures\": %zu, \"in_pictures\": %d, \"in_clouds\": %d, \"used\": %zu, ", problem.captures.size(),
              in_pictures, in_clouds, estimate->patch_idx.size());
  std::printf("\"patches_near\": %d, \"patches_judged\": %d, \"worst_patch_deg\": %.3f, \"worst_patch_mm\": %.2f, ",
              judged.near, judged.judged, judged.worst_deg, judged.worst_mm);
  PrintPose(estimate->T_cam_lidar.Inverse());
  PrintSigma(edge);
  std::printf(
      "\"rms_px\": %.4f, \"rms_mm\": %.3f, \"rms_deg\": %.4f, \"range_bias_mm\": %.2f, \"range_bias_sigma_mm\": %.2f, ",
      estimate->camera.rms_px, 1e3 * estimate->rms_m, 180 / M_PI * estimate->rms_rad, 1e3 * estimate->range_bias_m,
      1e3 * estimate->range_bias_sigma_m);
  std::printf(
      "\"board_scale_percent\": %.3f, \"board_scale_sigma_percent\": %.3f, \"range_sigma_mm\": %.2f, "
      "\"capture_sigma_mm\": %.2f, ",
      100 * estimate->board_scale_ratio, 100 * estimate->board_scale_sigma_ratio, 1e3 * estimate->range_sigma_m,
      1e3 * estimate->capture_sigma_m);
  std::printf("\"halves_max_sigma_ratio\": %.4f, \"start_shift_mm\": %.6f, \"start_shift_deg\": %.6f, ",
              HalvesRatio(problem), 1e3 * shift.head<3>().norm(), 180 / M_PI * shift.tail<3>().norm());
  std::printf("\"detect_ms\": %.1f, \"edge_ms\": %.1f}\n", detect_ms, edge_ms);
  return edge.state == EdgeState::kGood ? 0 : 1;
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3 || !std::filesystem::is_directory(argv[1])) {
    std::fprintf(stderr, "usage: lidar_camera_measure SESSION [BOARD_POINTS]\n");
    return 2;
  }
  return rigcal::Measure(argv[1], argc == 3 ? argv[2] : "");
}
