#include "server/fleet/partial_poses.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>

#include "server/fleet/failures.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

constexpr double kAlongAxis = 0.98480775301220802;  // the cosine of 10 degrees
constexpr double kNothing = 1e-3;                   // m per m or rad, and the other way round

// The sensor as one edge to a known sensor has it.
struct Tied {
  Se3 T_ref_sensor;
  Matrix6d covariance = Matrix6d::Zero();  // right tangent at the sensor; without what the edge leaves open
};

const SensorPose* KnownPose(const GraphSolution& solution, const SensorId& sensor) {
  const auto found = std::find_if(solution.poses.begin(), solution.poses.end(),
                                  [&](const SensorPose& pose) { return pose.sensor == sensor && pose.known; });
  return found == solution.poses.end() ? nullptr : &*found;
}

Tied TiedBy(const Edge& edge, const SensorPose& known) {
  const bool forward = edge.frame_a == known.sensor;
  const Se3 T_known_sensor = forward ? edge.T_a_b : edge.T_a_b.Inverse();
  const Matrix6d turn = Adjoint(edge.T_a_b), follow = Adjoint(T_known_sensor.Inverse());
  const Matrix6d of_edge =
      forward ? edge.uncertainty.covariance : Matrix6d(turn * edge.uncertainty.covariance * turn.transpose());
  return {known.T_ref_sensor * T_known_sensor, follow * known.covariance * follow.transpose() + of_edge};
}

// Of the edges that leave open no more than the pose the most certain.
std::optional<Tied> TieOf(const SensorPose& pose, const std::vector<Edge>& edges, const GraphSolution& solution) {
  std::optional<Tied> best;
  for (const Edge& edge : edges) {
    if (edge.state != EdgeState::kGood || !IsEndOf(edge, pose.sensor)) continue;
    if (edge.uncertainty.rank != 6 - static_cast<int>(pose.unobservable_basis.size())) continue;
    const SensorPose* known = KnownPose(solution, edge.frame_a == pose.sensor ? edge.frame_b : edge.frame_a);
    if (known == nullptr) continue;
    const Tied tied = TiedBy(edge, *known);
    if (!best || tied.covariance.trace() < best->covariance.trace()) best = tied;
  }
  return best;
}

// Axes that directions are told by.
struct NamedAxes {
  Eigen::Matrix3d R_ref_axes = Eigen::Matrix3d::Identity();
  std::array<const char*, 6> names = {};  // by the tangent's indices
  std::string frame;                      // as PartialPose::frame
};

std::string FrameOf(const SensorId& reference, const SessionHeaders& headers) {
  const std::string frame = "the frame of " + reference.str();
  for (const SessionHeader* header : NewestFirst(headers))
    if (const Sensor* sensor = rigcal::SensorOf(*header, reference); sensor && sensor->kind == SensorKind::kCamera)
      return frame + " (x right, y down, z along its view)";
  return frame;
}

NamedAxes AxesToTell(const SensorId& reference, const SessionHeaders& headers) {
  if (const auto R_ref_robot = RobotAxes(reference, headers))
    return {*R_ref_robot,
            {"the forward position", "the sideways position", "the height", "the roll", "the pitch", "the yaw"},
            ""};
  return {Eigen::Matrix3d::Identity(),
          {"the position along x", "the position along y", "the position along z", "the turn about x",
           "the turn about y", "the turn about z"},
          FrameOf(reference, headers)};
}

// Empty: along no axis.
std::string NameOfDirection(const Vector6d& direction, const NamedAxes& axes, const Eigen::Matrix3d& R_ref_sensor) {
  const Eigen::Vector3d shift = direction.head<3>(), turn = direction.tail<3>();
  if (shift.norm() > kNothing && turn.norm() > kNothing) return "";
  const bool turns = turn.norm() > kNothing;
  const Eigen::Vector3d line = (axes.R_ref_axes.transpose() * R_ref_sensor * (turns ? turn : shift)).normalized();
  Eigen::Index axis = 0;
  if (!(line.cwiseAbs().maxCoeff(&axis) >= kAlongAxis)) return "";
  return axes.names.at(static_cast<std::size_t>(axis + (turns ? 3 : 0)));
}

