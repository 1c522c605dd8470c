#include "client/sim/rig/rig_yaml.h"

#include <cmath>
#include <fstream>
#include <sstream>

#include "client/sim/rig/facing.h"
#include "rigs.h"
#include "server/formats/sessions/target_yaml.h"

namespace rigcal::sim {
namespace {

using formats::YamlField;

constexpr const char* kRigCure = "Mend the file; `rigcal simulate --print-rig mars-mapper` prints a complete one.";
constexpr std::size_t kRigBytesMax = 1 << 20;
constexpr double kRadPerDeg = M_PI / 180;

template <typename IdType>
IdType ReadId(const YamlField& field, const std::string& text) {
  auto id = IdType::Parse(text);
  if (id) return *std::move(id);
  field.Refuse(id.error().what, id.error().cure);
  return IdType();
}

Eigen::Vector3d Triple(const YamlField& field) {
  Eigen::Vector3d values = Eigen::Vector3d::Zero();
  field.Numbers(values.data(), 3);
  return values;
}

double NumberIn(const YamlField& map, std::string_view key, double otherwise, double min, double max) {
  const auto field = map.Find(key);
  if (!field) return otherwise;
  const double value = field->Number();
  if (!(value >= min && value <= max)) field->Refuse("is out of range");
  return value;
}

// `rpy_deg` turns a frame with x ahead, y left, z up; of a camera or a plate it turns the direction of view.
Se3 ReadPose(const YamlField& field, bool looks) {
  field.AllowOnly({"p_m", "rpy_deg"});
  const Eigen::Vector3d p_m = Triple(field.At("p_m")), rpy_rad = Triple(field.At("rpy_deg")) * kRadPerDeg;
  return looks ? Looking(p_m, rpy_rad) : Turned(p_m, rpy_rad);
}

Room ReadRoom(const YamlField& field) {
  field.AllowOnly({"size_m", "patches_per_wall", "boxes"});
  Room room;
  room.size_m = Triple(field.At("size_m"));
  if (!(room.size_m.minCoeff() > 0.5 && room.size_m.maxCoeff() < 1000)) field.Refuse("size_m is out of range");
  if (const auto patches = field.Find("patches_per_wall"))
    room.patches_per_wall = static_cast<int>(patches->Integer(0, 1000));
  const auto boxes = field.Find("boxes");
  if (!boxes) return room;
  for (const YamlField& box : boxes->Members()) {
    box.AllowOnly({"centre_m", "size_m", "yaw_deg", "colour"});
    room.boxes.push_back({Triple(box.At("centre_m")), Triple(box.At("size_m")),
                          NumberIn(box, "yaw_deg", 0, -360, 360) * kRadPerDeg, Triple(box.At("colour"))});
    if (!(room.boxes.back().size_m.minCoeff() > 0)) box.Refuse("size_m must be positive");
  }
  return room;
}

RigBoard ReadBoard(const YamlField& field) {
  RigBoard board;
  board.target = formats::ReadTarget(field, {.otherwise = TargetKind::kCheckerboard, .beside = {"T_world_plate"}});
  static_cast<void>(field.At("plate_size_m"));
  board.T_world_plate = ReadPose(field.At("T_world_plate"), true);
  return board;
}

void ReadLens(const YamlField& field, CameraTruth& camera) {
  field.AllowOnly({"model", "fx_px", "fy_px", "cx_px", "cy_px", "distortion"});
  CameraIntrinsics& lens = camera.intrinsics;
  if (const auto model = field.Find("model")) {
    const auto known = CameraModelOf(model->Text());
    if (known)
      lens.model = *known;
    else
      model->Refuse(known.error());
  }
  lens.distortion.assign(DistortionCount(lens.model), 0.0);
  lens.fx_px = field.At("fx_px").Number();
  lens.fy_px = field.At("fy_px").Number();
  lens.cx_px = field.At("cx_px").Number();
  lens.cy_px = field.At("cy_px").Number();
  if (const auto k = field.Find("distortion")) k->Numbers(lens.distortion.data(), lens.distortion.size());
  if (const std::string why = WhyNoSphere(lens); !why.empty()) field.Refuse("distortion: " + why);
}

// Members of `camera`, which all cameras share, or of one camera.
void ReadCamera(const YamlField& field, CameraTruth& camera) {
  if (const auto size = field.Find("size_px")) {
    double size_px[2] = {0, 0};
    size->Numbers(size_px, 2);
    camera.width_px = static_cast<int>(size_px[0]);
    camera.height_px = static_cast<int>(size_px[1]);
  }
  camera.blur_px = NumberIn(field, "blur_px", camera.blur_px, 0.3, 10);
  camera.noise_grey = NumberIn(field, "noise_grey", camera.noise_grey, 0, 100);
  camera.vignetting_ratio = NumberIn(field, "vignetting_ratio", camera.vignetting_ratio, 0, 1);
  camera.corner_sigma_px = NumberIn(field, "corner_sigma_px", camera.corner_sigma_px, 1e-6, 10);
  if (const auto lens = field.Find("lens")) ReadLens(*lens, camera);
  if (const auto sigma = field.Find("intrinsics_sigma")) {
    camera.intrinsics_sigma.resize(4 + camera.intrinsics.distortion.size());
    sigma->Numbers(camera.intrinsics_sigma.data(), camera.intrinsics_sigma.size());
  }
}

void ReadLidar(const YamlField& field, LidarTruth& lidar) {
  if (const auto table = field.Find("elevations_deg")) {
    lidar.elevations_rad.clear();
    for (const YamlField& item : table->Items()) lidar.elevations_rad.push_back(item.Number() * kRadPerDeg);
  }
  lidar.firings_per_turn = static_cast<int>(NumberIn(field, "firings_per_turn", lidar.firings_per_turn, 4, 100'000));
  lidar.range_sigma_m = NumberIn(field, "range_sigma_m", lidar.range_sigma_m, 1e-6, 1);
  lidar.range_min_m = NumberIn(field, "range_min_m", lidar.range_min_m, 0, 100);
  lidar.range_max_m = NumberIn(field, "range_max_m", lidar.range_max_m, 0.1, 1000);
}

void ReadTracker(const YamlField& field, TrackerTruth& tracker) {
  tracker.sigma_m = NumberIn(field, "sigma_m", tracker.sigma_m, 1e-7, 1);
  tracker.sigma_rad = NumberIn(field, "sigma_deg", tracker.sigma_rad / kRadPerDeg, 1e-6, 10) * kRadPerDeg;
}

struct Shared {
  CameraTruth camera;
  LidarTruth lidar;
  TrackerTruth tracker;
};

Shared ReadShared(const YamlField& root) {
  Shared shared;
  if (const auto camera = root.Find("camera")) {
    camera->AllowOnly({"size_px", "blur_px", "noise_grey", "vignetting_ratio", "corner_sigma_px", "intrinsics_sigma"});
    ReadCamera(*camera, shared.camera);
  }
  if (const auto lidar = root.Find("lidar")) {
    lidar->AllowOnly({"elevations_deg", "firings_per_turn", "range_sigma_m", "range_min_m", "range_max_m"});
    ReadLidar(*lidar, shared.lidar);
  }
  if (const auto tracker = root.Find("tracker")) {
    tracker->AllowOnly({"sigma_m", "sigma_deg"});
    ReadTracker(*tracker, shared.tracker);
  }
  return shared;
}

RigSensor ReadSensor(const YamlField& field, const Shared& shared) {
  RigSensor sensor{
      ReadId<SensorId>(field, field.Key()), SensorKind::kCamera, {}, {}, shared.camera, shared.lidar, shared.tracker};
  const YamlField type = field.At("type");
  if (const auto kind = SensorKindOf(type.Text()); kind && *kind != SensorKind::kPoseStream)
    sensor.kind = *kind;
  else
    type.Refuse("must be camera, lidar or tracker");
  const bool is_camera = sensor.kind == SensorKind::kCamera;
  sensor.T_body_sensor = ReadPose(field.At("T_body_sensor"), is_camera);
  if (const auto sees = field.Find("sees")) sensor.sees = ReadId<TargetId>(*sees, sees->Text());
  if (is_camera) {
    field.AllowOnly({"type", "sees", "T_body_sensor", "size_px", "blur_px", "noise_grey", "vignetting_ratio",
                     "corner_sigma_px", "intrinsics_sigma", "lens"});
    ReadCamera(field, sensor.camera);
    if (sensor.camera.width_px < 16 || sensor.camera.height_px < 16 || !(sensor.camera.intrinsics.fx_px > 1) ||
        !(sensor.camera.intrinsics.fy_px > 1))
      field.Refuse("a camera needs size_px and a lens");
    sensor.camera.intrinsics_sigma.resize(4 + sensor.camera.intrinsics.distortion.size(), 0.0);
  } else if (sensor.kind == SensorKind::kLidar) {
    field.AllowOnly({"type", "sees", "T_body_sensor", "elevations_deg", "firings_per_turn", "range_sigma_m",
                     "range_min_m", "range_max_m"});
    ReadLidar(field, sensor.lidar);
    if (sensor.lidar.elevations_rad.empty()) field.Refuse("a lidar needs elevations_deg");
  } else {
    field.AllowOnly({"type", "T_body_sensor", "sigma_m", "sigma_deg"});
    ReadTracker(field, sensor.tracker);
  }
  return sensor;
}

MotionPlan ReadMotion(const YamlField& field) {
  field.AllowOnly({"captures", "start_m", "position_range_m", "yaw_range_deg", "tilt_rms_deg"});
  MotionPlan motion;
  motion.captures = static_cast<int>(field.At("captures").Integer(1, 10'000));
  motion.T_world_body_start.p_m = Triple(field.At("start_m"));
  motion.position_range_m = Triple(field.At("position_range_m"));
  motion.yaw_range_rad = NumberIn(field, "yaw_range_deg", 0, 0, 180) * kRadPerDeg;
  motion.tilt_rms_rad = NumberIn(field, "tilt_rms_deg", 0, 0, 45) * kRadPerDeg;
  return motion;
}

void ReadPairs(const YamlField& root, Rig& rig) {
  const auto pairs = root.Find("skip_pairs");
  if (!pairs) return;
  for (const YamlField& pair : pairs->Items()) {
    const std::vector<YamlField> names = pair.Items();
    if (names.size() != 2) return pair.Refuse("must be two sensors, [a, b]");
    rig.skip_pairs.push_back(
        {ReadId<SensorId>(names[0], names[0].Text()), ReadId<SensorId>(names[1], names[1].Text())});
  }
}

Rig ReadTree(const YamlField& root) {
  root.AllowOnly({"format", "name", "robot", "reference", "nominal_sigma_m", "nominal_sigma_deg", "motion", "room",
                  "boards", "camera", "lidar", "tracker", "sensors", "skip_pairs"});
  Rig rig;
  static_cast<void>(root.At("format").Integer(1, 1));
  rig.name = root.At("name").Text();
  rig.robot = ReadId<RobotId>(root.At("robot"), root.At("robot").Text());
  rig.reference = ReadId<SensorId>(root.At("reference"), root.At("reference").Text());
  rig.nominal_sigma_m = NumberIn(root, "nominal_sigma_m", rig.nominal_sigma_m, 0, 1);
  rig.nominal_sigma_rad = NumberIn(root, "nominal_sigma_deg", rig.nominal_sigma_rad / kRadPerDeg, 0, 45) * kRadPerDeg;
  rig.motion = ReadMotion(root.At("motion"));
  rig.room = ReadRoom(root.At("room"));
  for (const YamlField& board : root.At("boards").Members())
    rig.boards.push_back(ReadBoard(board.Called("board '" + board.Key() + "'")));
  const Shared shared = ReadShared(root);
  for (const YamlField& sensor : root.At("sensors").Members())
    rig.sensors.push_back(ReadSensor(sensor.Called("sensor '" + sensor.Key() + "'"), shared));
  ReadPairs(root, rig);
  return rig;
}

}  // namespace

Result<Rig> ReadRig(std::string_view text, const std::string& name) {
  RIGCAL_ASSIGN(const std::unique_ptr<formats::YamlTree> tree, formats::ParseYaml(text, name, kRigCure, kRigBytesMax));
  Rig rig = ReadTree(YamlField(*tree));
  if (tree->error) return Fail(*tree->error);
  if (const Status valid = Validate(rig); !valid)
    return Fail(valid.error().code, name + ": " + valid.error().what, valid.error().cure);
  return rig;
}

std::vector<std::string> BuiltInRigs() { return {"mars-mapper", "eye-to-hand-cell"}; }

Result<std::string> BuiltInRig(const std::string& name) {
  if (name == "mars-mapper") return std::string(kmars_mapper_yaml);
  if (name == "eye-to-hand-cell") return std::string(keye_to_hand_cell_yaml);
  return Fail(ErrorCode::kNotFound, "there is no built-in rig '" + name + "'",
              "mars-mapper and eye-to-hand-cell are built in.");
}

Result<Rig> LoadRig(const std::string& name_or_path) {
  if (const auto built_in = BuiltInRig(name_or_path)) return ReadRig(*built_in, name_or_path);
  std::ifstream file(name_or_path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  if (!file)
    return Fail(ErrorCode::kNotFound, "rig " + name_or_path + ": neither a built-in rig nor a readable file",
                "Name a YAML file, or mars-mapper or eye-to-hand-cell, which are built in.");
  return ReadRig(text.str(), name_or_path);
}

}  // namespace rigcal::sim
