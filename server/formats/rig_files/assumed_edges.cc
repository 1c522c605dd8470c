#include "server/formats/rig_files/assumed_edges.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <set>

#include "server/base/text.h"

namespace rigcal::rig_files {
namespace {

constexpr double kMPerMm = 1e-3, kRadPerDeg = 0.017453292519943295;
constexpr const char* kName =
    "Name sensors with --frame SENSOR or --frame SENSOR=FRAME, once each; the first is what the others are measured "
    "from.";

std::optional<double> PositiveNumber(std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [at, status] = std::from_chars(text.data(), end, value);
  return status == std::errc() && at == end && value > 0 && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace

Result<AssumedSigma> ParseAssumedSigma(const std::string& text) {
  const std::size_t comma = text.find(',');
  const auto mm = PositiveNumber(std::string_view(text).substr(0, comma));
  const auto deg = comma == std::string::npos ? std::nullopt : PositiveNumber(std::string_view(text).substr(comma + 1));
  if (mm && deg) return AssumedSigma{*mm * kMPerMm, *deg * kRadPerDeg};
  return Fail(ErrorCode::kInvalidInput,
              "the sigma " + Quoted(text) + " is not two positive numbers with a comma between them",
              "Write millimetres and degrees, 1 sigma per axis: 5,0.5.");
}

Result<SensorFrame> ParseSensorFrame(const std::string& text) {
  const std::size_t equals = text.find('=');
  SensorFrame named;
  RIGCAL_ASSIGN(named.sensor, SensorId::Parse(text.substr(0, equals)));
  named.frame = equals == std::string::npos ? named.sensor.str() : text.substr(equals + 1);
  if (named.frame.empty())
    return Fail(ErrorCode::kInvalidInput, "the frame of sensor '" + named.sensor.str() + "' is empty",
                "Write SENSOR=FRAME.");
  return named;
}

Result<std::vector<SensorFrame>> AllFrames(const RigFile& file) {
  if (file.format == "urdf")
    return Fail(ErrorCode::kInvalidInput, "a URDF has links that are no sensors",
                std::string(kName) + " Frames: " + FramesText(file) + ".");
  std::vector<SensorFrame> sensors;
  std::set<std::string> seen;
  for (const FramePose& pose : file.poses)
    for (const std::string& frame : {pose.parent, pose.frame}) {
      if (!seen.insert(frame).second) continue;
      auto sensor = SensorId::Parse(frame);
      if (!sensor)
        return Fail(ErrorCode::kInvalidInput, "frame '" + Shown(frame) + "' cannot be a sensor's name", kName);
      sensors.push_back({*std::move(sensor), frame});
    }
  return sensors;
}

Result<std::vector<Edge>> AssumedEdges(const RigFile& file, const RobotId& robot,
                                       const std::vector<SensorFrame>& sensors, const AssumedSigma& sigma) {
  if (sensors.size() < 2) return Fail(ErrorCode::kInvalidInput, "fewer than two sensors are named", kName);
  RIGCAL_ASSIGN(const auto poses, PosesIn(file, sensors.front().frame));
  Matrix6d covariance = Matrix6d::Zero();
  for (int axis = 0; axis < 6; ++axis) covariance(axis, axis) = axis < 3 ? sigma.m * sigma.m : sigma.rad * sigma.rad;
  RIGCAL_ASSIGN(const Uncertainty uncertainty, FromCovariance(covariance, UncertaintySource::kAssumed, 0));
  std::vector<Edge> edges;
  for (std::size_t k = 1; k < sensors.size(); ++k) {
    const auto pose = poses.find(sensors[k].frame);
    if (pose == poses.end())
      return Fail(
          ErrorCode::kNotFound,
          "no fixed joints tie frame '" + Shown(sensors[k].frame) + "' to '" + Shown(sensors.front().frame) + "'",
          "Frames in the file: " + FramesText(file) + ".");
    Edge edge;
    edge.robot = robot;
    edge.frame_a = sensors.front().sensor;
    edge.frame_b = sensors[k].sensor;
    edge.T_a_b = pose->second;
    edge.uncertainty = uncertainty;
    edge.method = "assumed";
    edge.state = EdgeState::kGood;
    if (const Status valid = Validate(edge); !valid) return Fail(valid.error());
    edges.push_back(std::move(edge));
  }
  AssignPushedIds(edges);
  return edges;
}

}  // namespace rigcal::rig_files
