#include "tests/unit/fleet/causes/visit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/calib/lidar_camera/lidar_camera.h"
#include "server/calib/stereo/stereo.h"
#include "tests/unit/calib/virtual_lidar.h"
#include "tests/unit/calib/virtual_pair.h"
#include "tests/unit/fleet/rig.h"

namespace rigcal::fleet {
namespace {

constexpr double kCornerSigma_px = 0.2;

std::optional<BoardView> Pictured(char letter, std::optional<BoardView> seen) {
  if (letter == ' ') return std::nullopt;
  if (letter == 'B') return seen;
  const bool readable = letter == '.';
  return BoardView{false,
                   readable ? "no board in the picture" : "it cannot be decoded",
                   seen->target,
                   readable ? seen->image_width_px : 0,
                   readable ? seen->image_height_px : 0,
                   {}};
}

std::optional<CloudView> Scanned(char letter, std::optional<CloudView> seen) {
  if (letter == ' ') return std::nullopt;
  if (letter == 'B') return seen;
  CloudView none;
  none.why_not = letter == '.' ? "no plate of this size" : "it cannot be read";
  none.points = letter == '.' ? 30000 : 0;
  return none;
}

calib::VirtualPair Cameras() {
  calib::VirtualPair pair;
  pair.board = StereoBoard();
  return pair;
}

calib::StereoProblem Pair(const std::string& a, const std::string& b, const std::vector<Se3>& boards) {
  calib::StereoProblem problem = calib::Photographed(Cameras(), boards, kCornerSigma_px, 2);
  problem.camera_a.id = SensorId(a), problem.camera_b.id = SensorId(b);
  return problem;
}

calib::LidarCameraProblem LidarPair(const std::string& camera, const std::string& lidar, const std::vector<Se3>& boards,
                                    unsigned seed) {
  calib::VirtualLidarRig rig;
  rig.board = LidarBoard();
  rig.corner_sigma_px = kCornerSigma_px, rig.range_sigma_m = 0.02;
  calib::LidarCameraProblem problem = calib::Recorded(rig, boards, seed);
  problem.camera.id = SensorId(camera), problem.lidar.id = SensorId(lidar);
  return problem;
}

}  // namespace

Visit::Visit(const Target& board) {
  header.targets = {board};
  header.captured_at = ParseIso("2026-01-31T00:00:00Z").value();
}

void Visit::AddSensor(const std::string& name, SensorKind kind) {
  if (rigcal::SensorOf(header, SensorId(name)) != nullptr) return;
  Sensor sensor;
  sensor.id = SensorId(name);
  sensor.kind = kind;
  header.sensors.push_back(sensor);
  if (header.reference.empty()) header.reference = sensor.id;
}

void Visit::Add(Edge edge) {
  edge.id = EdgeId(std::string(60, 'e') + std::to_string(1000 + edges.size()));
  edge.session = session;
  edges.push_back(std::move(edge));
}

void Visit::AddStereo(const std::string& a, const Letters& of_a, const std::string& b, const Letters& of_b) {
  for (const std::string& camera : {a, b}) AddSensor(camera, SensorKind::kCamera);
  calib::StereoProblem problem = Pair(a, b, calib::TiltedBoards(static_cast<int>(of_a.size())));
  for (std::size_t k = 0; k < of_a.size(); ++k) {
    problem.captures[k].a = Pictured(of_a[k], problem.captures[k].a);
    problem.captures[k].b = Pictured(of_b[k], problem.captures[k].b);
  }
  std::erase_if(problem.captures, [](const calib::StereoCapture& capture) { return !capture.a && !capture.b; });
  Add(calib::EstimateEdge(problem));
}

void Visit::AddStereos(const std::map<std::string, Letters>& cameras) {
  for (auto a = cameras.begin(); a != cameras.end(); ++a)
    for (auto b = std::next(a); b != cameras.end(); ++b) AddStereo(a->first, a->second, b->first, b->second);
}

void Visit::AddLidarCamera(const std::string& camera, const Letters& pictures, const std::string& lidar,
                           const Letters& clouds) {
  AddSensor(camera, SensorKind::kCamera);
  AddSensor(lidar, SensorKind::kLidar);
  calib::LidarCameraProblem problem =
      LidarPair(camera, lidar, calib::BoardsBefore(static_cast<int>(pictures.size())), 8);
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    problem.captures[k].view = Pictured(pictures[k], problem.captures[k].view);
    problem.captures[k].cloud = Scanned(clouds[k], problem.captures[k].cloud);
  }
  std::erase_if(problem.captures, [](const auto& capture) { return !capture.view && !capture.cloud; });
  Add(calib::EstimateLidarCameraEdge(problem));
}