std::string CountedDirections(std::size_t count) {
  return count == 1 ? "one direction" : std::to_string(count) + " directions";
}

// Empty: not each of them is along an axis of its own.
std::vector<std::string> NamesOfOpen(const SensorPose& pose, const NamedAxes& axes,
                                     const Eigen::Matrix3d& R_ref_sensor) {
  std::vector<std::string> names;
  for (const Vector6d& direction : pose.unobservable_basis)
    names.push_back(NameOfDirection(direction, axes, R_ref_sensor));
  std::vector<std::string> sorted = names;
  std::sort(sorted.begin(), sorted.end());
  const bool told = !sorted.front().empty() && std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
  return told ? names : std::vector<std::string>{};
}

double LargestSigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(std::max(0.0, covariance.diagonal().maxCoeff()));
}

// Across the shifts that are open.
void FillSigmas(const SensorPose& pose, const Tied& tied, PartialPose& partial) {
  const auto count = static_cast<Eigen::Index>(pose.unobservable_basis.size());
  Eigen::Matrix<double, 3, Eigen::Dynamic> open(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Vector6d& direction = pose.unobservable_basis[static_cast<std::size_t>(k)];
    if (direction.tail<3>().norm() > kNothing) return;
    open.col(k) = direction.head<3>();
  }
  if (count >= 3) return;
  const Eigen::Matrix3d Q = Eigen::HouseholderQR<Eigen::Matrix<double, 3, Eigen::Dynamic>>(open).householderQ();
  const Eigen::Matrix3d across = Q.rightCols(3 - count) * Q.rightCols(3 - count).transpose();
  partial.sigma_m = LargestSigma(across * tied.covariance.topLeftCorner<3, 3>() * across);
  partial.sigma_rad = LargestSigma(tied.covariance.bottomRightCorner<3, 3>());
}

// Of a session, in the reference's frame.
std::optional<Se3> BodyIn(const SessionHeader& header, const SensorId& reference, SensorKind kind) {
  const Sensor* from = rigcal::SensorOf(header, reference);
  for (const Sensor& sensor : header.sensors)
    if (from && sensor.kind == kind)
      if (const auto T_ref_body = NominalPose(header, *from, sensor)) return T_ref_body;
  return std::nullopt;
}

}  // namespace

std::optional<Eigen::Matrix3d> RobotAxes(const SensorId& reference, const SessionHeaders& headers) {
  const auto is_body = [](const Sensor& sensor) {
    return sensor.kind == SensorKind::kPoseStream || sensor.kind == SensorKind::kTracker;
  };
  const std::vector<const SessionHeader*> newest = NewestFirst(headers);
  for (const SessionHeader* header : newest)
    if (const Sensor* sensor = rigcal::SensorOf(*header, reference); sensor && is_body(*sensor))
      return Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  for (const SensorKind kind : {SensorKind::kPoseStream, SensorKind::kTracker})
    for (const SessionHeader* header : newest)
      if (const auto T_ref_body = BodyIn(*header, reference, kind)) return T_ref_body->R();
  return std::nullopt;
}

PartialPose PartialPoseOf(const SensorPose& pose, const std::vector<Edge>& edges, const GraphSolution& solution,
                          const SessionHeaders& headers) {
  PartialPose partial;
  partial.sensor = pose.sensor;
  const std::size_t count = pose.unobservable_basis.size();
  partial.several = count > 1;
  partial.open = CountedDirections(count);
  const auto tie = TieOf(pose, edges, solution);
  const SensorPose* reference = ReferenceOf(solution);
  if (!tie || reference == nullptr) return partial;
  const NamedAxes axes = AxesToTell(reference->sensor, headers);
  if (const auto names = NamesOfOpen(pose, axes, tie->T_ref_sensor.R()); !names.empty()) {
    partial.open = List(names);
    partial.frame = axes.frame;
  }
  FillSigmas(pose, *tie, partial);
  return partial;
}

}  // namespace rigcal::fleet
