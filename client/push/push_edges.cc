#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "client/push/new_robot.h"
#include "client/push/push_batch.h"
#include "client/verbs.h"
#include "server/base/files/durable_file.h"
#include "server/base/process/thread_rank.h"
#include "server/formats/documents.h"
#include "server/formats/edges/g2o.h"
#include "server/formats/rig_files/assumed_edges.h"
#include "server/formats/rig_files/frames.h"

namespace rigcal::client {
namespace {

struct PushEdgesOptions {
  std::string file, robot;
  std::optional<std::uint64_t> shuffle_seed;
  double give_up_s = 60.0;
  bool no_wait = false, new_robot = false;
  std::string assumed_sigma;        // of a rig file: "MM,DEG"; empty: the file has edges
  std::vector<std::string> frames;  // likewise: SENSOR or SENSOR=FRAME
};

// What a drawing or another tool says of where sensors are, as edges from the first of them.
Result<EdgesToPush> ReadRig(const PushEdgesOptions& options, const RobotId& robot) {
  RIGCAL_ASSIGN(const rig_files::AssumedSigma sigma, rig_files::ParseAssumedSigma(options.assumed_sigma));
  RIGCAL_ASSIGN(const std::string text, ReadFile(options.file, rig_files::kRigFileBytesMax));
  RIGCAL_ASSIGN(const rig_files::RigFile file,
                rig_files::ReadRigFile(text, std::filesystem::path(options.file).filename().string()));
  std::vector<rig_files::SensorFrame> sensors;
  for (const std::string& frame : options.frames) {
    RIGCAL_ASSIGN(rig_files::SensorFrame named, rig_files::ParseSensorFrame(frame));
    named.frame = rig_files::FrameAsRead(file, named.frame);
    sensors.push_back(std::move(named));
  }
  if (sensors.empty()) {
    RIGCAL_ASSIGN(sensors, rig_files::AllFrames(file));
  }
  RIGCAL_ASSIGN(std::vector<Edge> edges, rig_files::AssumedEdges(file, robot, sensors, sigma));
  return EdgesOf(robot, std::move(edges), options.shuffle_seed);
}

// Which file it was: a script may push several.
Error InFile(const std::string& file, Error error) {
  error.what = file + ": " + error.what;
  return error;
}

Result<EdgesToPush> ReadEdges(const PushEdgesOptions& options) {
  RIGCAL_ASSIGN(const RobotId robot, RobotId::Parse(options.robot));
  if (!options.assumed_sigma.empty()) return ReadRig(options, robot);
  RIGCAL_ASSIGN(const std::string text, ReadFile(options.file, limits::kG2oFileBytesMax));
  if (std::filesystem::path(options.file).extension() == ".g2o") {
    auto file = formats::ReadG2o(text, robot);
    if (!file) return Fail(InFile(options.file, file.error()));
    return EdgesOf(robot, std::move(file->edges), options.shuffle_seed);
  }
  auto edges = formats::ReadEdgeFile(text, robot);
  if (!edges) return Fail(InFile(options.file, edges.error()));
  return EdgesOf(robot, std::move(*edges), options.shuffle_seed);
}

Status RunPushEdges(Context& context, const PushEdgesOptions& options) {
  SetThreadRank(ThreadRank::kWorks);  // the robot has more urgent work than this
  RIGCAL_ASSIGN(const EdgesToPush batch, ReadEdges(options));
  return PushBatch(context, {options.file, options.give_up_s, options.no_wait, options.new_robot}, batch);
}

}  // namespace

void AddPushEdges(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("push-edges", "Send finished pairwise results, wait for the new calibration");
  auto options = std::make_shared<PushEdgesOptions>();
  verb->add_option("FILE", options->file, "JSON (docs/edges-format.md), or a pose graph by the suffix .g2o")
      ->required();
  CLI::Option* assumed = verb->add_option(
      "--assumed-sigma", options->assumed_sigma,
      "FILE is a URDF, tf2, Autoware or Kalibr file, and each pose of it is this sure, 1 sigma per axis");
  assumed->type_name("MM,DEG");
  verb->add_option("--frame", options->frames,
                   "With it: a sensor, and the frame of FILE that is its; the first is what others are measured from")
      ->needs(assumed)
      ->type_name("SENSOR=FRAME");
  verb->add_option("--robot", options->robot, "The robot whose edges they are")->required()->type_name("ID");
  verb->add_flag("--new-robot", options->new_robot, kNewRobotHelp);
  verb->add_flag("--no-wait", options->no_wait, "End when all is safe on the server's disk");
  verb->add_option("--shuffle", options->shuffle_seed, "Send in an order drawn from this seed; the result is the same")
      ->type_name("SEED");
  verb->add_option("--timeout-total", options->give_up_s,
                   "Give up after so many seconds without any answer (default 60)")
      ->check(CLI::Range(0.1, 1e7))
      ->type_name("S");
  verb->footer("Pushing the same edges again changes nothing.\n" + std::string(kVerdictCodes) +
               "With --no-wait 0, once all is safe.\n"
               "Examples:\n"
               "  rigcal push-edges results.json --robot mapper-01\n"
               "  rigcal push-edges graph.g2o --robot bench-garage --no-wait\n"
               "  rigcal push-edges robot.urdf --robot mapper-01 --assumed-sigma 5,0.5 --frame left --frame "
               "top=top_lidar_link\n");
  verb->callback([&context, options] {
    if (const Status done = RunPushEdges(context, *options); !done) context.exit_code = Report(done.error(), context);
  });
}

}  // namespace rigcal::client
