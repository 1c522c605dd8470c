// Findings that are made up, for tests of what is said of them.
#pragma once

#include <string>
#include <vector>

#include "client/check/advice.h"

namespace rigcal::check {

inline std::vector<CaptureId> Captures(std::size_t count) {
  std::vector<CaptureId> captures;
  for (std::size_t i = 0; i < count; ++i) captures.emplace_back(std::to_string(101 + i).substr(1));
  return captures;
}

inline Edge GoodEdge(double sigma_m, double sigma_rad) {
  Edge edge;
  edge.state = EdgeState::kGood;
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal().head<3>().setConstant(sigma_m * sigma_m);
  covariance.diagonal().tail<3>().setConstant(sigma_rad * sigma_rad);
  edge.uncertainty = FromCovariance(covariance, UncertaintySource::kJackknife, 10).value();
  return edge;
}

inline void AddCamera(const std::string& name, std::size_t found, std::size_t files, Findings& findings) {
  CameraFound camera;
  camera.camera = SensorId(name);
  camera.with_board = Captures(found);
  camera.width_px = 640, camera.height_px = 480;
  camera.coverage.share_ratio = 0.8;
  camera.ring.views = {3, 3, 3, 3};
  camera.distances = BoardDistances{1.5, 4.0};
  camera.edge_px = 2.4;
  findings.cameras[camera.camera] = camera;
  SensorFiles of_camera;
  of_camera.sensor = camera.camera;
  of_camera.files = files;
  of_camera.present = Captures(files);
  of_camera.usable = found;
  findings.sensors.push_back(of_camera);
}

inline void AddPair(const std::string& a, const std::string& b, Method method, std::size_t both,
                    std::optional<Edge> edge, Findings& findings) {
  findings.pairs.push_back(
      {{SensorId(a), SensorId(b)}, method, RowOf(method).captures, both, std::move(edge), std::nullopt, true});
}

inline Findings TwoCameras(std::size_t both = 12, double sigma_m = 0.0002) {
  Findings findings;
  findings.robot = RobotId("r1");
  findings.captures = Captures(12);
  AddCamera("left", 12, 12, findings);
  AddCamera("right", 12, 12, findings);
  AddPair("left", "right", Method::kStereo, both, GoodEdge(sigma_m, 1e-4), findings);
  return findings;
}

inline std::vector<std::string> TextsOf(const Judgement& judgement) {
  std::vector<std::string> texts;
  for (const Advice& advice : judgement.advice) texts.push_back(advice.text);
  return texts;
}

}  // namespace rigcal::check
