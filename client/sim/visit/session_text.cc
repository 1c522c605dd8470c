#include "client/sim/visit/session_text.h"

#include <algorithm>
#include <cmath>

#include "client/sim/rig/random.h"
#include "client/sim/visit/sway.h"
#include "client/sim/visit/yaml_text.h"

namespace rigcal::sim {
namespace {

std::string CountsText(const Target& target) {
  const int more = target.kind == TargetKind::kCharuco ? 1 : 0;  // squares are counted, not corners
  const char* key = IsTagGrid(target.kind)                ? "tags"
                    : IsCircleGrid(target.kind)           ? "circles"
                    : target.kind == TargetKind::kCharuco ? "squares"
                                                          : "inner_corners";
  return std::string(key) + ": [" + std::to_string(target.cols + more) + ", " + std::to_string(target.rows + more) +
         "]";
}

// What tells how it is printed, beside counts and size.
std::string PrintText(const Target& target) {
  std::string text;
  if (IsCircleGrid(target.kind)) text += ", diameter_m: " + Text(target.diameter_m);
  if (target.kind == TargetKind::kCharuco) text += ", marker_size_m: " + Text(target.marker_m);
  if (target.legacy_layout) text += ", legacy_layout: true";
  if (IsTagGrid(target.kind)) text += ", spacing_ratio: " + Text(target.spacing_ratio);
  if (!target.dictionary.empty()) text += ", dictionary: " + target.dictionary;
  if (!target.marker_ids.empty())
    text += ", ids: " + Text(std::vector<double>(target.marker_ids.begin(), target.marker_ids.end()));
  return text;
}

std::string TargetLine(const Target& target) {
  std::string sigma_field = SizeFieldOf(target.kind);
  sigma_field.insert(sigma_field.size() - 1, "sigma_");
  std::string line = "  " + target.id.str() + ": {type: " + NameOf(target.kind) + ", " + CountsText(target) + ", " +
                     SizeFieldOf(target.kind) + ": " + Text(target.square_m);
  if (target.square_sigma_m > 0) line += ", " + sigma_field + ": " + Text(target.square_sigma_m);
  line += PrintText(target);
  if (!target.serial.empty()) line += ", serial: \"" + target.serial + "\"";
  if (target.mounted_on) line += ", mounted_on: " + target.mounted_on->str();
  if (target.plate_offset_m) line += ", plate_offset_m: " + Text(Eigen::VectorXd(*target.plate_offset_m));
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

Se3 WithNoise(const Se3& T, const RigSensor& tracker, Random& random) {
  Vector6d xi;
  xi << tracker.tracker.sigma_m * random.Normals<3>(), tracker.tracker.sigma_rad * random.Normals<3>();
  return (T * Se3::Exp(xi)).Normalized();
}

std::string PoseLine(const std::string& capture, std::int64_t stamp_ns, const Se3& T) {
  std::string line = capture + "," + std::to_string(stamp_ns);
  for (int i = 0; i < 3; ++i) line += "," + Text(T.p_m[i]);
  for (int i = 0; i < 4; ++i) line += "," + Text(T.q.coeffs()[i]);
  return line + "\n";
}

std::string PathLines(const Experiment& experiment, const RigSensor& tracker, std::size_t capture_idx) {
  Random random(KeyOf(experiment.options.seed, "tracker path", tracker.id.str(), capture_idx));
  std::string lines;
  const int rows = static_cast<int>(std::lround(2 * kPathHalf_s / kPathStep_s));
  for (int i = 0; i < rows; ++i) {
    // None of them at the capture itself: clocks of trackers know nothing of shutters.
    const double since_s = (i + 0.3) * kPathStep_s - kPathHalf_s;
    lines += PoseLine("", experiment.stamps_ns[capture_idx] + std::llround(since_s * 1e9),
                      WithNoise(ToldByTracker(experiment, tracker, capture_idx, since_s), tracker, random));
  }
  return lines;
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
    rows.push_back({k, WithNoise(ToldByTracker(experiment, tracker, k, 0.0), tracker, random)});
  }
  return rows;
}

std::string PosesCsv(const Experiment& experiment, const RigSensor& tracker, const std::vector<TrackerRow>& rows) {
  std::string text = "capture,stamp_ns,x_m,y_m,z_m,qx,qy,qz,qw\n";
  for (const TrackerRow& row : rows) {
    text +=
        PoseLine(experiment.captures[row.capture_idx].str(), experiment.stamps_ns[row.capture_idx], row.T_world_body);
    if (IsSwaying(experiment)) text += PathLines(experiment, tracker, row.capture_idx);
  }
  return text;
}

}  // namespace rigcal::sim
