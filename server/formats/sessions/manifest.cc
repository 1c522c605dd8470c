#include <algorithm>

#include "server/base/limits.h"
#include "server/formats/documents.h"
#include "server/formats/json/json_values.h"
#include "server/formats/sessions/manifest_fields.h"
#include "server/formats/sessions/payload_path.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kConditionsMax = 256, kSkipPairsMax = 65'536, kMarkersMax = 10'000;
constexpr int kFormatWithLayouts = 2, kFormatWithMounts = 3, kFormatWithMarkerIds = 4;

JsonKind ManifestKind() {
  return {"manifest", "Push the session again with a client of the server's version.",
          static_cast<std::size_t>(limits::kManifestBytesMax)};
}

void WriteIntrinsics(JsonWriter& out, const Sensor& sensor) {
  if (!sensor.intrinsics) return out.Null("intrinsics");
  const CameraIntrinsics& camera = *sensor.intrinsics;
  out.Object("intrinsics", [&] {
    out.Number("cx_px", camera.cx_px);
    out.Number("cy_px", camera.cy_px);
    out.List("distortion", [&] {
      for (const double k : camera.distortion) out.Number(k);
    });
    out.Number("fx_px", camera.fx_px);
    out.Number("fy_px", camera.fy_px);
    out.Text("model", NameOf(camera.model));
    if (!sensor.intrinsics_sigma) return out.Null("sigma");
    out.List("sigma", [&] {
      for (const double sigma : *sensor.intrinsics_sigma) out.Number(sigma);
    });
  });
}

void WriteLayout(JsonWriter& out, const CloudLayout& layout) {
  out.List("fields", [&] {
    for (const std::string& field : layout.fields) out.Text(field);
  });
  out.Text("point_type", NameOf(layout.type));
}

// A server that knows no layouts would take such clouds for KITTI's, one that knows no mounts such a board to stand
// still, one that knows no ids of markers and no offset of plates would find neither, or something else: it is to
// refuse the session.
int FormatOf(const SessionHeader& header) {
  const auto has_ids = [](const Target& target) { return !target.marker_ids.empty() || target.plate_offset_m; };
  if (std::any_of(header.targets.begin(), header.targets.end(), has_ids)) return kFormatWithMarkerIds;
  const auto is_mounted = [](const Target& target) { return target.mounted_on.has_value(); };
  if (std::any_of(header.targets.begin(), header.targets.end(), is_mounted)) return kFormatWithMounts;
  const auto has_layout = [](const Sensor& sensor) { return sensor.layout.has_value(); };
  return std::any_of(header.sensors.begin(), header.sensors.end(), has_layout) ? kFormatWithLayouts : header.format;
}

void WriteSensor(JsonWriter& out, const Sensor& sensor) {
  out.Object([&] {
    sensor.T_ref_nominal ? WritePose(out, "T_ref_nominal", *sensor.T_ref_nominal) : out.Null("T_ref_nominal");
    if (sensor.clock_sigma_s) out.Number("clock_sigma_s", *sensor.clock_sigma_s);
    if (sensor.layout) WriteLayout(out, *sensor.layout);
    if (!sensor.firmware.empty()) out.Text("firmware", sensor.firmware);
    out.Text("id", sensor.id.str());
    WriteIntrinsics(out, sensor);
    // Only where it says more than the intrinsics and the default: what could be written before keeps its bytes.
    if (!sensor.intrinsics && sensor.camera_model != CameraModel::kPinholeRadtan)
      out.Text("model", NameOf(sensor.camera_model));
    if (sensor.range_bias_sigma_m) out.Number("range_bias_sigma_m", *sensor.range_bias_sigma_m);
    sensor.sees ? out.Text("sees", sensor.sees->str()) : out.Null("sees");
    if (!sensor.serial.empty()) out.Text("serial", sensor.serial);
    out.Text("type", NameOf(sensor.kind));
  });
}

// Members that do not belong to the kind, or were not given, are absent: a checkerboard is written as it always was.
void WriteTarget(JsonWriter& out, const Target& board) {
  const bool charuco = board.kind == TargetKind::kCharuco, grid = IsTagGrid(board.kind);
  const bool circles = IsCircleGrid(board.kind);
  const auto counts = [&] {
    out.Integer(board.cols);
    out.Integer(board.rows);
  };
  out.Object([&] {
    if (circles) out.List("circles", counts);
    if (circles) out.Number("diameter_m", board.diameter_m);
    if (charuco || grid) out.Text("dictionary", board.dictionary);
    out.Text("id", board.id.str());
    if (!board.marker_ids.empty())
      out.List("ids", [&] {
        for (const int id : board.marker_ids) out.Integer(id);
      });
    if (!grid && !circles) out.List("inner_corners", counts);
    if (charuco) out.Flag("legacy_layout", board.legacy_layout);
    if (charuco) out.Number("marker_size_m", board.marker_m);
    if (board.mounted_on) out.Text("mounted_on", board.mounted_on->str());
    if (board.plate_offset_m)
      out.List("plate_offset_m", [&] {
        out.Number(board.plate_offset_m->x());
        out.Number(board.plate_offset_m->y());
      });
    if (board.plate_m)
      out.List("plate_size_m", [&] {
        out.Number(board.plate_m->x());
        out.Number(board.plate_m->y());
      });
    out.Text("serial", board.serial);
    if (grid) out.Number("spacing_ratio", board.spacing_ratio);
    out.Number("square_size_m", board.square_m);
    out.Number("square_size_sigma_m", board.square_sigma_m);
    if (grid) out.List("tags", counts);
    out.Text("type", NameOf(board.kind));
  });
}

