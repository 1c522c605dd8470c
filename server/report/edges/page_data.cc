#include "server/report/edges/page_data.h"

#include <array>
#include <charconv>

#include "server/formats/json/json_writer.h"

namespace rigcal::report {
namespace {

using formats::JsonWriter;

template <typename Values>
void WriteNumbers(JsonWriter& out, const char* key, const Values& values) {
  out.List(key, [&] {
    for (const double value : values) out.Number(value);
  });
}

void WritePose(JsonWriter& out, const Se3& T) {
  WriteNumbers(out, "p", T.p_m);
  WriteNumbers(out, "q", T.q.coeffs());
}

void WritePose(JsonWriter& out, const char* key, const std::optional<Se3>& T) {
  if (!T) return out.Null(key);
  out.Object(key, [&] { WritePose(out, *T); });
}

// Half of the picture's width and height over the focal length: the principal point is near its middle.
std::optional<std::array<double, 2>> HalfOf(const std::map<std::string, double>& figures, const std::string& infix) {
  const auto value = [&](const char* name) {
    const auto found = figures.find(name + infix + "_px");
    return found == figures.end() ? 0.0 : found->second;
  };
  if (!(value("fx") > 0.0 && value("fy") > 0.0 && value("cx") > 0.0 && value("cy") > 0.0)) return std::nullopt;
  return std::array<double, 2>{value("cx") / value("fx"), value("cy") / value("fy")};
}

std::map<SensorId, std::array<double, 2>> HalfAngles(const ReportInput& input) {
  constexpr std::array<double, 2> kUsual = {0.6, 0.45};
  std::map<SensorId, std::array<double, 2>> angles;
  for (const Edge& edge : input.revision.edges) {
    if (const auto half = HalfOf(edge.figures, "_a")) angles.emplace(edge.frame_a, *half);
    if (const auto half = HalfOf(edge.figures, "_b")) angles.emplace(edge.frame_b, *half);
    const auto camera = input.sensors.find(edge.frame_a);
    const bool a_is_camera = camera != input.sensors.end() && camera->second.kind == SensorKind::kCamera;
    if (const auto half = HalfOf(edge.figures, "")) angles.emplace(a_is_camera ? edge.frame_a : edge.frame_b, *half);
  }
  for (const auto& [sensor, facts] : input.sensors)
    if (facts.kind == SensorKind::kCamera) angles.emplace(sensor, kUsual);
  return angles;
}

std::map<SensorId, Se3> PreviousPoses(const ReportInput& input) {
  std::map<SensorId, Se3> poses;
  if (!input.previous || input.previous->revision.reference != input.revision.reference) return poses;
  for (const SensorPose& pose : input.previous->revision.solution.poses)
    if (pose.known) poses.emplace(pose.sensor, pose.T_ref_sensor);
  return poses;
}

void WriteCovariance(JsonWriter& out, const SensorPose& pose) {
  const Matrix6d& C = pose.covariance;
  WriteNumbers(out, "cov", std::array<double, 6>{C(0, 0), C(0, 1), C(0, 2), C(1, 1), C(1, 2), C(2, 2)});
  WriteNumbers(out, "sigma", C.diagonal().cwiseMax(0.0).cwiseSqrt().eval());
  out.Text("sigma_source", SigmaSourceOf(pose));
}

void WriteSensors(JsonWriter& out, const ReportInput& input) {
  const auto halves = HalfAngles(input);
  const auto previous = PreviousPoses(input);
  for (const SensorPose& pose : input.revision.solution.poses)
    out.Object([&] {
      out.Text("id", pose.sensor.str());
      const bool is_reference = pose.sensor == input.revision.reference;
      out.Flag("reference", is_reference);
      const auto facts = input.sensors.find(pose.sensor);
      out.Text("kind", facts == input.sensors.end() ? "" : NameOf(facts->second.kind));
      if (const auto half = halves.find(pose.sensor); half != halves.end()) WriteNumbers(out, "half", half->second);
      WritePose(out, "nominal", facts == input.sensors.end() ? std::nullopt : facts->second.T_ref_nominal);
      if (!pose.known) return;
      WritePose(out, pose.T_ref_sensor);
      if (!is_reference) WriteCovariance(out, pose);
      const auto before = previous.find(pose.sensor);
      WritePose(out, "previous", before == previous.end() ? std::nullopt : std::optional<Se3>(before->second));
    });
}

// What is drawn needs no more digits.
double Rounded(double value) {
  std::array<char, 32> text{};
  const char* end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, 3).ptr;
  std::from_chars(text.data(), end, value);
  return value;
}

void WriteCaptures(JsonWriter& out, const Edge& edge) {
  out.List("captures", [&] {
    for (const CaptureResidual& capture : edge.captures)
      out.Object([&] {
        out.Text("capture", capture.capture.str());
        out.Number("rms", Rounded(capture.rms));
        if (capture.used) return;
        out.Flag("unused", true);
        out.Text("note", capture.note);
      });
  });
}

void WriteBlocks(JsonWriter& out, const ReportInput& input, const EdgeId& edge) {
  out.List("blocks", [&] {
    const auto found = input.blocks.find(edge);
    if (found == input.blocks.end()) return;
    for (const BlockVector& block : found->second)
      out.Object([&] {
        out.Text("id", block.block_id);
        WriteNumbers(out, "d", block.d.unaryExpr(&Rounded).eval());
      });
  });
}

void WriteEdge(JsonWriter& out, const ReportInput& input, const ShownEdge& shown) {
  const Edge& edge = *shown.edge;
  out.Text("anchor", shown.anchor);
  out.Text("a", edge.frame_a.str());
  out.Text("b", edge.frame_b.str());
  out.Text("state", edge.state == EdgeState::kGood ? "good" : "failed");
  out.Text("unit", ResidualUnitOf(edge.method));
  WriteCaptures(out, edge);
  WriteBlocks(out, input, edge.id);
  out.List("sigma", [&] {
    for (int axis = 0; axis < 6; ++axis) {
      const AxisSigma sigma = SigmaOf(edge.uncertainty, axis);
      sigma.known ? out.Number(sigma.value) : out.Null();
    }
  });
}

// For the viewer: whose colours are in the points, and which way is up.
void WriteClouds(JsonWriter& out, const CloudSection& clouds) {
  out.List("clouds", [&] {
    for (const ColouredLidar& lidar : clouds.lidars)
      out.Object([&] {
        out.Text("lidar", lidar.lidar);
        WriteNumbers(out, "up", lidar.up);
        out.List("cameras", [&] {
          for (const std::string& name : lidar.camera_names) out.Text(name);
        });
      });
  });
}

}  // namespace

std::string PageData(const ReportInput& input, const std::vector<ShownEdge>& edges) {
  const std::string json = formats::WriteObject([&](JsonWriter& out) {
    out.Integer("number", input.number);
    if (!input.revision.basis.culprits.empty())
      out.List("culprits", [&] {
        for (const SensorId& sensor : input.revision.basis.culprits) out.Text(sensor.str());
      });
    out.List("sensors", [&] { WriteSensors(out, input); });
    WriteClouds(out, input.clouds);
    out.List("edges", [&] {
      for (const ShownEdge& shown : edges)
        if (shown.detailed) out.Object([&] { WriteEdge(out, input, shown); });
    });
  });
  return "window.rigcal = " + json + ";\n";
}

}  // namespace rigcal::report
