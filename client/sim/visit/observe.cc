#include "client/sim/visit/observe.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

#include "client/sim/rig/lens.h"
#include "client/sim/rig/random.h"
#include "server/base/process/parallel_for.h"

namespace rigcal::sim {
namespace {

constexpr double kObliqueCosine = 0.26;  // 75 degrees
constexpr double kBorder_px = 8.0;
constexpr std::size_t kPlatePointsMin = 20, kPlateBeamsMin = 4;

int PanelIndexOf(const Scene& scene, const TargetId& board) {
  for (std::size_t i = 0; i < scene.panels.size(); ++i) {
    const int idx = scene.panels[i].board_idx;
    if (idx >= 0 && scene.boards[static_cast<std::size_t>(idx)].id == board) return static_cast<int>(i);
  }
  return -1;
}

bool IsSkipped(const Rig& rig, const SensorId& a, const SensorId& b) {
  return std::any_of(rig.skip_pairs.begin(), rig.skip_pairs.end(), [&](const SensorPair& pair) {
    return (pair.a == a && pair.b == b) || (pair.a == b && pair.b == a);
  });
}

bool IsHidden(const Scene& scene, int panel_idx, const Eigen::Vector3d& from_m, const Eigen::Vector3d& point_m) {
  const Hit hit = NearestHit(scene, from_m, point_m - from_m);
  return hit.panel_idx != panel_idx;
}

// The four outermost corners of what is printed.
std::vector<Eigen::Vector3d> PatternCorners(const Target& target) {
  if (target.kind != TargetKind::kCheckerboard) {
    const Eigen::Vector2d half_m = PatternSize_m(target) / 2;
    const Eigen::Vector3d middle = CentreOf(target), x(half_m.x(), 0, 0), y(0, half_m.y(), 0);
    return {middle - x - y, middle + x - y, middle - x + y, middle + x + y};
  }
  const double s = target.square_m, right = target.cols * s, bottom = target.rows * s;
  return {{-s, -s, 0}, {right, -s, 0}, {-s, bottom, 0}, {right, bottom, 0}};
}

bool SeesWhole(const Scene& scene, const RigSensor& camera, const RigBoard& board, const Se3& T_world_cam) {
  const Se3 T_world_board = board.T_world_board(), T_cam_world = T_world_cam.Inverse();
  const Eigen::Vector3d z = T_world_board.R().col(2), view = board.T_world_plate.p_m - T_world_cam.p_m;
  if (z.dot(view) < kObliqueCosine * view.norm()) return false;
  std::vector<Eigen::Vector3d> corners_cam;
  const int panel_idx = PanelIndexOf(scene, board.target.id);
  for (const Eigen::Vector3d& corner : PatternCorners(board.target)) {
    const Eigen::Vector3d p_world = T_world_board * corner;
    corners_cam.push_back(T_cam_world * p_world);
    if (corners_cam.back().z() < 0.05 || IsHidden(scene, panel_idx, T_world_cam.p_m, p_world)) return false;
  }
  for (const Eigen::Vector2d& uv : PixelsOf(camera.camera.intrinsics, corners_cam))
    if (!(uv.minCoeff() > kBorder_px && uv.x() < camera.camera.width_px - 1 - kBorder_px &&
          uv.y() < camera.camera.height_px - 1 - kBorder_px))
      return false;
  return true;
}

// A point as the entrance pupil sees it that is turned to it.
Eigen::Vector3d FromThePupil(const CameraTruth& camera, Eigen::Vector3d p_cam) {
  const double aside_m2 = p_cam.head<2>().squaredNorm();
  const double law = camera.pupil_by_tangent ? aside_m2 / (p_cam.z() * p_cam.z()) : 2 * aside_m2 / p_cam.squaredNorm();
  p_cam.z() -= law * camera.pupil_shift_m;
  return p_cam;
}

Cone ConeAround(const RigBoard& board, const Se3& T_world_lidar) {
  const Eigen::Vector3d axis = T_world_lidar.Inverse() * board.T_world_plate.p_m;
  const double half_m = board.target.plate_m->norm() / 2, distance_m = axis.norm();
  return {axis / distance_m, distance_m > half_m ? std::cos(std::asin(half_m / distance_m)) : -1.0};
}

PlanePatch PatchOf(const std::vector<ScanPoint>& points, const Eigen::Vector2d& plate_m) {
  PlanePatch patch;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const ScanPoint& point : points) {
    patch.points_m.push_back(point.p_lidar.cast<float>());
    patch.centre_m += point.p_lidar / static_cast<double>(points.size());
  }
  for (const ScanPoint& point : points) {
    const Eigen::Vector3d off = point.p_lidar - patch.centre_m;
    moments += off * off.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(moments);
  patch.normal = axes.eigenvectors().col(0);
  if (patch.normal.dot(patch.centre_m) > 0) patch.normal = -patch.normal;
  patch.rms_m = std::sqrt(std::max(0.0, axes.eigenvalues()[0]) / static_cast<double>(points.size()));
  patch.extent_m = {plate_m.maxCoeff(), plate_m.minCoeff()};
  patch.score = 1.0;
  return patch;
}

}  // namespace

std::vector<TargetId> BoardsOf(const Experiment& experiment, const SensorId& lidar) {
  std::set<TargetId> boards;
  for (const RigSensor& other : experiment.rig.sensors) {
    if (other.kind == SensorKind::kLidar || IsSkipped(experiment.rig, other.id, lidar)) continue;
    const std::optional<TargetId>& sees =
        other.kind == SensorKind::kCamera ? other.sees : experiment.rig.SensorOf(lidar).sees;
    for (const RigBoard& board : experiment.rig.boards)
      if (!sees || *sees == board.target.id) boards.insert(board.target.id);
  }
  return {boards.begin(), boards.end()};
}

std::optional<std::vector<Eigen::Vector2d>> TrueCorners(const Experiment& experiment, const Scene& scene,
                                                        const RigSensor& camera, std::size_t capture_idx) {
  const TargetId id = camera.sees.value_or(experiment.rig.boards.front().target.id);
  const RigBoard board = experiment.BoardAt(id, capture_idx);
  const Se3 T_world_cam = experiment.T_world_sensor(camera.id, capture_idx);
  if (!SeesWhole(scene, camera, board, T_world_cam)) return std::nullopt;
  const Se3 T_cam_board = T_world_cam.Inverse() * board.T_world_board();
  std::vector<Eigen::Vector3d> points_cam;
  for (Eigen::Vector3d point : TargetPoints(board.target)) {
    const Eigen::Vector3d middle = PlateCentreOf(board.target);
    point.x() = middle.x() + board.stretch_ratio * (point.x() - middle.x());
    point.z() += board.bend.At((point - middle).head<2>());
    points_cam.push_back(FromThePupil(camera.camera, T_cam_board * point));
  }
  std::vector<Eigen::Vector2d> corners = PixelsOf(experiment.CameraAt(camera.id, capture_idx).intrinsics, points_cam);
  const Eigen::Vector2d shift_px = experiment.ShiftOf(camera.id, capture_idx);
  for (Eigen::Vector2d& corner : corners) corner += camera.camera.misfit.At(corner) + shift_px;
  return corners;
}

// Pictures of one burst are wrong alike: the same light, the same blur, the same places on the pixels.
constexpr double kBurstShare = 0.8;  // of a corner's variance

class CornerNoise {
 public:
  CornerNoise(const Experiment& experiment, const RigSensor& camera, std::size_t capture_idx)
      : sigma_px_(camera.camera.corner_sigma_px),
        share_(experiment.options.disturb.burst > 1 ? kBurstShare : 0.0),
        own_(KeyOf(experiment.options.seed, "corners", camera.id.str(), capture_idx)),
        shared_(KeyOf(experiment.options.seed, "burst corners", camera.id.str(), experiment.BurstOf(capture_idx))) {}
  [[nodiscard]] Eigen::Vector2d Next() {
    const Eigen::Vector2d own = sigma_px_ * own_.Normals<2>();
    if (share_ == 0) return own;
    return std::sqrt(1 - share_) * own + std::sqrt(share_) * sigma_px_ * shared_.Normals<2>();
  }