void Visit::AddFailed(const std::string& a, const std::string& b, const std::string& method, const std::string& code,
                      const std::map<std::string, double>& figures) {
  Edge edge;
  edge.frame_a = SensorId(a), edge.frame_b = SensorId(b);
  edge.method = method;
  edge.diagnoses = {{code, a + " and " + b + " failed.", "Do what " + code + " wants."}};
  edge.figures = figures;
  Add(std::move(edge));
}

void Visit::AddGood(const std::string& a, const std::string& b) { Add(MakeEdge('a', a, b)); }

std::vector<RootCause> Visit::Causes(const GraphSolution& solution) const {
  return FindRootCauses(edges, solution, Headers(), Times());
}

Verdict Visit::Judge(const GraphSolution& solution) const {
  return Assess(edges, solution, {}, Times(), {}, Headers());
}

const RootCause* CauseOfKind(const std::vector<RootCause>& causes, CauseKind kind) {
  const auto found =
      std::find_if(causes.begin(), causes.end(), [&](const RootCause& cause) { return cause.kind == kind; });
  return found == causes.end() ? nullptr : &*found;
}

RootCause OneCause(const Visit& visit, CauseKind kind) {
  const std::vector<RootCause> causes = visit.Causes();
  EXPECT_EQ(causes.size(), 1U);
  const RootCause* cause = CauseOfKind(causes, kind);
  EXPECT_NE(cause, nullptr) << (causes.empty() ? "no cause" : causes.front().said.why);
  return cause ? *cause : RootCause();
}

Target StereoBoard() {
  Target board = calib::VirtualPair().board;
  board.id = TargetId("calib");
  return board;
}

Target LidarBoard() {
  Target board = calib::VirtualLidarRig().board;
  board.id = TargetId("wall");
  return board;
}

Edge FlatStereo(const std::string& a, const std::string& b) {
  std::vector<Se3> boards;
  for (int k = 0; k < 10; ++k)
    boards.push_back(calib::BoardAt(Cameras(),
                                    {0.05 + 0.05 * std::sin(2.0 * k), 0.04 * std::cos(3.0 * k), 0.45 + 0.02 * k},
                                    Eigen::Vector3d::Zero()));
  return calib::EstimateEdge(Pair(a, b, boards));
}

Edge FlatLidarCamera(const std::string& camera, const std::string& lidar) {
  std::vector<Se3> boards = calib::BoardsBefore(12);
  for (Se3& board : boards) board.q.setIdentity();
  return calib::EstimateLidarCameraEdge(LidarPair(camera, lidar, boards, 9));
}

Edge MissizedLidarCamera(const std::string& camera, const std::string& lidar, double square_m) {
  calib::LidarCameraProblem problem = LidarPair(camera, lidar, calib::BoardsBefore(20), 14);
  problem.board.square_m = square_m;
  return calib::EstimateLidarCameraEdge(problem);
}

GraphSolution SolutionOf(const std::vector<std::string>& known, const std::vector<std::string>& unknown) {
  GraphSolution solution;
  solution.converged = true;
  solution.dof = 6;
  for (const std::string& name : known)
    solution.poses.push_back(PoseOf(name, true, solution.poses.empty() ? 0.0 : 1e-6));
  for (const std::string& name : unknown) solution.poses.push_back(PoseOf(name, false));
  return solution;
}

}  // namespace rigcal::fleet
