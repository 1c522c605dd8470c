#include "client/sim/truth.h"

#include <cmath>

#include "client/sim/visit/yaml_text.h"
#include "server/formats/yaml/yaml_field.h"

namespace rigcal::sim {
namespace {

using formats::YamlField;

constexpr std::size_t kTruthBytesMax = 64 << 20;
constexpr const char* kUnknown = "unknown";

std::string BoundText(const BoundSigma& bound) {
  std::string text;
  for (const std::optional<double>& sigma : bound)
    text += (text.empty() ? "" : ", ") + (sigma ? Text(*sigma) : kUnknown);
  return "[" + text + "]";
}

std::string SensorText(const SensorId& id, const SensorTruth& sensor) {
  std::string text = "  " + id.str() + ":\n    type: " + NameOf(sensor.kind) +
                     "\n    T_ref_sensor: " + Text(sensor.T_ref_sensor) + "\n";
  if (sensor.T_ref_bumped) text += "    T_ref_bumped: " + Text(*sensor.T_ref_bumped) + "\n";
  if (sensor.intrinsics) text += "    intrinsics: " + Text(*sensor.intrinsics, nullptr) + "\n";
  if (sensor.bound) text += "    bound_sigma: " + BoundText(*sensor.bound) + "\n";
  return text;
}

Se3 ReadPose(const YamlField& field) {
  Se3 T;
  field.At("p_m").Numbers(T.p_m.data(), 3);
  field.At("q_xyzw").Numbers(T.q.coeffs().data(), 4);
  if (!(std::abs(T.q.norm() - 1) < 1e-6)) field.Refuse("q_xyzw must have unit length");
  return T;
}

CameraIntrinsics ReadIntrinsics(const YamlField& field) {
  CameraIntrinsics camera;
  const YamlField model = field.At("model");
  if (const auto known = CameraModelOf(model.Text()))
    camera.model = *known;
  else
    model.Refuse(known.error());
  camera.fx_px = field.At("fx_px").Number();
  camera.fy_px = field.At("fy_px").Number();
  camera.cx_px = field.At("cx_px").Number();
  camera.cy_px = field.At("cy_px").Number();
  camera.distortion.assign(DistortionCount(camera.model), 0.0);
  field.At("distortion").Numbers(camera.distortion.data(), camera.distortion.size());
  return camera;
}

BoundSigma ReadBound(const YamlField& field) {
  BoundSigma bound;
  const std::vector<YamlField> items = field.Items();
  if (items.size() != bound.size()) field.Refuse("must be six numbers");
  for (std::size_t i = 0; i < std::min(items.size(), bound.size()); ++i)
    if (items[i].Text() != kUnknown) bound[i] = items[i].Number();
  return bound;
}

SensorTruth ReadSensor(const YamlField& field) {
  SensorTruth sensor;
  const YamlField type = field.At("type");
  if (const auto kind = SensorKindOf(type.Text()))
    sensor.kind = *kind;
  else
    type.Refuse(kind.error());
  sensor.T_ref_sensor = ReadPose(field.At("T_ref_sensor"));
  if (const auto T = field.Find("T_ref_bumped")) sensor.T_ref_bumped = ReadPose(*T);
  if (const auto intrinsics = field.Find("intrinsics")) sensor.intrinsics = ReadIntrinsics(*intrinsics);
  if (const auto bound = field.Find("bound_sigma")) sensor.bound = ReadBound(*bound);
  return sensor;
}

Truth ReadTree(const YamlField& root) {
  Truth truth;
  truth.rig = root.At("rig").Text();
  truth.seed = static_cast<std::uint64_t>(root.At("seed").Integer(0, INT64_MAX));
  truth.reference = SensorId(root.At("reference").Text());
  truth.bumped_from_idx = static_cast<std::size_t>(root.At("bumped_from_idx").Integer(0, 1'000'000));
  for (const YamlField& sensor : root.At("sensors").Members())
    truth.sensors[SensorId(sensor.Key())] = ReadSensor(sensor.Called("sensor '" + sensor.Key() + "'"));
  for (const YamlField& board : root.At("boards").Members())
    truth.boards[TargetId(board.Key())] = {board.At("square_size_m").Number(), ReadPose(board.At("T_world_board"))};
  if (const auto disturbances = root.Find("disturbances"))
    for (const YamlField& one : disturbances->Members()) truth.disturbances[one.Key()] = one.Text();
  for (const YamlField& capture : root.At("captures").Items())
    truth.captures.push_back({CaptureId(capture.At("capture").Text()), ReadPose(capture.At("T_world_ref"))});
  return truth;
}

std::string By(const Displacement& by) { return Text(1e3 * by.m) + " mm and " + Text(by.rad * 180 / M_PI) + " deg"; }

void DescribeCaptures(const Experiment& experiment, std::map<std::string, std::string>& words) {
  const auto of = [&](const SensorId& sensor, std::size_t capture_idx) {
    return sensor.str() + ", capture " + experiment.captures[capture_idx].str();
  };
  if (const auto& board = experiment.moved_board)
    words["board_moved"] = board->board.str() + " by " + By(experiment.options.disturb.board_move->by) +
                           " from capture " + experiment.captures[board->from_idx].str() + " on";
  if (const auto& at = experiment.wrong_instant) words["wrong_instant"] = of(at->sensor, at->capture_idx);
  if (const auto& at = experiment.refocused)
    words["refocus"] = at->sensor.str() + " by " + Text(at->by_ratio) + " from capture " +
                       experiment.captures[at->from_idx].str() + " on";
  if (const auto& at = experiment.shifted)
    words["shift_capture"] = of(at->sensor, at->capture_idx) + " by " + Text(Eigen::VectorXd(at->shift_px)) + " px";
}

void DescribeMounts(const Experiment& experiment, std::map<std::string, std::string>& words) {
  const Disturbances& disturb = experiment.options.disturb;
  const auto at = [&](double ratio) { return std::to_string(experiment.IndexAt(ratio)); };
  if (disturb.excursion)
    words["excursion"] = experiment.displaced->str() + " by " + By(disturb.excursion->by) + " from index " +
                         at(disturb.excursion->from_ratio) + " until before " + at(disturb.excursion->until_ratio);
  if (disturb.creep)
    words["creep"] =
        experiment.displaced->str() + " by " + By(disturb.creep->by) + " from the first capture to the last";
  if (disturb.rattle.m > 0 || disturb.rattle.rad > 0)
    words["rattle"] = By(disturb.rattle) + " per axis, every sensor at every capture";
  if (disturb.pose_drift.m > 0 || disturb.pose_drift.rad > 0)
    words["pose_drift"] = By(disturb.pose_drift) + " per axis and capture, every tracker";
}

std::map<std::string, std::string> DisturbancesOf(const Experiment& experiment) {
  const Disturbances& disturb = experiment.options.disturb;
  std::map<std::string, std::string> words;
  if (disturb.lens_misfit_px > 0) words["lens_misfit"] = Text(disturb.lens_misfit_px) + " px rms, every camera";
  if (disturb.visit_scatter.m > 0 || disturb.visit_scatter.rad > 0)
    words["visit_scatter"] = By(disturb.visit_scatter) + " per axis";
  if (disturb.board_bend_m > 0) words["board_bend"] = Text(1e3 * disturb.board_bend_m) + " mm, every board";
  if (disturb.board_stretch_ratio > 0)
    words["board_stretch"] = Text(disturb.board_stretch_ratio) + " along the columns of every board";
  if (disturb.mixed_pixels_ratio > 0) words["mixed_pixels"] = Text(disturb.mixed_pixels_ratio) + " of edge beams";
  if (disturb.incidence_bias_m > 0)
    words["incidence_bias"] = Text(1e3 * disturb.incidence_bias_m) + " mm at 60 deg of incidence";
  if (disturb.sway_per_s.m > 0 || disturb.sway_per_s.rad > 0)
    words["sway"] = By(disturb.sway_per_s) + " per second at captures, rms";
  if (disturb.pose_clock_late_s != 0)
    words["pose_clock_offset"] = Text(1e3 * disturb.pose_clock_late_s) + " ms late, every tracker";
  if (disturb.burst > 1) words["bursts"] = std::to_string(disturb.burst) + " captures from nearly one place";
  DescribeMounts(experiment, words);
  DescribeCaptures(experiment, words);
  return words;
}

}  // namespace

Truth TruthOf(const Experiment& experiment) {
  const Rig& rig = experiment.rig;
  Truth truth{rig.name, experiment.options.seed,   rig.reference, experiment.bumped_from_idx, {}, {},
              {},       DisturbancesOf(experiment)};
  const Se3 T_ref_body = rig.SensorOf(rig.reference).T_body_sensor.Inverse();
  for (const RigSensor& sensor : rig.sensors) {
    SensorTruth& entry = truth.sensors[sensor.id];
    entry.kind = sensor.kind;
    entry.T_ref_sensor = experiment.T_ref_sensor(sensor.id);
    if (const auto bumped = experiment.T_body_bumped.find(sensor.id); bumped != experiment.T_body_bumped.end())
      entry.T_ref_bumped = (T_ref_body * bumped->second).Normalized();
    if (sensor.kind == SensorKind::kCamera) entry.intrinsics = sensor.camera.intrinsics;
  }
  for (const RigBoard& board : rig.boards)
    truth.boards[board.target.id] = {board.target.square_m, board.T_world_board().Normalized()};
  for (std::size_t k = 0; k < experiment.captures.size(); ++k)
    truth.captures.push_back({experiment.captures[k],
                              (experiment.T_world_body[k] * rig.SensorOf(rig.reference).T_body_sensor).Normalized()});
  return truth;
}

std::string WriteTruth(const Truth& truth) {
  std::string text =
      "# What was true. T_ref_sensor: pose of the sensor in the reference; p_ref = T_ref_sensor * p_sensor. World: the "
      "tracker's.\n"
      "# bound_sigma: x y z rx ry rz of the sensor (m, rad), the Cramer-Rao bound of all boards, clouds and tracker "
      "poses.\n"
      "format: 1\nrig: " +
      truth.rig + "\nseed: " + std::to_string(truth.seed) + "\nreference: " + truth.reference.str() +
      "\nbumped_from_idx: " + std::to_string(truth.bumped_from_idx) + "\nsensors:\n";
  for (const auto& [id, sensor] : truth.sensors) text += SensorText(id, sensor);
  text += "boards:\n";
  for (const auto& [id, board] : truth.boards)
    text += "  " + id.str() + ": {square_size_m: " + Text(board.square_m) +
            ", T_world_board: " + Text(board.T_world_board) + "}\n";
  if (!truth.disturbances.empty()) text += "disturbances:\n";
  for (const auto& [option, words] : truth.disturbances) text += "  " + option + ": \"" + words + "\"\n";
  text += "captures:\n";
  for (const CaptureTruth& capture : truth.captures)
    text += "  - {capture: \"" + capture.capture.str() + "\", T_world_ref: " + Text(capture.T_world_ref) + "}\n";
  return text;
}

Result<Truth> ReadTruth(std::string_view text, const std::string& name) {
  RIGCAL_ASSIGN(const std::unique_ptr<formats::YamlTree> tree,
                formats::ParseYaml(text, name, "Simulate again.", kTruthBytesMax));
  Truth truth = ReadTree(YamlField(*tree));
  if (tree->error) return Fail(*tree->error);
  return truth;
}

}  // namespace rigcal::sim