 private:
  double sigma_px_, share_;
  Random own_, shared_;
};

BoardView ObserveBoard(const Experiment& experiment, const Scene& scene, const RigSensor& camera,
                       std::size_t capture_idx) {
  BoardView view;
  view.target = camera.sees.value_or(experiment.rig.boards.front().target.id);
  view.image_width_px = camera.camera.width_px;
  view.image_height_px = camera.camera.height_px;
  const auto corners = TrueCorners(experiment, scene, camera, capture_idx);
  view.found = corners.has_value();
  if (!corners) {
    view.why_not = "the board is not seen whole";
    return view;
  }
  CornerNoise noise(experiment, camera, capture_idx);
  for (const Eigen::Vector2d& corner : *corners) {
    view.corner_idx.push_back(static_cast<int>(view.corners_px.size()));
    view.corners_px.emplace_back(corner + noise.Next());
  }
  return view;
}

std::vector<ScanPoint> PlatePoints(const Experiment& experiment, const Scene& scene, const RigSensor& lidar,
                                   const TargetId& board, std::size_t capture_idx) {
  const RigBoard plate = experiment.BoardAt(board, capture_idx);
  const Se3 T_world_lidar = experiment.T_world_sensor(lidar.id, capture_idx);
  const int panel_idx = PanelIndexOf(scene, board);
  std::vector<ScanPoint> points =
      Scan(scene, lidar.lidar, T_world_lidar, experiment.beam_bias_m.at(lidar.id),
           KeyOf(experiment.options.seed, "scan", lidar.id.str(), capture_idx), ConeAround(plate, T_world_lidar));
  const Se3 T_plate_lidar = plate.T_world_plate.Inverse() * T_world_lidar;
  const Eigen::Vector2d half_m = *plate.target.plate_m / 2 - Eigen::Vector2d::Constant(kPlateMargin_m);
  std::erase_if(points, [&](const ScanPoint& point) {
    const Eigen::Vector3d on_plate = T_plate_lidar * (point.p_lidar.normalized() * point.range_m);
    return point.panel_idx != panel_idx || (on_plate.head<2>().cwiseAbs() - half_m).maxCoeff() > 0;
  });
  std::set<int> rings;
  for (const ScanPoint& point : points) rings.insert(point.ring);
  if (points.size() < kPlatePointsMin || rings.size() < kPlateBeamsMin) points.clear();
  return points;
}

CloudView ObservePlate(const Experiment& experiment, const Scene& scene, const RigSensor& lidar, const TargetId& board,
                       std::size_t capture_idx) {
  CloudView view;
  view.target = board;
  const std::vector<ScanPoint> points = PlatePoints(experiment, scene, lidar, board, capture_idx);
  view.points = points.size();
  view.found = !points.empty();
  if (!view.found) {
    view.why_not = "too few beams meet the plate";
    return view;
  }
  view.candidates.push_back(PatchOf(points, *experiment.rig.BoardOf(board).target.plate_m));
  return view;
}

Observations Observe(const Experiment& experiment) {
  std::vector<Observations> parts(experiment.captures.size());
  ParallelFor(parts.size(), [&](std::size_t k) {
    const Scene scene = SceneAt(experiment, k);
    const CaptureId& capture = experiment.captures[k];
    for (const RigSensor& sensor : experiment.rig.sensors) {
      if (sensor.kind == SensorKind::kTracker || !experiment.IsRecorded(sensor.id, k)) continue;
      if (sensor.kind == SensorKind::kCamera)
        parts[k].views[sensor.id][capture] = ObserveBoard(experiment, scene, sensor, k);
      if (sensor.kind == SensorKind::kLidar)
        for (const TargetId& board : BoardsOf(experiment, sensor.id))
          parts[k].clouds[sensor.id][capture][board] = ObservePlate(experiment, scene, sensor, board, k);
    }
  });
  Observations all;
  for (Observations& part : parts) {
    for (auto& [id, views] : part.views) all.views[id].merge(views);
    for (auto& [id, clouds] : part.clouds) all.clouds[id].merge(clouds);
  }
  for (const RigSensor& sensor : experiment.rig.sensors)
    if (sensor.kind == SensorKind::kTracker) all.tracker[sensor.id] = TrackerRows(experiment, sensor);
  return all;
}

}  // namespace rigcal::sim
