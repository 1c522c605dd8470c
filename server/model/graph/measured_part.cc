#include "server/model/graph/measured_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "server/model/graph/graph.h"
#include "server/model/graph/pose_results.h"

namespace rigcal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kAlongAxis = 0.98480775301220802;  // the cosine of 10 degrees
// What goes with an open turn or shift and is next to nothing: a sensor 1 mm beside the axis; what noise makes of a
// level floor, on which the height of a sensor is open.
constexpr double kShiftPerTurn_m = 1e-3, kTurnPerShift_rad = 1e-2;
constexpr double kSameLine = 1e-3;

// The shift (turn) of an open direction; nothing where there is none to speak of.
std::optional<Vector3d> LineOf(const Vector6d& direction, int start) {
  const bool turn = start == tangent::kRotation;
  const Vector3d part = direction.segment<3>(start),
                 other = direction.segment<3>(turn ? tangent::kTranslation : tangent::kRotation);
  const double size = part.norm(), least = (turn ? kTurnPerShift_rad : kShiftPerTurn_m) * other.norm();
  if (!(size > least) || !std::isfinite(size)) return std::nullopt;
  return part.normalized();
}

// On what the shifts (turns) among the open directions span, in the frame of the pose.
Matrix3d ProjectorOnOpen(const std::vector<Vector6d>& open, int start, const Matrix3d& R_frame_sensor) {
  Matrix3d P = Matrix3d::Zero();
  for (const Vector6d& direction : open) {
    const auto in_sensor = LineOf(direction, start);
    if (!in_sensor) continue;
    const Vector3d line = R_frame_sensor * *in_sensor, rest = line - P * line;
    if (rest.norm() > kSameLine) P += rest.normalized() * rest.normalized().transpose();
  }
  return P;
}

struct AlignedLine {
  Eigen::Index axis = 0;  // the nearest
  Vector3d line;
  bool open = false;
};

// An orthonormal basis of what P projects on, as near to the axes (columns) as it goes.
void AddAligned(Matrix3d P, const Matrix3d& axes, bool open, std::vector<AlignedLine>& lines) {
  for (int count = static_cast<int>(std::lround(P.trace())); count > 0; --count) {
    AlignedLine next{0, Vector3d::Zero(), open};
    const Eigen::RowVector3d share = (P * axes).colwise().norm();
    share.maxCoeff(&next.axis);
    next.line = (P * axes.col(next.axis)).normalized();
    P -= next.line * next.line.transpose();
    lines.push_back(next);
  }
}

std::vector<AlignedLine> AlignedLines(const Matrix3d& P_open, const Matrix3d& axes) {
  std::vector<AlignedLine> lines;
  AddAligned(P_open, axes, true, lines);
  AddAligned(Matrix3d::Identity() - P_open, axes, false, lines);
  std::stable_sort(lines.begin(), lines.end(),
                   [](const AlignedLine& x, const AlignedLine& y) { return x.axis < y.axis; });
  return lines;
}

std::optional<double> SigmaAlong(const Vector6d& direction, const Matrix6d& covariance) {
  const double variance = direction.dot(covariance * direction);
  if (!std::isfinite(variance)) return std::nullopt;
  return std::sqrt(std::max(0.0, variance));
}

std::string Component(double value, const char* axis) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.2f %s", value, axis);
  return text.data();
}

bool CanBeTold(const AxisResult& axis) { return axis.measured() || !axis.name.empty(); }

}  // namespace

std::vector<AxisResult> AxesOf(const Se3& T_frame_sensor, const Matrix6d& covariance, const std::vector<Vector6d>& open,
                               const std::optional<Matrix3d>& R_frame_robot) {
  const Matrix3d R = T_frame_sensor.R(), axes = R_frame_robot.value_or(Matrix3d::Identity());
  const auto& names = R_frame_robot ? kRobotResults : kFrameResults;
  std::vector<AxisResult> results;
  for (const int start : {tangent::kTranslation, tangent::kRotation}) {
    for (const AlignedLine& aligned : AlignedLines(ProjectorOnOpen(open, start, R), axes)) {
      AxisResult& result = results.emplace_back();
      result.turn = start == tangent::kRotation;
      result.direction = aligned.line;
      if (aligned.line.dot(axes.col(aligned.axis)) >= kAlongAxis)
        result.name = names[static_cast<std::size_t>(start + aligned.axis)];
      if (aligned.open) continue;
      Vector6d along = Vector6d::Zero();
      along.segment<3>(start) = R.transpose() * aligned.line;
      (result.turn ? result.sigma_rad : result.sigma_m) = SigmaAlong(along, covariance);
      const double position_m = aligned.line.dot(T_frame_sensor.p_m);
      if (result.sigma_m && std::isfinite(position_m)) result.position_m = position_m;
    }
  }
  return results;
}

std::vector<AxisResult> AxesOf(const SensorPose& pose, const std::optional<Matrix3d>& R_ref_robot) {
  if (pose.known) return AxesOf(pose.T_ref_sensor, pose.covariance, {}, R_ref_robot);
  if (!pose.measured_part) return {};
  return AxesOf(pose.measured_part->T_ref_sensor, pose.measured_part->covariance, pose.unobservable_basis, R_ref_robot);
}

bool OpenHaveNames(const std::vector<AxisResult>& axes) {
  return !axes.empty() && std::all_of(axes.begin(), axes.end(), CanBeTold);
}

std::vector<std::string> NamesOfOpen(const std::vector<AxisResult>& axes, std::size_t open_count) {
  if (!OpenHaveNames(axes)) return {open_count == 1 ? "one direction" : std::to_string(open_count) + " directions"};
  std::vector<std::string> names;
  for (const AxisResult& axis : axes)
    if (!axis.measured()) names.push_back(axis.name);
  return names;
}

std::string InSentence(const std::string& name) {
  if (name == kRobotResults[0] || name == kRobotResults[1]) return "the " + name + " position";
  for (std::size_t k = 0; k < 6; ++k) {
    if (name == kRobotResults[k]) return "the " + name;
    if (name == kFrameResults[k]) return (k < 3 ? "the position along " : "the turn about ") + name.substr(k / 3);
  }
  return name;
}

std::string DirectionText(const Vector3d& direction, const std::optional<Matrix3d>& R_frame_robot) {
  constexpr double kShown = 0.005;
  const Vector3d components = R_frame_robot ? Vector3d(R_frame_robot->transpose() * direction) : direction;
  std::string text;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    if (!(std::abs(components[k]) >= kShown)) continue;
    text += (text.empty() ? "" : ", ") +
            Component(components[k], R_frame_robot ? kRobotResults[axis] : kFrameResults[axis]);
  }
  return text;
}

std::string LabelOf(const AxisResult& axis, const std::optional<Matrix3d>& R_frame_robot) {
  if (!axis.name.empty()) return axis.name;
  return (axis.turn ? "about (" : "(") + DirectionText(axis.direction, R_frame_robot) + ")";
}

RestSigma WorstSigmaOf(const std::vector<AxisResult>& axes) {
  RestSigma worst;
  for (const AxisResult& axis : axes) {
    if (axis.sigma_m) worst.m = std::max(worst.m.value_or(0.0), *axis.sigma_m);
    if (axis.sigma_rad) worst.rad = std::max(worst.rad.value_or(0.0), *axis.sigma_rad);
  }
  return worst;
}

bool TurnsMeasured(const std::vector<AxisResult>& axes) {
  return !axes.empty() &&
         std::all_of(axes.begin(), axes.end(), [](const AxisResult& axis) { return !axis.turn || axis.measured(); });
}

}  // namespace rigcal