void WriteHeader(JsonWriter& out, const SessionHeader& header) {
  out.Text("captured_at", ToIso(header.captured_at));
  out.Object("conditions", [&] {
    for (const auto& [name, value] : header.conditions) out.Text(name, value);
  });
  out.Integer("format", FormatOf(header));
  if (header.lidar_polish != LidarPolish::kNone) out.Text("lidar_polish", NameOf(header.lidar_polish));
  out.Text("operator", header.operator_name);
  out.Text("reference", header.reference.str());
  if (!header.remounted.empty()) WriteIds(out, "remounted", header.remounted);
  out.Text("rig_model", header.rig_model);
  out.Text("robot", header.robot.str());
  out.List("sensors", [&] {
    for (const Sensor& sensor : header.sensors) WriteSensor(out, sensor);
  });
  // As a sensor's optional members: a session that skips nothing keeps its bytes.
  if (!header.skip_pairs.empty())
    out.List("skip_pairs", [&] {
      for (const SensorPair& pair : header.skip_pairs)
        out.List([&] {
          out.Text(pair.a.str());
          out.Text(pair.b.str());
        });
    });
  out.List("targets", [&] {
    for (const Target& board : header.targets) WriteTarget(out, board);
  });
}

void ReadIntrinsics(const JsonField& field, Sensor& sensor) {
  sensor.camera_model = ReadNamed(field.At("model"), CameraModelOf, CameraModel::kPinholeRadtan);
  CameraIntrinsics camera;
  camera.model = sensor.camera_model;
  camera.distortion.assign(DistortionCount(camera.model), 0.0);
  camera.fx_px = field.At("fx_px").Number();
  camera.fy_px = field.At("fy_px").Number();
  camera.cx_px = field.At("cx_px").Number();
  camera.cy_px = field.At("cy_px").Number();
  field.At("distortion").Numbers(camera.distortion.data(), camera.distortion.size());
  sensor.intrinsics = camera;
  if (const auto sigma = field.Find("sigma")) {
    sensor.intrinsics_sigma.emplace(4 + camera.distortion.size());
    sigma->Numbers(sensor.intrinsics_sigma->data(), sensor.intrinsics_sigma->size());
  }
}

CloudLayout ReadLayout(const JsonField& fields, const JsonField& type) {
  constexpr std::size_t kFieldsMax = 64;  // more are refused by Validate, by name
  CloudLayout layout;
  for (const JsonField& name : fields.Items(kFieldsMax)) layout.fields.push_back(name.Text());
  layout.type = ReadNamed(type, PointTypeOf, layout.type);
  return layout;
}

Sensor ReadSensor(const JsonField& field) {
  Sensor sensor;
  sensor.id = ReadId<SensorId>(field.At("id"));
  sensor.kind = ReadNamed(field.At("type"), SensorKindOf, SensorKind::kCamera);
  if (const auto model = field.Find("model"))
    sensor.camera_model = ReadNamed(*model, CameraModelOf, CameraModel::kPinholeRadtan);
  if (const auto intrinsics = field.Find("intrinsics")) ReadIntrinsics(*intrinsics, sensor);
  if (const auto sigma = field.Find("range_bias_sigma_m")) sensor.range_bias_sigma_m = sigma->Number();
  if (const auto sigma = field.Find("clock_sigma_s")) sensor.clock_sigma_s = sigma->Number();
  if (const auto sees = field.Find("sees")) sensor.sees = ReadId<TargetId>(*sees);
  if (const auto fields = field.Find("fields")) sensor.layout = ReadLayout(*fields, field.At("point_type"));
  if (const auto serial = field.Find("serial")) sensor.serial = serial->Text();
  if (const auto firmware = field.Find("firmware")) sensor.firmware = firmware->Text();
  if (const auto T = field.Find("T_ref_nominal")) sensor.T_ref_nominal = ReadPose(*T, kUnitTolerance);
  return sensor;
}

