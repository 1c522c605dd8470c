#include "tests/unit/calib/virtual_motion.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "server/calib/camera/projection.h"

namespace rigcal::calib {
namespace {

using Random = std::mt19937;

Eigen::Vector3d Normal3(Random& random, double sigma) {
  std::normal_distribution<double> normal(0, 1);
  const double x = normal(random), y = normal(random), z = normal(random);
  return sigma * Eigen::Vector3d(x, y, z);
}

Eigen::Quaterniond Turned(const Eigen::Vector3d& rotation_rad) {
  Vector6d xi = Vector6d::Zero();
  xi.tail<3>() = rotation_rad;
  return Se3::Exp(xi).q;
}

Se3 SomePose(Random& random, double reach_m) {
  Se3 T;
  T.p_m = Normal3(random, reach_m);
  T.q = Turned(Normal3(random, 1.0));
  return T.Normalized();
}

CaptureId Name(std::size_t k) {
  char text[8];
  std::snprintf(text, sizeof text, "%03u", static_cast<unsigned>(k % 1000));
  return CaptureId(text);
}

Se3 Noisy(const Se3& T, const PoseNoise& noise, Random& random) {
  Vector6d xi;
  xi.head<3>() = Normal3(random, noise.translation_m);
  xi.tail<3>() = Normal3(random, noise.rotation_rad);
  return (T * Se3::Exp(xi)).Normalized();
}

Sensor SensorCalled(const char* id, SensorKind kind) {
  Sensor sensor;
  sensor.id = SensorId(id);
  sensor.kind = kind;
  return sensor;
}

HandEyeSide CameraSide(const char* id, const VirtualView& view, bool given) {
  HandEyeSide side;
  side.sensor = SensorCalled(id, SensorKind::kCamera);
  if (given) {
    side.sensor.intrinsics = view.camera;
    side.sensor.intrinsics_sigma = std::vector<double>(9, 0.0);
  }
  side.board = view.board;
  return side;
}

}  // namespace

VirtualBody Driven(Drive drive, int captures, double tilt_rad, unsigned seed) {
  Random random(seed);
  std::uniform_real_distribution<double> place(-2, 2), yaw(-M_PI, M_PI);
  VirtualBody body{SomePose(random, 0.4), SomePose(random, 2.0), {}};
  const Eigen::Vector3d pivot(0.2, -0.3, 0);
  for (int k = 0; k < captures; ++k) {
    const double turn = yaw(random), x = place(random), y = place(random), z = place(random);
    const Eigen::Vector3d level = Normal3(random, drive == Drive::kFree ? std::max(0.3, tilt_rad) : tilt_rad);
    Se3 T;
    T.p_m = {x, y, drive == Drive::kFree ? z : 0};
    T.q = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) * Turned({level.x(), level.y(), 0});
    if (drive == Drive::kOnTheSpot) T.p_m = -(T.q * pivot);
    if (drive == Drive::kStraight) T = {{x, 0, 0}, Eigen::Quaterniond::Identity()};
    if (drive == Drive::kNoTurns) T = {{x, y, z}, Eigen::Quaterniond::Identity()};
    if (drive == Drive::kStill) T = Se3();
    body.T_world_a.push_back(T);
  }
  return body;
}

HandEyeProblem Tracked(const VirtualBody& body, const PoseNoise& a, const PoseNoise& b, unsigned seed) {
  Random random(seed);
  HandEyeProblem problem;
  problem.method = Method::kTrackerCamera;
  problem.a.sensor = SensorCalled("body", SensorKind::kTracker);
  problem.b.sensor = SensorCalled("flange", SensorKind::kTracker);
  for (std::size_t k = 0; k < body.T_world_a.size(); ++k) {
    problem.a.poses.push_back({Name(k), {}, Noisy(body.T_world_a[k], a, random)});
    problem.b.poses.push_back({Name(k), {}, Noisy(body.WorldB(k), b, random)});
  }
  return problem;
}

VirtualBody Looking(const VirtualView& view, int captures, double spread_m, double tilt_rad, unsigned seed) {
  Random random(seed);
  std::uniform_real_distribution<double> part(-1, 1);
  // The boards stand so that both are in view when the body is in the middle.
  VirtualBody body{SomePose(random, 0.3), {}, {}};
  const Eigen::Vector3d centre = CentreOf(view.board);
  const Se3 middle{centre + Eigen::Vector3d(0, 0, -1.6), Eigen::Quaterniond::Identity()};
  body.Z = middle * body.X * middle.Inverse();
  for (int k = 0; k < captures; ++k) {
    const double x = part(random), y = part(random), z = part(random);
    const Eigen::Vector3d turn = Normal3(random, tilt_rad);
    body.T_world_a.push_back({middle.p_m + spread_m * Eigen::Vector3d(x, y, z),
                              Turned(turn.cwiseMax(-2 * tilt_rad).cwiseMin(2 * tilt_rad))});
  }
  return body;
}

