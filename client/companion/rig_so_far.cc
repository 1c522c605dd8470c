#include "client/companion/rig_so_far.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "server/calib/planes/planar_pose.h"

namespace rigcal::companion {
namespace {

using calib::IntrinsicsVector;
using calib::placement::PlannedCamera;
using calib::placement::PlannedCapture;
using calib::placement::PlannedRig;

constexpr double kNear_m = 0.02, kNear_ratio = 0.01, kNear_rad = 0.0175;
constexpr double kCornerSigmaFirst_px = 0.15, kCornerSigmaMin_px = 0.03;  // before residuals tell; nobody is better
constexpr double kRoughFocal_ratio = 0.8;                                 // of the longer side: a view of 64 degrees

// Of a lens that is estimated: what it may be, before any picture.
IntrinsicsVector OpenLensSigma(const PlannedCamera& camera) {
  IntrinsicsVector sigma = IntrinsicsVector::Zero();
  sigma.head<2>().setConstant(0.3 * camera.intrinsics[0]);
  sigma.segment<2>(2).setConstant(0.1 * std::max(camera.width_px, camera.height_px));
  for (int i = 4; i < calib::IntrinsicsCount(camera.model); ++i) sigma[i] = 0.3;
  if (camera.model != CameraModel::kFisheyeKb4) sigma.segment<2>(6).setConstant(0.01);  // tangential
  return sigma;
}

void SetLens(const Sensor& sensor, const CameraSoFar& so_far, PlannedCamera& camera) {
  camera.model = sensor.camera_model;
  camera.width_px = so_far.found.width_px, camera.height_px = so_far.found.height_px;
  if (so_far.intrinsics) {
    camera.model = so_far.intrinsics->model;
    camera.intrinsics = calib::VectorOf(*so_far.intrinsics);
    if (camera.width_px == 0) {  // no picture yet: the principal point is near the middle
      camera.width_px = static_cast<int>(std::lround(2 * so_far.intrinsics->cx_px)) + 1;
      camera.height_px = static_cast<int>(std::lround(2 * so_far.intrinsics->cy_px)) + 1;
    }
  } else {
    const double focal_px = kRoughFocal_ratio * std::max(camera.width_px, camera.height_px);
    camera.intrinsics.head<4>() << focal_px, focal_px, 0.5 * (camera.width_px - 1), 0.5 * (camera.height_px - 1);
  }
  if (!sensor.intrinsics) camera.lens_sigma = OpenLensSigma(camera);
  if (!sensor.intrinsics_sigma) return;
  for (std::size_t i = 0; i < sensor.intrinsics_sigma->size() && i < calib::kIntrinsicsMax; ++i)
    camera.lens_sigma[static_cast<Eigen::Index>(i)] = (*sensor.intrinsics_sigma)[i];
}

// Absent: nothing is known of its pictures.
std::optional<PlannedCamera> CameraOf(const SessionHeader& header, const Sensor& sensor, const CameraSoFar& so_far) {
  PlannedCamera camera;
  camera.id = sensor.id;
  SetLens(sensor, so_far, camera);
  if (camera.width_px <= 0 || camera.height_px <= 0) return std::nullopt;
  camera.corner_sigma_px = so_far.corner_sigma_px > 0 ? std::max(so_far.corner_sigma_px, kCornerSigmaMin_px)
                                                      : kCornerSigmaFirst_px;
  for (std::size_t board = 0; board < header.targets.size(); ++board)
    if (!sensor.sees || *sensor.sees == header.targets[board].id) camera.boards.push_back(board);
  return camera;
}

// Of one camera, by capture, with the corners it saw.
struct View {
  Se3 T_camera_board;
  std::vector<int> corner_idx;
};
using Views = std::map<CaptureId, View>;

// A lens that is not told yet still sees where boards roughly are.
void AppendRoughViews(const Captured& captured, const PlannedCamera& camera, const Target& board, Views& views) {
  const auto pictures = captured.pictures.find(camera.id);
  if (pictures == captured.pictures.end()) return;
  for (const auto& [capture, view] : check::ViewsOf(pictures->second, board.id)) {
    if (views.contains(capture) || !calib::WhyUnusable(view, board).empty()) continue;
    const auto poses = calib::PlanarPoses(camera.model, camera.intrinsics, TargetPoints(board), calib::SeenIn(view, board));
    if (!poses.empty()) views[capture] = {poses.front(), view.corner_idx};
  }
}

Views ViewsOfCamera(const Captured& captured, const PlannedCamera& camera) {
  const CameraSoFar& so_far = captured.cameras.at(camera.id);
  Views views;
  if (!so_far.found.board) return views;
  for (const auto& [capture, T_camera_board] : so_far.found.T_cam_board)
    if (const auto idx = so_far.corner_idx.find(capture); idx != so_far.corner_idx.end())
      views[capture] = {T_camera_board, idx->second};
  if (!so_far.intrinsics) AppendRoughViews(captured, camera, *so_far.found.board, views);
  return views;
}

// A board that looks the same turned has as many poses.
std::vector<Se3> TurnsOf(const Target& board) {
  const int count = SymmetryOf(board);
  const Se3 T_board_middle{CentreOf(board), Eigen::Quaterniond::Identity()};
  std::vector<Se3> turns;
  for (int turn = 0; turn < count; ++turn) {
    const Eigen::AngleAxisd about(turn * 2 * M_PI / count, Eigen::Vector3d::UnitZ());
    turns.push_back(T_board_middle * Se3{Eigen::Vector3d::Zero(), Eigen::Quaterniond(about)} * T_board_middle.Inverse());
  }
  return turns;
}

class Placing {
 public:
  Placing(const Captured& captured, std::vector<PlannedCamera> cameras)
      : captured_(captured), cameras_(std::move(cameras)) {
    for (const PlannedCamera& camera : cameras_) {
      views_.push_back(ViewsOfCamera(captured, camera));
      const auto& found = captured.cameras.at(camera.id).found.board;
      boards_.push_back(found ? IndexOf(found->id) : captured.header.targets.size());
    }
  }

