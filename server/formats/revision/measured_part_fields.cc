#include "server/formats/revision/measured_part_fields.h"

#include <array>

#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

constexpr std::array<const char*, 3> kRobotAxes = {"forward", "left", "up"};
constexpr double kOrthogonalTolerance = 1e-6;

void WriteTriple(JsonWriter& out, std::string_view key, const Eigen::Vector3d& values) {
  out.List(key, [&] {
    for (const double value : values) out.Number(value);
  });
}

void WriteIfKnown(JsonWriter& out, std::string_view key, const std::optional<double>& value) {
  value ? out.Number(key, *value) : out.Null(key);
}

}  // namespace

void WriteOpenDirections(JsonWriter& out, const std::vector<Vector6d>& open) {
  out.List("unobservable_basis", [&] {
    for (const Vector6d& direction : open)
      out.List([&] {
        for (const double value : direction) out.Number(value);
      });
  });
}

void WriteAxes(JsonWriter& out, const std::vector<AxisResult>& axes) {
  out.List("axes", [&] {
    for (const AxisResult& axis : axes)
      out.Object([&] {
        axis.name.empty() ? out.Null("name") : out.Text("name", axis.name);
        WriteTriple(out, "direction", axis.direction);
        if (axis.turn) return WriteIfKnown(out, "sigma_rad", axis.sigma_rad);
        WriteIfKnown(out, "position_m", axis.position_m);
        WriteIfKnown(out, "sigma_m", axis.sigma_m);
      });
  });
}

void WriteRobotAxes(JsonWriter& out, const std::optional<Eigen::Matrix3d>& R_frame_robot) {
  if (!R_frame_robot) return;
  out.Object("robot_axes", [&] {
    for (std::size_t k = 0; k < kRobotAxes.size(); ++k)
      WriteTriple(out, kRobotAxes[k], R_frame_robot->col(static_cast<Eigen::Index>(k)));
  });
}

Eigen::Matrix3d ReadRobotAxes(const JsonField& field) {
  Eigen::Matrix3d R;
  for (std::size_t k = 0; k < kRobotAxes.size(); ++k) {
    Eigen::Vector3d axis = Eigen::Vector3d::Zero();
    field.At(kRobotAxes[k]).Numbers(axis.data(), 3);
    R.col(static_cast<Eigen::Index>(k)) = axis;
  }
  const Eigen::Matrix3d off = R.transpose() * R - Eigen::Matrix3d::Identity();
  if (!(off.cwiseAbs().maxCoeff() <= kOrthogonalTolerance)) field.Refuse("must be three unit vectors at right angles");
  return R;
}

void WriteMeasuredPart(JsonWriter& out, const SensorPose& pose, const std::optional<Eigen::Matrix3d>& R_ref_robot) {
  if (pose.known || !pose.measured_part) return;
  out.Object("measured_part", [&] {
    WritePose(out, "T_ref_sensor", pose.measured_part->T_ref_sensor);
    WriteMatrix(out, "covariance", pose.measured_part->covariance);
    out.Text("sigma_source", pose.measured_part->by_jackknife ? "jackknife" : "analytic");
    WriteAxes(out, AxesOf(pose, R_ref_robot));
  });
}

std::optional<MeasuredPart> ReadMeasuredPart(const JsonField& sensor, const std::vector<Vector6d>& open) {
  const auto field = sensor.Find("measured_part");
  if (!field) return std::nullopt;
  if (open.empty()) field->Refuse("needs unobservable_basis beside it");
  return MeasuredPart{ReadPose(field->At("T_ref_sensor"), kUnitTolerance), ReadMatrix(field->At("covariance")),
                      field->At("sigma_source").Text() == "jackknife"};
}

}  // namespace rigcal::formats
