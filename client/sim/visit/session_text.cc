#include "client/sim/visit/session_text.h"

#include <algorithm>

#include "client/sim/rig/random.h"
#include "client/sim/visit/yaml_text.h"

namespace rigcal::sim {
namespace {

std::string TargetLine(const Target& target) {
  std::string line = "  " + target.id.str() + ": {type: checkerboard, inner_corners: [" + std::to_string(target.cols) +
                     ", " + std::to_string(target.rows) + "], square_size_m: " + Text(target.square_m);
  if (target.square_sigma_m > 0) line += ", square_size_sigma_m: " + Text(target.square_sigma_m);
  return line + ", plate_size_m: " + Text(Eigen::VectorXd(*target.plate_m)) + "}\n";
}

std::string SensorLines(const Sensor& sensor) {
  std::string lines = "  " + sensor.id.str() + ":\n    type: " + NameOf(sensor.kind) + "\n";
  if (sensor.sees) lines += "    sees: " + sensor.sees->str() + "\n";
  if (sensor.kind == SensorKind::kCamera && !sensor.intrinsics)
    lines += "    model: " + NameOf(sensor.camera_model) + "\n";
  if (sensor.intrinsics)
    lines +=
        "    intrinsics: " + Text(*sensor.intrinsics, sensor.intrinsics_sigma ? &*sensor.intrinsics_sigma : nullptr) +
        "\n";
  if (sensor.range_bias_sigma_m) lines += "    range_bias_sigma_m: " + Text(*sensor.range_bias_sigma_m) + "\n";
  if (sensor.T_ref_nominal) lines += "    T_ref_nominal: " + Text(*sensor.T_ref_nominal) + "\n";
  return lines;
}

// A row of the tracker belongs to what others saw at that instant.
bool HasFile(const Experiment& experiment, std::size_t capture_idx) {
  const auto& sensors = experiment.rig.sensors;
  return std::any_of(sensors.begin(), sensors.end(), [&](const RigSensor& sensor) {
    return sensor.kind != SensorKind::kTracker && experiment.IsRecorded(sensor.id, capture_idx);
  });
}

}  // namespace

std::string SessionYaml(const Experiment& experiment) {
  const SessionHeader& header = experiment.declared;
  std::string text = "format: 1\nrobot: " + header.robot.str() + "\nrig_model: " + header.rig_model +
                     "\ncaptured_at: " + ToIso(header.captured_at) + "\noperator: " + header.operator_name +
                     "\nreference: " + header.reference.str() + "\ntargets:\n";
  for (const Target& target : header.targets) text += TargetLine(target);
  text += "sensors:\n";
  for (const Sensor& sensor : header.sensors) text += SensorLines(sensor);
  if (!experiment.rig.skip_pairs.empty()) text += "skip_pairs:\n";
  for (const SensorPair& pair : experiment.rig.skip_pairs) text += "  - [" + pair.a.str() + ", " + pair.b.str() + "]\n";
  text += "conditions:\n";
  for (const auto& [key, value] : header.conditions) text += "  " + key + ": " + value + "\n";
  return text;
}

std::vector<TrackerRow> TrackerRows(const Experiment& experiment, const RigSensor& tracker) {
  std::vector<TrackerRow> rows;
  for (std::size_t k = 0; k < experiment.captures.size(); ++k) {
    if (!experiment.IsRecorded(tracker.id, k) || !HasFile(experiment, k)) continue;
    Random random(KeyOf(experiment.options.seed, "tracker", tracker.id.str(), k));
    Vector6d xi;
    xi << tracker.tracker.sigma_m * random.Normals<3>(), tracker.tracker.sigma_rad * random.Normals<3>();
    rows.push_back({k, (experiment.T_world_sensor(tracker.id, k) * Se3::Exp(xi)).Normalized()});
  }
  return rows;
}

std::string PosesCsv(const Experiment& experiment, const std::vector<TrackerRow>& rows) {
  std::string text = "capture,stamp_ns,x_m,y_m,z_m,qx,qy,qz,qw\n";
  for (const TrackerRow& row : rows) {
    text += experiment.captures[row.capture_idx].str() + "," + std::to_string(experiment.stamps_ns[row.capture_idx]);
    for (int i = 0; i < 3; ++i) text += "," + Text(row.T_world_body.p_m[i]);
    for (int i = 0; i < 4; ++i) text += "," + Text(row.T_world_body.q.coeffs()[i]);
    text += "\n";
  }
  return text;
}

}  // namespace rigcal::sim