  RigSoFar Run() {
    RigSoFar so_far;
    so_far.rig.boards = captured_.header.targets;
    placed_.assign(cameras_.size(), std::nullopt);
    if (cameras_.empty()) return so_far;
    const std::size_t reference = Reference();
    placed_[reference] = Se3{};
    while (PlaceOne()) {
    }
    PlaceAsDrawn(reference);
    Gather(reference, so_far);
    return so_far;
  }

 private:
  [[nodiscard]] std::size_t IndexOf(const TargetId& id) const {
    const auto& targets = captured_.header.targets;
    return static_cast<std::size_t>(
        std::find_if(targets.begin(), targets.end(), [&](const Target& one) { return one.id == id; }) - targets.begin());
  }
  [[nodiscard]] std::size_t Reference() const {
    for (std::size_t c = 0; c < cameras_.size(); ++c)
      if (cameras_[c].id == captured_.header.reference) return c;
    return 0;
  }

  // Of every capture that both have, and every turn of its board.
  [[nodiscard]] std::vector<Se3> RelativePoses(std::size_t a, std::size_t b) const {
    std::vector<Se3> poses;
    if (boards_[a] != boards_[b] || boards_[a] >= captured_.header.targets.size()) return poses;
    const std::vector<Se3> turns = TurnsOf(captured_.header.targets[boards_[a]]);
    for (const auto& [capture, view] : views_[a])
      if (const auto other = views_[b].find(capture); other != views_[b].end())
        for (const Se3& turn : turns)
          poses.push_back((view.T_camera_board * turn * other->second.T_camera_board.Inverse()).Normalized());
    return poses;
  }

  // The camera that shares most captures with one that has a place.
  bool PlaceOne() {
    std::vector<Se3> most;
    std::size_t from = 0, next = 0;
    for (std::size_t a = 0; a < cameras_.size(); ++a)
      for (std::size_t b = 0; placed_[a] && b < cameras_.size(); ++b) {
        if (placed_[b]) continue;
        std::vector<Se3> poses = RelativePoses(a, b);
        if (poses.size() > most.size()) most = std::move(poses), from = a, next = b;
      }
    if (most.empty()) return false;
    placed_[next] = (*placed_[from] * MostAgreedOn(most)).Normalized();
    return true;
  }

  void PlaceAsDrawn(std::size_t reference) {
    const Sensor& origin = *SensorOf(captured_.header, cameras_[reference].id);
    for (std::size_t c = 0; c < cameras_.size(); ++c)
      if (!placed_[c]) placed_[c] = NominalPose(captured_.header, origin, *SensorOf(captured_.header, cameras_[c].id));
  }

  void Gather(std::size_t reference, RigSoFar& so_far) const {
    std::map<std::pair<CaptureId, std::size_t>, PlannedCapture> captures;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      if (!placed_[c]) {
        so_far.unplaced.push_back(cameras_[c].id);
        continue;
      }
      if (c == reference) so_far.rig.reference = so_far.rig.cameras.size();
      for (const auto& [capture, view] : views_[c]) {
        PlannedCapture& planned = captures[{capture, boards_[c]}];
        planned.board = boards_[c];
        planned.looks.push_back({so_far.rig.cameras.size(), view.T_camera_board, view.corner_idx});
      }
      so_far.rig.cameras.push_back(cameras_[c]);
      so_far.rig.cameras.back().T_ref_camera = *placed_[c];
    }
    for (auto& [key, capture] : captures) so_far.captures.push_back(std::move(capture));
  }

  const Captured& captured_;
  std::vector<PlannedCamera> cameras_;
  std::vector<Views> views_;
  std::vector<std::size_t> boards_;  // of the views of each
  std::vector<std::optional<Se3>> placed_;
};

}  // namespace

Se3 MostAgreedOn(const std::vector<Se3>& poses) {
  std::size_t best = 0;
  std::ptrdiff_t most = -1;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double near_m = std::max(kNear_m, kNear_ratio * poses[i].p_m.norm());
    const std::ptrdiff_t near = std::count_if(poses.begin(), poses.end(), [&](const Se3& other) {
      return AreNear(poses[i], other, near_m, kNear_rad);
    });
    if (near > most) most = near, best = i;
  }
  return poses[best];
}

RigSoFar RigOf(const Captured& captured) {
  std::vector<PlannedCamera> cameras;
  std::vector<SensorId> unknown;
  for (const Sensor& sensor : captured.header.sensors) {
    if (sensor.kind != SensorKind::kCamera) continue;
    if (auto camera = CameraOf(captured.header, sensor, captured.cameras.at(sensor.id)))
      cameras.push_back(*std::move(camera));
    else
      unknown.push_back(sensor.id);
  }
  RigSoFar so_far = Placing(captured, std::move(cameras)).Run();
  so_far.unplaced.insert(so_far.unplaced.end(), unknown.begin(), unknown.end());
  return so_far;
}

}  // namespace rigcal::companion
