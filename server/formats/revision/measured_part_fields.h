// How documents tell a pose of which directions were not measured (docs/api.md: show, lookup).
#pragma once

#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"
#include "server/model/graph/graph.h"

namespace rigcal::formats {

// "unobservable_basis".
void WriteOpenDirections(JsonWriter& out, const std::vector<Vector6d>& open);
// "axes" of a measured part.
void WriteAxes(JsonWriter& out, const std::vector<AxisResult>& axes);
// "robot_axes": columns forward, left, up; nothing where they are not known.
void WriteRobotAxes(JsonWriter& out, const std::optional<Eigen::Matrix3d>& R_frame_robot);
[[nodiscard]] Eigen::Matrix3d ReadRobotAxes(const JsonField& field);

// "measured_part" of a sensor; nothing where it has none.
void WriteMeasuredPart(JsonWriter& out, const SensorPose& pose, const std::optional<Eigen::Matrix3d>& R_ref_robot);
// Of a sensor whose open directions are read; its axes are worked out anew.
[[nodiscard]] std::optional<MeasuredPart> ReadMeasuredPart(const JsonField& sensor, const std::vector<Vector6d>& open);

}  // namespace rigcal::formats