BoardView SeenBy(const VirtualView& view, const Se3& T_board_cam, int turn, Random& random) {
  std::normal_distribution<double> noise(0, 1);
  BoardView seen;
  seen.found = true;
  seen.target = view.board.id;
  seen.image_width_px = view.width_px;
  seen.image_height_px = view.height_px;
  const std::vector<Eigen::Vector3d> points = TargetPoints(view.board);
  const Se3 T_cam_board = T_board_cam.Inverse();
  seen.corners_px.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    // A pinhole without distortion, so that nothing under test is used.
    const Eigen::Vector3d p = T_cam_board * points[i];
    const double du = noise(random), dv = noise(random);
    const Eigen::Vector2d uv(view.camera.fx_px * p.x() / p.z() + view.camera.cx_px + view.sigma_px * du,
                             view.camera.fy_px * p.y() / p.z() + view.camera.cy_px + view.sigma_px * dv);
    seen.corner_idx.push_back(static_cast<int>(i));
    seen.corners_px[static_cast<std::size_t>(TurnedIndex(view.board, static_cast<int>(i), turn))] = uv;
    if (!(p.z() > 0.1 && uv.x() > 0 && uv.y() > 0 && uv.x() < view.width_px && uv.y() < view.height_px))
      seen.found = false;
  }
  if (!seen.found) {
    seen.why_not = "the board is not in the picture";
    seen.corners_px.clear();
    seen.corner_idx.clear();
  }
  return seen;
}

HandEyeProblem TrackerAndCamera(const VirtualBody& body, const VirtualView& view, const PoseNoise& tracker,
                                double turned_ratio, unsigned seed) {
  Random random(seed), turns(seed + 1);
  std::uniform_real_distribution<double> chance(0, 1);
  HandEyeProblem problem;
  problem.method = Method::kTrackerCamera;
  problem.a.sensor = SensorCalled("body", SensorKind::kTracker);
  problem.b = CameraSide("camera", view, true);
  for (std::size_t k = 0; k < body.T_world_a.size(); ++k) {
    problem.a.poses.push_back({Name(k), {}, Noisy(body.T_world_a[k], tracker, random)});
    const int turn = chance(turns) < turned_ratio ? 1 : 0;
    problem.b.views.emplace_back(Name(k), SeenBy(view, body.WorldB(k), turn, random));
  }
  return problem;
}

HandEyeProblem TwoCameras(const VirtualBody& body, const VirtualView& view, bool given, unsigned seed) {
  Random random(seed);
  HandEyeProblem problem;
  problem.method = Method::kNonOverlapping;
  problem.a = CameraSide("front", view, given);
  problem.b = CameraSide("back", view, given);
  problem.b.board->id = TargetId("other");
  for (std::size_t k = 0; k < body.T_world_a.size(); ++k) {
    problem.a.views.emplace_back(Name(k), SeenBy(view, body.T_world_a[k], 0, random));
    problem.b.views.emplace_back(Name(k), SeenBy(view, body.WorldB(k), 0, random));
  }
  return problem;
}

HandEyeProblem Streamed(const VirtualBody& body, const PoseNoise& noise, double seconds, double offset_s,
                        unsigned seed) {
  Random random(seed);
  HandEyeProblem problem;
  problem.method = Method::kPoseStreams;
  problem.a.sensor = SensorCalled("vio", SensorKind::kPoseStream);
  problem.b.sensor = SensorCalled("odo", SensorKind::kPoseStream);
  std::uniform_real_distribution<double> phase(0, 2 * M_PI), rate(0.2, 1.4);
  Eigen::Matrix<double, 6, 3> phases, rates;
  for (int i = 0; i < 18; ++i) phases(i) = phase(random), rates(i) = rate(random);
  const auto pose_at = [&](double t) {
    Vector6d xi = Vector6d::Zero();
    for (int i = 0; i < 3; ++i)
      xi += ((rates.col(i) * t + phases.col(i)).array().sin() * Vector6d(0.3 / rates.col(i).array()).array()).matrix();
    return Se3::Exp(xi);
  };
  const auto stamp = [](double t) { return Stamp{static_cast<std::int64_t>(std::llround(1e9 * t))}; };
  for (double t = 0; t < seconds; t += 0.01)
    problem.a.poses.push_back({{}, stamp(1000 + t), Noisy(pose_at(t), noise, random)});
  for (double t = 0.3; t < seconds - 2; t += 0.033)
    problem.b.poses.push_back(
        {{}, stamp(1000 + t - offset_s), Noisy(body.Z.Inverse() * pose_at(t) * body.X, noise, random)});
  return problem;
}

double WorstSigmas(const Se3& truth, const Se3& estimate, const Uncertainty& uncertainty) {
  const Vector6d e = (estimate.Inverse() * truth).Log();
  const Vector6d scale = uncertainty.Omega.diagonal().cwiseMax(1e-12).cwiseSqrt();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(scale.cwiseInverse().asDiagonal() * uncertainty.Omega *
                                                       scale.cwiseInverse().asDiagonal());
  const Vector6d along = solver.eigenvectors().transpose() * (scale.asDiagonal() * e);
  return (along.array().abs() * solver.eigenvalues().array().cwiseMax(0).sqrt()).maxCoeff();
}

}  // namespace rigcal::calib
