#include "client/sim/bound.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "client/sim/rig/lens.h"
#include "client/sim/visit/observe.h"
#include "client/sim/visit/sway.h"
#include "server/base/process/parallel_for.h"

namespace rigcal::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Step = Eigen::Matrix<double, 3, 6>;  // of a point by a pose's tangent

// d(T Exp(xi) p) in the frame of T's right side.
Step Moved(const Vector3d& p) {
  Step step;
  step << Matrix3d::Identity(), -Hat(p);
  return step;
}

// As if nothing had happened during the visit.
Experiment Undisturbed(Experiment experiment) {
  experiment.T_body_bumped.clear();
  experiment.T_rest_sensor.clear();
  experiment.T_told_world.clear();
  experiment.moved_board.reset();
  experiment.wrong_instant.reset();
  experiment.shifted.reset();
  return experiment;
}

// Where each unknown of the rig stands; -1: it is none. Poses of captures are eliminated on the way.
struct Layout {
  std::map<SensorId, int> pose, lens;
  std::map<TargetId, int> board;
  int size = 0;
  // The other pose of the sensor that is bumped; -1: it keeps its one.
  int pose_after = -1;

  Layout(const Experiment& experiment, bool with_bump) {
    bool has_tracker = false;
    for (const RigSensor& sensor : experiment.rig.sensors) {
      pose[sensor.id] = sensor.id == experiment.rig.reference ? -1 : Take(6);
      has_tracker |= sensor.kind == SensorKind::kTracker;
      const bool is_unknown = experiment.options.intrinsics != IntrinsicsKind::kExact;
      if (sensor.kind == SensorKind::kCamera)
        lens[sensor.id] = is_unknown ? Take(static_cast<int>(4 + sensor.camera.intrinsics.distortion.size())) : -1;
    }
    // Without a tracker the first board is the world.
    for (const RigBoard& other : experiment.rig.boards)
      board[other.target.id] = !has_tracker && board.empty() ? -1 : Take(6);
    if (with_bump) pose_after = Take(6);
  }
  int Take(int count) {
    size += count;
    return size - count;
  }
};

// Rows over a few unknowns and over the pose of the capture's reference, divided by their noise.
struct Rows {
  MatrixXd J;
  std::vector<std::pair<int, int>> columns;  // (place in the layout or -1, count), in the order of J's columns
  // The last six columns are the capture's pose.
};

struct CaptureInformation {
  MatrixXd H_rig;       // of the layout
  MatrixXd H_rig_pose;  // 6 columns
  Matrix6d H_pose = Matrix6d::Zero();

  explicit CaptureInformation(int size) : H_rig(MatrixXd::Zero(size, size)), H_rig_pose(MatrixXd::Zero(size, 6)) {}

  void Add(const Rows& rows) {
    const MatrixXd H = rows.J.transpose() * rows.J;
    const Eigen::Index last = rows.J.cols() - 6;
    H_pose += H.bottomRightCorner<6, 6>();
    Eigen::Index at_a = 0;
    for (const auto& [a, count_a] : rows.columns) {
      Eigen::Index at_b = 0;
      if (a >= 0) H_rig_pose.block(a, 0, count_a, 6) += H.block(at_a, last, count_a, 6);
      for (const auto& [b, count_b] : rows.columns) {
        if (a >= 0 && b >= 0) H_rig.block(a, b, count_a, count_b) += H.block(at_a, at_b, count_a, count_b);
        at_b += count_b;
      }
      at_a += count_a;
    }
  }

  // What it says of the rig when the pose is not known otherwise.
  [[nodiscard]] MatrixXd Eliminated() const {
    const Vector6d scale = H_pose.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<Matrix6d> axes(scale.asDiagonal() * H_pose * scale.asDiagonal());
    Vector6d inverse = Vector6d::Zero();
    for (int i = 0; i < 6; ++i)
      if (axes.eigenvalues()[i] > 1e-12) inverse[i] = 1 / axes.eigenvalues()[i];
    const MatrixXd half = H_rig_pose * scale.asDiagonal() * axes.eigenvectors();
    return H_rig - half * inverse.asDiagonal() * half.transpose();
  }
};

class Builder {
 public:
  // With the bump as an unknown, the sensor has a pose of its own from then on.
  Builder(const Experiment& experiment, bool with_bump)
      : experiment_(Undisturbed(experiment)), scene_(SceneOf(experiment.rig)), layout_(experiment, with_bump) {}

  [[nodiscard]] const Layout& layout() const { return layout_; }

  [[nodiscard]] MatrixXd Information() const {
    std::vector<MatrixXd> parts(experiment_.captures.size());
    ParallelFor(parts.size(), [&](std::size_t k) { parts[k] = OfCapture(k); });
    MatrixXd H = MatrixXd::Zero(layout_.size, layout_.size);
    for (const MatrixXd& part : parts) H += part;  // in order: the sum does not depend on threads
    if (experiment_.options.intrinsics == IntrinsicsKind::kCalibrated) AddCalibration(H);
    return H;
  }

