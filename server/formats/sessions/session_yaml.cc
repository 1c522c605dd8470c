#include <algorithm>

#include "server/base/limits.h"
#include "server/base/text.h"
#include "server/formats/sessions/session_folder.h"
#include "server/formats/sessions/target_yaml.h"
#include "server/formats/yaml/yaml_values.h"
#include "server/model/edges/past.h"
#include "server/model/edges/unit_doubt.h"

namespace rigcal::formats {
namespace {

constexpr const char* kYamlCure = "Mend the file; docs/session-format.md has a complete example.";

// A key is printable, but may be a whole file long.
std::string Title(const std::string& kind, const std::string& key) {
  return kind + " " + (key.size() <= limits::kNameMax ? "'" + key + "'" : Quoted(key));
}

std::string TextOr(const YamlField& map, std::string_view key, const std::string& otherwise) {
  const auto field = map.Find(key);
  return field ? field->Text() : otherwise;
}

Stamp ReadCapturedAt(const YamlField& field) {
  const Result<Stamp> stamp = ParseIso(field.Text());
  if (stamp) return *stamp;
  field.Refuse(stamp.error().what, "Write the time of the capture as 2026-01-31T12:00:00Z.");
  return {};
}

Se3 ReadPose(const YamlField& field) {
  field.AllowOnly({"p_m", "q_xyzw"});
  Se3 T;
  field.At("p_m").Numbers(T.p_m.data(), 3);
  T.q = ReadQuaternion(field.At("q_xyzw"));
  return T.Normalized();
}

CameraModel ReadModel(const YamlField& field) {
  const Result<CameraModel> model = CameraModelOf(field.Text());
  if (model) return *model;
  field.Refuse("is not known here",
               "This version knows pinhole_radtan, pinhole_rational, fisheye_kb4, eucm and double_sphere.");
  return CameraModel::kPinholeRadtan;
}

void ReadIntrinsics(const YamlField& field, Sensor& sensor) {
  field.AllowOnly({"model", "fx_px", "fy_px", "cx_px", "cy_px", "distortion", "sigma"});
  if (const auto model = field.Find("model")) sensor.camera_model = ReadModel(*model);
  CameraIntrinsics camera;
  camera.model = sensor.camera_model;
  camera.distortion.assign(DistortionCount(camera.model), 0.0);
  camera.fx_px = field.At("fx_px").Number();
  camera.fy_px = field.At("fy_px").Number();
  camera.cx_px = field.At("cx_px").Number();
  camera.cy_px = field.At("cy_px").Number();
  // Without distortion a series is zero; a sphere model is no lens.
  if (const auto k = IsSphere(camera.model) ? field.At("distortion") : field.Find("distortion"))
    k->Numbers(camera.distortion.data(), camera.distortion.size());
  sensor.intrinsics = camera;
  if (const auto sigma = field.Find("sigma")) {
    sensor.intrinsics_sigma.emplace(4 + camera.distortion.size());
    sigma->Numbers(sensor.intrinsics_sigma->data(), sensor.intrinsics_sigma->size());
  }
}

CloudLayout ReadLayout(const YamlField& fields, const std::optional<YamlField>& type) {
  CloudLayout layout;
  for (const YamlField& name : fields.Items()) layout.fields.push_back(name.Text());
  if (!type) return layout;
  layout.type = ReadNamed(*type, PointTypeOf, layout.type);
  return layout;
}

Sensor ReadSensor(const YamlField& field) {
  field.AllowOnly({"type", "sees", "model", "intrinsics", "range_bias_sigma_m", "clock_sigma_s", "fields", "point_type",
                   "serial", "firmware", "T_ref_nominal"});
  Sensor sensor;
  sensor.id = SensorId(field.Key());
  sensor.kind = ReadNamed(field.At("type"), SensorKindOf, sensor.kind);
  if (const auto sees = field.Find("sees")) sensor.sees = ReadId<TargetId>(*sees);
  const auto model = field.Find("model");
  if (model && sensor.kind == SensorKind::kCamera) sensor.camera_model = ReadModel(*model);
  if (model && sensor.kind != SensorKind::kCamera) model->Refuse("is for cameras only", "Leave it away.");
  if (const auto intrinsics = field.Find("intrinsics")) ReadIntrinsics(*intrinsics, sensor);
  if (const auto sigma = field.Find("range_bias_sigma_m")) sensor.range_bias_sigma_m = sigma->Number();
  if (const auto sigma = field.Find("clock_sigma_s")) sensor.clock_sigma_s = sigma->Number();
  if (const auto fields = field.Find("fields")) sensor.layout = ReadLayout(*fields, field.Find("point_type"));
  if (const auto point_type = field.Find("point_type"); point_type && !sensor.layout)
    point_type->Refuse("is given without fields", "Name what a point holds, such as fields: [x, y, z, intensity].");
  sensor.serial = TextOr(field, "serial", "");
  sensor.firmware = TextOr(field, "firmware", "");
  if (const auto T = field.Find("T_ref_nominal")) sensor.T_ref_nominal = ReadPose(*T);
  if (const Status valid = Validate(sensor); !valid) field.Refuse(valid.error());
  return sensor;
}

SensorPair ReadSkipPair(const YamlField& field) {
  const std::vector<YamlField> names = field.Items();
  if (names.size() == 2) return {ReadId<SensorId>(names[0]), ReadId<SensorId>(names[1])};
  field.Refuse("must be two names of sensors, [a, b]");
  return {};
}

SessionHeader ReadHeader(const YamlField& root) {
  root.AllowOnly({"format", "robot", "rig_model", "captured_at", "operator", "reference", "targets", "sensors",
                  "skip_pairs", "remounted", "lidar_polish", "conditions"});
  SessionHeader header;
  header.format = static_cast<int>(root.At("format").Integer(1, 1));
  header.robot = ReadId<RobotId>(root.At("robot"));
  header.rig_model = TextOr(root, "rig_model", "");
  header.captured_at = ReadCapturedAt(root.At("captured_at"));
  header.operator_name = TextOr(root, "operator", "");
  if (const auto targets = root.Find("targets"))
    for (const YamlField& target : targets->Members())
      header.targets.push_back(ReadTarget(target.Called(Title("target", target.Key()))));
  for (const YamlField& sensor : root.At("sensors").Members())
    header.sensors.push_back(ReadSensor(sensor.Called(Title("sensor", sensor.Key()))));
  for (const Sensor& sensor : header.sensors)
    if (sensor.kind == SensorKind::kCamera) static_cast<void>(root.At("targets"));  // pictures are of something
  if (const auto reference = root.Find("reference"))
    header.reference = ReadId<SensorId>(*reference);
  else if (!header.sensors.empty())
    header.reference = header.sensors.front().id;
  if (const auto pairs = root.Find("skip_pairs"))
    for (const YamlField& pair : pairs->Items()) header.skip_pairs.push_back(ReadSkipPair(pair));
  if (const auto remounted = root.Find("remounted"))
    for (const YamlField& sensor : remounted->Items()) AddRemounted(ReadId<SensorId>(sensor), header);
  if (const auto polish = root.Find("lidar_polish"))
    header.lidar_polish = ReadNamed(*polish, LidarPolishOf, LidarPolish::kNone);
  if (const auto conditions = root.Find("conditions"))
    for (const YamlField& condition : conditions->Members())
      header.conditions.emplace(condition.Key(), condition.Text());
  return header;
}

// Which line a rule that spans the file is about.
YamlField PlaceOf(const YamlField& root, const SessionHeader& header) {
  const auto is_sensor = [&](const std::string& id) { return root.At("sensors").Find(id).has_value(); };
  const auto targets = root.Find("targets");
  for (const YamlField& sensor : root.At("sensors").Members()) {
    const auto sees = sensor.Find("sees");
    if (sees && !(targets && targets->Find(sees->Text()))) return *sees;
  }
  if (targets)
    for (const YamlField& target : targets->Members()) {
      const auto carrier = target.Find("mounted_on");
      const auto named = std::find_if(header.sensors.begin(), header.sensors.end(), [&](const Sensor& sensor) {
        return carrier && sensor.id.str() == carrier->Text();
      });
      if (carrier && (named == header.sensors.end() || named->kind != SensorKind::kTracker)) return *carrier;
    }
  if (const auto pairs = root.Find("skip_pairs"))
    for (const YamlField& pair : pairs->Items()) {
      const std::string a = pair.Items()[0].Text(), b = pair.Items()[1].Text();
      if (a == b || !is_sensor(a) || !is_sensor(b)) return pair;
    }
  if (const auto remounted = root.Find("remounted"))
    for (const YamlField& sensor : remounted->Items())
      if (!is_sensor(sensor.Text())) return sensor;
  const auto reference = root.Find("reference");
  if (reference && !is_sensor(header.reference.str())) return *reference;
  const auto polish = root.Find("lidar_polish");
  return polish && header.lidar_polish != LidarPolish::kNone && !HasLidarPair(header) ? *polish : root;
}

// Of the drawn poses that which is farthest from the reference; of none the file.
YamlField FarthestNominal(const YamlField& root, const SessionHeader& header) {
  double farthest_m = -1.0;
  YamlField place = root;
  for (const Sensor& sensor : header.sensors) {
    if (!sensor.T_ref_nominal || sensor.T_ref_nominal->p_m.norm() <= farthest_m) continue;
    farthest_m = sensor.T_ref_nominal->p_m.norm();
    place = *root.At("sensors").At(sensor.id.str()).Find("T_ref_nominal");
  }
  return place;
}

}  // namespace

Result<SessionHeader> ReadSessionYaml(std::string_view text, const std::string& name) {
  RIGCAL_ASSIGN(const std::unique_ptr<YamlTree> tree, ParseYaml(text, name, kYamlCure, limits::kSessionYamlBytesMax));
  const YamlField root(*tree);
  SessionHeader header = ReadHeader(root);
  if (tree->error) return Fail(*tree->error);
  if (const Status valid = Validate(header); !valid) {
    PlaceOf(root, header).Refuse(valid.error());
    return Fail(*tree->error);
  }
  // Of the file alone: a session that a server has may have been taken before this was asked.
  if (const Status near = CheckSensorsApart(header); !near) {
    FarthestNominal(root, header).Refuse(near.error());
    return Fail(*tree->error);
  }
  if (const Status apart = CheckBoardsApart(header); !apart) {
    root.At("targets").Refuse(apart.error());
    return Fail(*tree->error);
  }
  return header;
}

}  // namespace rigcal::formats
