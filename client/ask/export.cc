#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "client/exchange/calibration_query.h"
#include "client/exchange/graph_export.h"
#include "client/positive.h"
#include "client/text/pose_text.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "server/base/files/durable_file.h"
#include "server/formats/export/formats.h"
#include "server/formats/json/json_writer.h"
#include "server/formats/rig_files/frames.h"
#include "server/formats/rig_files/urdf_patch.h"

namespace rigcal::client {
namespace {

constexpr std::string_view kGraphFormat = "g2o";

struct ExportOptions {
  std::string robot, out, format, root, into;
  std::vector<std::string> frames;
  int revision = 0;
  bool even_if_not_approved = false;
};

struct ExportedFiles {
  std::vector<exports::TextFile> files;               // with whole names
  std::vector<std::string> left_out;                  // of the calibration and the format
  std::vector<rig_files::OriginChange> changes = {};  // of an existing robot
};

Result<CalibrationQuery> QueryOf(const ExportOptions& options) {
  CalibrationQuery query{options.robot, options.revision, {}, options.even_if_not_approved};
  if (!options.root.empty()) {
    RIGCAL_ASSIGN(query.root, SensorId::Parse(options.root));
  }
  RIGCAL_ASSIGN(query.frames, FramesOf(options.frames));
  return query;
}

Result<const exports::Format*> FormatWanted(const ExportOptions& options) {
  RIGCAL_ASSIGN(const exports::Format* format,
                options.format.empty() ? exports::FormatOfFile(options.out) : exports::FormatCalled(options.format));
  if (!options.into.empty() && format->name != "urdf")
    return Fail(ErrorCode::kInvalidInput,
                "--into changes an existing URDF, not a file of format " + std::string(format->name),
                "Give --format urdf, or leave --into away.");
  return format;
}

Result<ExportedFiles> Patched(const exports::Calibration& calibration, const ExportOptions& options) {
  RIGCAL_ASSIGN(const std::string existing, ReadFile(options.into, rig_files::kRigFileBytesMax));
  rig_files::LinkPoses links{calibration.root_frame(), {}};
  for (const exports::ExportedSensor& sensor : calibration.sensors)
    links.poses.emplace(sensor.frame, sensor.T_root_sensor);
  RIGCAL_ASSIGN(rig_files::PatchedUrdf patched, rig_files::PatchUrdf(existing, options.into, links));
  return ExportedFiles{
      {{options.out, std::move(patched.text)}}, std::move(patched.left_out), std::move(patched.changes)};
}

Result<ExportedFiles> WrittenAs(const exports::Format& format, const exports::Calibration& calibration,
                                const ExportOptions& options) {
  RIGCAL_ASSIGN(exports::Written written, format.write(calibration));
  for (exports::TextFile& file : written.files)
    file.name = file.name.empty() ? options.out : (std::filesystem::path(options.out) / file.name).string();
  return ExportedFiles{std::move(written.files), std::move(written.left_out)};
}

Status WriteAll(const exports::Format& format, const ExportedFiles& exported, const std::string& out) {
  std::error_code failed;
  if (format.is_folder) std::filesystem::create_directories(out, failed);
  if (failed)
    return Fail(ErrorCode::kStorage, "the folder " + out + " cannot be made: " + failed.message(),
                "Check its place and the rights.");
  for (const exports::TextFile& file : exported.files) RIGCAL_TRY(WriteDurably(file.name, file.text));
  return {};
}

void WriteChange(formats::JsonWriter& out, const rig_files::OriginChange& change) {
  out.Object([&] {
    out.Text("joint", change.joint);
    out.Text("frame", change.link);
    out.Integer("line", static_cast<std::int64_t>(change.line));
    out.Number("moved_m", change.moved_m);
    out.Number("turned_rad", change.turned_rad);
  });
}

std::string ExportJson(const exports::Calibration& calibration, const exports::Format& format,
                       const ExportedFiles& exported) {
  return formats::WriteObject([&](formats::JsonWriter& out) {
    out.Text("robot", calibration.robot.str());
    out.Integer("revision", calibration.revision);
    out.Text("standing", calibration.standing);
    out.Text("format", format.name);
    out.Text("root", calibration.root.str());
    out.Integer("sensors", static_cast<std::int64_t>(calibration.sensors.size()));
    out.List("files", [&] {
      for (const exports::TextFile& file : exported.files) out.Text(file.name);
    });
    out.List("left_out", [&] {
      for (const std::string& sentence : exported.left_out) out.Text(sentence);
    });
    out.List("changes", [&] {
      for (const rig_files::OriginChange& change : exported.changes) WriteChange(out, change);
    });
  });
}

// As `diff -u` shows it, with how far the frame went.
void PrintChange(const rig_files::OriginChange& change, std::ostream& out) {
  out << "@@ line " << change.line << ", joint " << Plain(change.joint) << ": " << Plain(change.link) << " moved "
      << Fixed(change.moved_m * kMmPerM, 3) << " mm, turned " << Fixed(change.turned_rad * kDegPerRad, 4) << " deg\n";
  if (!change.before.empty()) out << "-  " << Plain(change.before) << '\n';
  out << "+  " << Plain(change.after) << '\n';
}

void PrintFiles(const exports::Calibration& calibration, const ExportedFiles& exported, bool patched,
                std::ostream& out) {
  for (const rig_files::OriginChange& change : exported.changes) PrintChange(change, out);
  if (patched && exported.changes.empty()) out << "nothing changes: the file has this calibration\n";
  for (const exports::TextFile& file : exported.files) out << file.name << '\n';
  out << calibration.sensors.size() << " sensors of revision " << calibration.revision << " (" << calibration.standing
      << "), root " << calibration.root_frame() << '\n';
}

Status ExportCalibration(const Context& context, const ExportOptions& options) {
  RIGCAL_ASSIGN(const exports::Format* format, FormatWanted(options));
  RIGCAL_ASSIGN(const CalibrationQuery query, QueryOf(options));
  RIGCAL_ASSIGN(const AskedCalibration asked, AskCalibration(context, query));
  const exports::Calibration& calibration = asked.calibration;
  RIGCAL_ASSIGN(ExportedFiles exported,
                options.into.empty() ? WrittenAs(*format, calibration, options) : Patched(calibration, options));
  exported.left_out.insert(exported.left_out.begin(), calibration.left_out.begin(), calibration.left_out.end());
  RIGCAL_TRY(WriteAll(*format, exported, options.out));
  if (!asked.doubt.empty()) context.err << Plain(asked.doubt) << std::endl;
  for (const std::string& sentence : exported.left_out) context.err << "left out: " << Plain(sentence) << std::endl;
  if (context.json)
    context.out << ExportJson(calibration, *format, exported) << std::endl;
  else
    PrintFiles(calibration, exported, !options.into.empty(), context.out);
  return {};
}

ExitCode RunExport(const Context& context, const ExportOptions& options) {
  const bool by_suffix = options.format.empty() && std::filesystem::path(options.out).extension() == ".g2o";
  if (options.format != kGraphFormat && !by_suffix) {
    const Status done = ExportCalibration(context, options);
    return done ? ExitCode::kGood : Report(done.error(), context);
  }
  if (options.root.empty() && options.into.empty() && options.frames.empty())
    return ExportGraph(context, {options.robot, options.out, options.revision});
  return Report({ErrorCode::kInvalidInput, "a g2o file has the whole graph, with names and frames as they are",
                 "Leave --root, --into and --frame away."},
                context);
}

std::string FormatLines() {
  std::string lines = "Formats (conventions: docs/export.md):\n";
  const auto add = [&](std::string_view name, std::string_view what) {
    lines += "  " + std::string(name) + std::string(13 - std::min<std::size_t>(name.size(), 12), ' ') +
             std::string(what) + "\n";
  };
  for (const exports::Format& format : exports::Formats()) add(format.name, format.what);
  add(kGraphFormat, "the graph: good edges with their information, solved poses; read back by push-edges");
  return lines;
}

}  // namespace

void AddExport(CLI::App& app, Context& context) {
  CLI::App* verb =
      app.add_subcommand("export", "Write a robot's calibration, or its graph, into files for other programs");
  auto options = std::make_shared<ExportOptions>();
  verb->add_option("ROBOT", options->robot, "The robot's id")->required();
  verb->add_option("--format", options->format,
                   "See below; without it the suffix says: .g2o .urdf .tf.yaml .launch.xml .json .csv")
      ->type_name("NAME");
  verb->add_option("--out", options->out, "The file, or the folder of formats with several")
      ->required()
      ->type_name("FILE");
  verb->add_option("--root", options->root, "The sensor in whose frame poses are (default: the robot's reference)")
      ->type_name("SENSOR");
  verb->add_option("--into", options->into,
                   "An existing URDF: origins of joints above sensors change, no other byte; the changes are shown")
      ->type_name("FILE");
  verb->add_option("--frame", options->frames, "Another name of a sensor's frame in the file; may be repeated")
      ->type_name("SENSOR=FRAME");
  verb->add_option("--revision", options->revision,
                   "A numbered revision (default: the one that is in use; of g2o the newest)")
      ->check(Positive())
      ->type_name("N");
  verb->add_flag("--even-if-not-approved", options->even_if_not_approved,
                 "Also what failed, is unknown or waits for an approval; the file says so");
  verb->footer(FormatLines() +
               "What a file leaves out (a sensor of which a direction was not measured, a camera without intrinsics) "
               "is said, and in its comments.\n"
               "Examples:\n"
               "  rigcal export mapper-01 --out mapper-01.urdf\n"
               "  rigcal export mapper-01 --out new.urdf --into robot.urdf --root lidar\n"
               "  rigcal export mapper-01 --format camera_info --out camera_info/\n"
               "  rigcal export mapper-01 --format autoware --out sensor_kit_calibration.yaml --frame "
               "top=velodyne_top\n"
               "  rigcal export mapper-01 --revision 3 --out before.g2o\n");
  verb->callback([&context, options] { context.exit_code = RunExport(context, *options); });
}

}  // namespace rigcal::client
