#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>

#include "client/exchange/calibration_query.h"
#include "client/exchange/comparison.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "server/base/files/durable_file.h"
#include "server/formats/rig_files/frames.h"

namespace rigcal::client {
namespace {

struct DiffOptions {
  std::string file, robot, root;
  std::vector<std::string> frames, without;
  int revision = 0;
  double sigmas_max = 0.0;
};

using FramesBySensor = std::map<SensorId, std::string>;

const std::string& FrameOf(const FramesBySensor& frames, const SensorId& sensor) {
  const auto named = frames.find(sensor);
  return named == frames.end() ? sensor.str() : named->second;
}

bool HasFrame(const rig_files::RigFile& file, const std::string& frame) {
  return std::any_of(file.poses.begin(), file.poses.end(),
                     [&](const rig_files::FramePose& pose) { return pose.frame == frame || pose.parent == frame; });
}

// The reference, where the file has it; else the first sensor that it has.
Result<SensorId> RootIn(const rig_files::RigFile& file, const exports::Calibration& calibration,
                        const FramesBySensor& frames) {
  for (const exports::ExportedSensor& sensor : calibration.sensors)
    if (HasFrame(file, FrameOf(frames, sensor.sensor))) return sensor.sensor;
  return Fail(ErrorCode::kNotFound, "the file has no frame with the name of a sensor of " + calibration.robot.str(),
              "Name them with --frame SENSOR=FRAME. Frames in the file: " + rig_files::FramesText(file) + ".");
}

KnownPoses PosesOfCalibration(const exports::Calibration& calibration) {
  KnownPoses poses;
  for (const exports::ExportedSensor& sensor : calibration.sensors)
    poses[sensor.sensor.str()] = {sensor.T_root_sensor,
                                  Vector6d(sensor.covariance.diagonal().cwiseMax(0.0).cwiseSqrt())};
  return poses;
}

std::string WhyNoPose(const rig_files::RigFile& file, const std::string& frame, const std::string& root_frame,
                      const std::string& name) {
  if (!HasFrame(file, frame)) return "is not in " + name;
  return "is in " + name + ", but nothing fixed ties it to " + rig_files::Shown(root_frame);
}

std::size_t OtherFrames(const rig_files::RigFile& file, const exports::Calibration& calibration,
                        const FramesBySensor& frames) {
  std::set<std::string> others;
  for (const rig_files::FramePose& pose : file.poses) others.insert({pose.parent, pose.frame});
  for (const exports::ExportedSensor& sensor : calibration.sensors) others.erase(FrameOf(frames, sensor.sensor));
  for (const auto& [sensor, why] : calibration.without_pose) others.erase(FrameOf(frames, sensor));
  return others.size();
}

// --without, as often as it is given: sensors of the calibration.
Result<std::set<SensorId>> Waived(const exports::Calibration& calibration, const std::vector<std::string>& names) {
  std::set<SensorId> waived;
  for (const std::string& name : names) {
    RIGCAL_ASSIGN(const SensorId sensor, SensorId::Parse(name));
    if (calibration.Find(sensor) == nullptr && !calibration.without_pose.contains(sensor))
      return Fail(ErrorCode::kNotFound,
                  "'" + name + "', which --without names, is no sensor of " + calibration.robot.str(),
                  "`rigcal show " + calibration.robot.str() + "` lists them.");
    waived.insert(sensor);
  }
  return waived;
}

Result<Comparison> ComparedWithFile(const exports::Calibration& calibration, const rig_files::RigFile& file,
                                    const DiffOptions& options, const FramesBySensor& frames) {
  RIGCAL_ASSIGN(const auto in_file, rig_files::PosesIn(file, FrameOf(frames, calibration.root)));
  RIGCAL_ASSIGN(const std::set<SensorId> waived, Waived(calibration, options.without));
  Comparison comparison{calibration.robot.str(), calibration.root.str(), options.file, calibration.revision, {}};
  KnownPoses others;
  const auto leave_out = [&](const SensorId& sensor, const std::string& why) {
    if (waived.contains(sensor))
      comparison.waived.push_back(sensor.str());
    else
      comparison.not_compared.push_back({sensor.str(), why});
  };
  for (const exports::ExportedSensor& sensor : calibration.sensors) {
    const std::string& frame = FrameOf(frames, sensor.sensor);
    const auto pose = in_file.find(frame);
    if (pose == in_file.end())
      leave_out(sensor.sensor, WhyNoPose(file, frame, FrameOf(frames, calibration.root), options.file));
    else
      others[sensor.sensor.str()] = {pose->second, std::nullopt};
  }
  for (const auto& [sensor, why] : calibration.without_pose)
    leave_out(sensor, "has no pose in revision " + std::to_string(calibration.revision) + ": " + why);
  RIGCAL_ASSIGN(comparison.differences, ComparePoses(PosesOfCalibration(calibration), others, comparison.reference));
  comparison.cure =
      "Name the frames that the file has of them with --frame SENSOR=FRAME, and with --without SENSOR those that need "
      "not be compared.";
  comparison.other_frames = OtherFrames(file, calibration, frames);
  return comparison;
}

// A sensor whose frame somebody named is to be compared.
Status CheckNamed(const rig_files::RigFile& file, const FramesBySensor& frames) {
  for (const auto& [sensor, frame] : frames)
    if (!HasFrame(file, frame))
      return Fail(ErrorCode::kNotFound,
                  "the file has no frame '" + rig_files::Shown(frame) + "', which --frame names for " + sensor.str(),
                  "Frames in the file: " + rig_files::FramesText(file) + ".");
  return {};
}

// What is compared is not used to drive by: so nobody has to have approved it.
Result<AskedCalibration> AskToCompare(const Context& context, const DiffOptions& options,
                                      const rig_files::RigFile& file, const FramesBySensor& frames) {
  CalibrationQuery query{options.robot, options.revision, {}, true};
  query.frames = frames;
  if (!options.root.empty()) {
    RIGCAL_ASSIGN(query.root, SensorId::Parse(options.root));
    return AskCalibration(context, query);
  }
  RIGCAL_ASSIGN(AskedCalibration asked, AskCalibration(context, query));
  RIGCAL_ASSIGN(const SensorId root, RootIn(file, asked.calibration, frames));
  if (root == asked.calibration.root) return asked;
  query.root = root;
  query.revision = asked.calibration.revision;
  return AskCalibration(context, query);
}

Result<ExitCode> Diff(const Context& context, const DiffOptions& options) {
  RIGCAL_ASSIGN(const std::string text, ReadFile(options.file, rig_files::kRigFileBytesMax));
  RIGCAL_ASSIGN(const rig_files::RigFile file,
                rig_files::ReadRigFile(text, std::filesystem::path(options.file).filename().string()));
  RIGCAL_ASSIGN(FramesBySensor frames, FramesOf(options.frames));
  for (auto& [sensor, frame] : frames) frame = rig_files::FrameAsRead(file, frame);
  RIGCAL_TRY(CheckNamed(file, frames));
  RIGCAL_ASSIGN(const AskedCalibration asked, AskToCompare(context, options, file, frames));
  RIGCAL_ASSIGN(const Comparison comparison, ComparedWithFile(asked.calibration, file, options, frames));
  if (!asked.doubt.empty()) context.err << Plain(asked.doubt) << std::endl;
  if (context.json)
    context.out << ComparisonJson(comparison) << std::endl;
  else
    PrintComparison(comparison, context.out);
  return JudgeComparison(comparison, options.sigmas_max);
}

}  // namespace

void AddDiff(CLI::App& app, Context& context) {
  CLI::App* verb =
      app.add_subcommand("diff", "Compare a URDF, tf2, Autoware or Kalibr file with a robot's calibration");
  auto options = std::make_shared<DiffOptions>();
  verb->add_option("FILE", options->file,
                   "URDF, YAML of static transforms, sensor_kit_calibration.yaml or camchain.yaml")
      ->required();
  verb->add_option("ROBOT", options->robot, "The robot's id")->required();
  verb->add_option(
          "--root", options->root,
          "The sensor at which both are laid together (default: the reference, or the first that the file has)")
      ->type_name("SENSOR");
  verb->add_option("--frame", options->frames,
                   "The name of a sensor's frame in the file, where it is another; may be repeated")
      ->type_name("SENSOR=FRAME");
  verb->add_option("--without", options->without, "A sensor that the file need not have; may be repeated")
      ->type_name("SENSOR");
  verb->add_option("--revision", options->revision,
                   "A numbered revision (default: the one that is in use, else the newest)")
      ->type_name("N")
      ->check(CLI::PositiveNumber);
  verb->add_option("--sigmas-max", options->sigmas_max,
                   "Exit with 1 if any axis is off by more of its sigmas, 6 if a sigma is not known")
      ->type_name("K")
      ->check(CLI::PositiveNumber);
  verb->footer(
      "moved and turned: from where the file has the sensor to where the calibration has it; sigma is the "
      "calibration's. Exits with 6 where a sensor of the robot was not compared.\n"
      "Examples:\n"
      "  rigcal diff robot.urdf mapper-01\n"
      "  rigcal diff camchain.yaml mapper-01 --frame left=cam0 --frame right=cam1 --json\n");
  verb->callback([&context, options] {
    const auto done = Diff(context, *options);
    context.exit_code = done ? *done : Report(done.error(), context);
  });
}

}  // namespace rigcal::client