Target ReadTarget(const JsonField& field) {
  Target board;
  board.kind = ReadNamed(field.At("type"), TargetKindOf, TargetKind::kCheckerboard);
  board.id = ReadId<TargetId>(field.At("id"));
  const JsonField counts_field = field.At(IsTagGrid(board.kind)      ? "tags"
                                          : IsCircleGrid(board.kind) ? "circles"
                                                                     : "inner_corners");
  const std::vector<JsonField> counts = counts_field.Items(2);
  if (counts.size() == 2) {
    board.cols = static_cast<int>(counts[0].Integer(1, 10'000));
    board.rows = static_cast<int>(counts[1].Integer(1, 10'000));
  } else {
    counts_field.Refuse("must be two integers: columns and rows");
  }
  board.square_m = field.At("square_size_m").Number();
  board.square_sigma_m = field.At("square_size_sigma_m").Number();
  board.serial = field.At("serial").Text();
  if (IsCircleGrid(board.kind))
    board.diameter_m = field.At("diameter_m").Number();
  else if (board.kind != TargetKind::kCheckerboard)
    board.dictionary = field.At("dictionary").Text();
  if (board.kind == TargetKind::kCharuco) {
    board.marker_m = field.At("marker_size_m").Number();
    board.legacy_layout = field.At("legacy_layout").Flag();
  }
  if (IsTagGrid(board.kind)) board.spacing_ratio = field.At("spacing_ratio").Number();
  if (const auto ids = field.Find("ids"))
    for (const JsonField& id : ids->Items(kMarkersMax))
      board.marker_ids.push_back(static_cast<int>(id.Integer(0, 9999)));
  if (const auto plate = field.Find("plate_size_m")) plate->Numbers(board.plate_m.emplace().data(), 2);
  if (const auto offset = field.Find("plate_offset_m")) offset->Numbers(board.plate_offset_m.emplace().data(), 2);
  if (const auto carrier = field.Find("mounted_on")) board.mounted_on = ReadId<SensorId>(*carrier);
  return board;
}

SensorPair ReadSkipPair(const JsonField& field) {
  const std::vector<JsonField> names = field.Items(2);
  if (names.size() == 2) return {ReadId<SensorId>(names[0]), ReadId<SensorId>(names[1])};
  field.Refuse("must be two names of sensors");
  return {};
}

SessionHeader ReadHeader(const JsonField& root) {
  SessionHeader header;
  const JsonField format = root.At("format");
  const std::int64_t number = format.Integer(1, kFormatWithMarkerIds);
  header.robot = ReadId<RobotId>(root.At("robot"));
  header.rig_model = root.At("rig_model").Text();
  header.captured_at = ReadStamp(root.At("captured_at"));
  header.operator_name = root.At("operator").Text();
  header.reference = ReadId<SensorId>(root.At("reference"));
  for (const JsonField& target : root.At("targets").Items(limits::kTargetsPerSessionMax))
    header.targets.push_back(ReadTarget(target));
  for (const JsonField& sensor : root.At("sensors").Items(limits::kSensorsPerSessionMax))
    header.sensors.push_back(ReadSensor(sensor));
  if (number != FormatOf(header))
    format.Refuse(
        "must be 1, or 2 where a sensor has fields, 3 where a target is mounted on a tracker, 4 where one has ids or "
        "an "
        "offset of its plate");
  if (const auto pairs = root.Find("skip_pairs"))
    for (const JsonField& pair : pairs->Items(kSkipPairsMax)) header.skip_pairs.push_back(ReadSkipPair(pair));
  if (const auto remounted = root.Find("remounted"))
    header.remounted = ReadIds<SensorId>(*remounted, limits::kSensorsPerSessionMax);
  if (const auto polish = root.Find("lidar_polish"))
    header.lidar_polish = ReadNamed(*polish, LidarPolishOf, LidarPolish::kNone);
  for (const auto& [name, value] : root.At("conditions").Members(kConditionsMax))
    header.conditions.emplace(name, value.Text());
  return header;
}

// Sensor and capture are what the path says: two spellings of one fact could disagree.
Payload ReadPayload(const JsonField& field) {
  const JsonField path = field.At("path");
  Payload payload;
  if (Result<Payload> at = PayloadAt(path.Text())) {
    payload = *std::move(at);
  } else {
    path.Refuse(at.error().what);
  }
  payload.digest = ReadId<Digest>(field.At("sha256"));
  payload.size_bytes = field.At("size_bytes").Integer(1, limits::kPayloadBytesMax);
  return payload;
}

}  // namespace

void WriteManifestMembers(JsonWriter& out, const Manifest& manifest) {
  WriteHeader(out, manifest.header);
  out.List("payloads", [&] {
    for (const Payload& payload : manifest.payloads)
      out.Object([&] {
        out.Text("path", payload.path);
        out.Text("sha256", payload.digest.str());
        out.Integer("size_bytes", payload.size_bytes);
      });
  });
}

std::string WriteManifest(const Manifest& manifest) {
  return WriteObject([&](JsonWriter& out) { WriteManifestMembers(out, manifest); });
}

Result<Manifest> ReadManifest(std::string_view text) {
  RIGCAL_ASSIGN(JsonDocument document, JsonDocument::Parse(text, ManifestKind()));
  const JsonField root = document.Root();
  Manifest manifest;
  manifest.header = ReadHeader(root);
  for (const JsonField& payload : root.At("payloads").Items(limits::kPayloadsPerSessionMax))
    manifest.payloads.push_back(ReadPayload(payload));
  RIGCAL_TRY(document.status());
  RIGCAL_TRY(Validate(manifest));
  return manifest;
}

}  // namespace rigcal::formats