 private:
  [[nodiscard]] MatrixXd OfCapture(std::size_t k) const {
    CaptureInformation information(layout_.size);
    for (const RigSensor& sensor : experiment_.rig.sensors) {
      if (!experiment_.IsRecorded(sensor.id, k)) continue;
      if (sensor.kind == SensorKind::kCamera) AddView(sensor, k, information);
      if (sensor.kind == SensorKind::kLidar) AddCloud(sensor, k, information);
      if (sensor.kind == SensorKind::kTracker) AddTracker(sensor, k, information);
    }
    return information.Eliminated();
  }

  [[nodiscard]] int PoseAt(const SensorId& id, std::size_t k) const {
    const bool is_after =
        layout_.pose_after >= 0 && id == *experiment_.options.bump && k >= experiment_.bumped_from_idx;
    return is_after ? layout_.pose_after : layout_.pose.at(id);
  }

  [[nodiscard]] Se3 T_world_ref(std::size_t k) const {
    return experiment_.T_world_body[k] * experiment_.rig.SensorOf(experiment_.rig.reference).T_body_sensor;
  }

  void AddView(const RigSensor& camera, std::size_t k, CaptureInformation& information) const {
    if (!TrueCorners(experiment_, scene_, camera, k)) return;
    const TargetId board_id = camera.sees.value_or(experiment_.rig.boards.front().target.id);
    const RigBoard& board = experiment_.rig.BoardOf(board_id);
    const Se3 T_ref_board = T_world_ref(k).Inverse() * board.T_world_board();
    const Se3 T_cam_ref = experiment_.T_ref_sensor(camera.id).Inverse();
    const std::vector<Vector3d> points = TargetPoints(board.target);
    std::vector<Vector3d> points_cam;
    for (const Vector3d& p : points) points_cam.push_back(T_cam_ref * (T_ref_board * p));
    const std::vector<LensPoint> pixels = PixelsWithDerivatives(camera.camera.intrinsics, points_cam);
    const int lens_count = static_cast<int>(4 + camera.camera.intrinsics.distortion.size());
    Rows rows{MatrixXd(2 * static_cast<Eigen::Index>(points.size()), 18 + lens_count),
              {{PoseAt(camera.id, k), 6}, {layout_.board.at(board_id), 6}, {layout_.lens.at(camera.id), lens_count}}};
    const Matrix3d R_cam_ref = T_cam_ref.R(), R_cam_board = R_cam_ref * T_ref_board.R();
    for (std::size_t i = 0; i < points.size(); ++i)
      rows.J.middleRows<2>(2 * static_cast<Eigen::Index>(i)) << -pixels[i].d_point * Moved(points_cam[i]),
          pixels[i].d_point * R_cam_board * Moved(points[i]), pixels[i].d_intrinsics,
          -pixels[i].d_point * R_cam_ref * Moved(T_ref_board * points[i]);
    rows.J /= camera.camera.corner_sigma_px;
    information.Add(rows);
  }

  void AddCloud(const RigSensor& lidar, std::size_t k, CaptureInformation& information) const {
    const Se3 T_ref_lidar = experiment_.T_ref_sensor(lidar.id);
    for (const TargetId& id : BoardsOf(experiment_, lidar.id)) {
      const std::vector<ScanPoint> points = PlatePoints(experiment_, scene_, lidar, id, k);
      const Se3 T_board_ref = experiment_.rig.BoardOf(id).T_world_board().Inverse() * T_world_ref(k);
      const Eigen::RowVector3d n_ref = T_board_ref.R().row(2), n_lidar = n_ref * T_ref_lidar.R();
      Rows rows{MatrixXd(static_cast<Eigen::Index>(points.size()), 18),
                {{PoseAt(lidar.id, k), 6}, {layout_.board.at(id), 6}}};
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vector3d direction = points[i].p_lidar.normalized(), p_lidar = points[i].range_m * direction;
        const Vector3d p_ref = T_ref_lidar * p_lidar, p_board = T_board_ref * p_ref;
        const double sigma_m = lidar.lidar.range_sigma_m * std::abs(n_lidar.dot(direction));
        rows.J.row(static_cast<Eigen::Index>(i)) << n_lidar * Moved(p_lidar) / sigma_m,
            -Eigen::RowVector3d::UnitZ() * Moved(p_board) / sigma_m, n_ref * Moved(p_ref) / sigma_m;
      }
      if (!points.empty()) information.Add(rows);
    }
  }

  void AddTracker(const RigSensor& tracker, std::size_t k, CaptureInformation& information) const {
    Vector6d weight;
    weight << Vector3d::Constant(1 / tracker.tracker.sigma_m), Vector3d::Constant(1 / tracker.tracker.sigma_rad);
    Matrix6d root = weight.asDiagonal();
    // Noise n of the flange, F Exp(n), is -Ad(F) n of the base in the flange's frame, F^-1.
    if (CarriesTarget(experiment_.declared, tracker.id))
      root = root * Adjoint(ToldByTracker(experiment_, tracker, k, 0.0).Inverse());
    Rows rows{MatrixXd(6, 12), {{PoseAt(tracker.id, k), 6}}};
    rows.J << root, root * Adjoint(experiment_.T_ref_sensor(tracker.id).Inverse());
    information.Add(rows);
  }

  // A value that is given without a sigma is exact: its information is as good as endless.
  void AddCalibration(MatrixXd& H) const {
    constexpr double kExactSigma = 1e-9;
    for (const RigSensor& sensor : experiment_.rig.sensors) {
      if (sensor.kind != SensorKind::kCamera) continue;
      const std::vector<double>& sigma = sensor.camera.intrinsics_sigma;
      for (std::size_t i = 0; i < sigma.size(); ++i) {
        const Eigen::Index at = layout_.lens.at(sensor.id) + static_cast<Eigen::Index>(i);
        H(at, at) += std::pow(std::max(sigma[i], kExactSigma), -2);
      }
    }
  }

  const Experiment experiment_;
  const Scene scene_;
  const Layout layout_;
};

// Inverse of an information matrix along what it tells, and how much of each unknown it leaves open.
struct Inverse {
  MatrixXd covariance;
  VectorXd open_ratio;
  static constexpr double kOpenShare = 1e-6;
};

Inverse InverseOf(const MatrixXd& H) {
  constexpr double kOpen = 1e-12;
  const VectorXd scale = H.diagonal().unaryExpr([](double h) { return h > 0 ? 1 / std::sqrt(h) : 1.0; });
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(scale.asDiagonal() * H * scale.asDiagonal());
  const VectorXd values = axes.eigenvalues().unaryExpr([](double value) { return value > kOpen ? 1 / value : 0.0; });
  const VectorXd open = axes.eigenvalues().unaryExpr([](double value) { return value > kOpen ? 0.0 : 1.0; });
  const MatrixXd half = scale.asDiagonal() * axes.eigenvectors();
  return {half * values.asDiagonal() * half.transpose(), axes.eigenvectors().cwiseAbs2() * open};
}

bool HasNoise(const Rig& rig) {
  for (const RigSensor& sensor : rig.sensors) {
    if (sensor.kind == SensorKind::kCamera && !(sensor.camera.corner_sigma_px > 0)) return false;
    if (sensor.kind == SensorKind::kLidar && !(sensor.lidar.range_sigma_m > 0)) return false;
    if (sensor.kind == SensorKind::kTracker && !(sensor.tracker.sigma_m > 0 && sensor.tracker.sigma_rad > 0))
      return false;
  }
  return true;
}

}  // namespace

std::map<SensorId, BoundSigma> CramerRaoBound(const Experiment& experiment) {
  std::map<SensorId, BoundSigma> bound;
  if (!HasNoise(experiment.rig)) return bound;
  const Builder builder(experiment, false);
  const Inverse inverse = InverseOf(builder.Information());
  for (const auto& [id, at] : builder.layout().pose) {
    BoundSigma& sigma = bound[id];
    for (int i = 0; i < 6; ++i)
      if (at < 0)
        sigma[static_cast<std::size_t>(i)] = 0.0;
      else if (inverse.open_ratio[at + i] <= Inverse::kOpenShare)
        sigma[static_cast<std::size_t>(i)] = std::sqrt(inverse.covariance(at + i, at + i));
  }
  return bound;
}

std::optional<Matrix6d> CramerRaoCovariance(const Experiment& experiment, const SensorId& sensor) {
  if (!HasNoise(experiment.rig)) return std::nullopt;
  const Builder builder(experiment, false);
  const int at = builder.layout().pose.at(sensor);
  if (at < 0) return Matrix6d(Matrix6d::Zero());
  const Inverse inverse = InverseOf(builder.Information());
  if (inverse.open_ratio.segment<6>(at).maxCoeff() > Inverse::kOpenShare) return std::nullopt;
  return Matrix6d(inverse.covariance.block<6, 6>(at, at));
}

std::optional<Matrix6d> CramerRaoCovarianceOfBump(const Experiment& experiment) {
  if (!experiment.options.bump || !HasNoise(experiment.rig)) return std::nullopt;
  const Builder builder(experiment, true);
  const int before = builder.layout().pose.at(*experiment.options.bump), after = builder.layout().pose_after;
  const Inverse inverse = InverseOf(builder.Information());
  MatrixXd step = MatrixXd::Zero(6, builder.layout().size);
  step.middleCols<6>(after).setIdentity();
  if (before >= 0) step.middleCols<6>(before) -= Matrix6d::Identity();
  if (inverse.open_ratio.segment<6>(after).maxCoeff() > Inverse::kOpenShare) return std::nullopt;
  if (before >= 0 && inverse.open_ratio.segment<6>(before).maxCoeff() > Inverse::kOpenShare) return std::nullopt;
  return Matrix6d(step * inverse.covariance * step.transpose());
}

}  // namespace rigcal::sim
