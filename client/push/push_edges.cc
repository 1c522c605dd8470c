#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>

#include "client/push/new_robot.h"
#include "client/push/push_result.h"
#include "client/text/progress.h"
#include "client/text/standing_text.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "client/wire/edge_outlet.h"
#include "server/base/files/durable_file.h"
#include "server/base/process/thread_rank.h"
#include "server/formats/documents.h"
#include "server/formats/edges/g2o.h"
#include "server/formats/rig_files/assumed_edges.h"
#include "server/formats/rig_files/frames.h"
#include "server/model/edges/past.h"
#include "server/model/edges/unit_doubt.h"

namespace rigcal::client {
namespace {

constexpr std::size_t kInFlightMax = 2000;

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
  RIGCAL_ASSIGN(const rig_files::RigFile file, rig_files::ReadRigFile(text, std::filesystem::path(options.file).filename().string()));
  std::vector<rig_files::SensorFrame> sensors;
  for (const std::string& frame : options.frames) {
    RIGCAL_ASSIGN(rig_files::SensorFrame named, rig_files::ParseSensorFrame(frame));
    sensors.push_back(std::move(named));
  }
  if (sensors.empty()) {
    RIGCAL_ASSIGN(sensors, rig_files::AllFrames(file));
  }
  RIGCAL_ASSIGN(std::vector<Edge> edges, rig_files::AssumedEdges(file, robot, sensors, sigma));
  return EdgesOf(robot, std::move(edges), options.shuffle_seed);
}

Result<EdgesToPush> ReadEdges(const PushEdgesOptions& options) {
  RIGCAL_ASSIGN(const RobotId robot, RobotId::Parse(options.robot));
  if (!options.assumed_sigma.empty()) return ReadRig(options, robot);
  RIGCAL_ASSIGN(const std::string text, ReadFile(options.file, limits::kG2oFileBytesMax));
  if (std::filesystem::path(options.file).extension() == ".g2o") {
    RIGCAL_ASSIGN(formats::G2oFile file, formats::ReadG2o(text, robot));
    return EdgesOf(robot, std::move(file.edges), options.shuffle_seed);
  }
  RIGCAL_ASSIGN(std::vector<Edge> edges, formats::ReadEdgeFile(text, robot));
  return EdgesOf(robot, std::move(edges), options.shuffle_seed);
}

Status CheckCount(const EdgesToPush& batch, const PushEdgesOptions& options) {
  if (batch.edges.empty())
    return Fail(ErrorCode::kInvalidInput, options.file + " has no edges", "Give a file with at least one edge");
  if (batch.edges.size() > limits::kEdgesPerBatchMax)
    return Fail(ErrorCode::kInvalidInput,
                options.file + " has more than " + std::to_string(limits::kEdgesPerBatchMax) + " edges",
                "Split the file");
  return {};
}

Result<PushSummary> Send(const Context& context, const PushEdgesOptions& options, const wire::Participant& participant,
                         const EdgesToPush& batch) {
  RIGCAL_ASSIGN(const auto outlet, EdgeOutlet::Open(participant, batch));
  PushPlan plan = BatchPlan(batch.edges.size(), kInFlightMax);
  plan.send_order = batch.send_order;
  plan.give_up_ns = std::llround(options.give_up_s * 1e9);
  PushEngine engine(std::move(plan), SteadyNow_ns());
  Progress progress(context.err, context.err_is_terminal, "Sending", SteadyNow_ns(), Progress::Unit::kEdges);
  const TransferHooks hooks{[&](const PushEngine& state, std::int64_t now_ns) {
                              progress.Skip(state.HeldAtFirst());
                              progress.Show({state.HeldBytes(), state.TotalBytes(), ""}, now_ns);
                            },
                            [&](const std::string& line) { progress.Say(line); }};
  const Status done =
      RunTransfer(participant, {batch.robot, batch.id.str(), WhereText(context.dds)}, engine, *outlet, hooks);
  progress.Clear();
  if (!done) return Fail(done.error());
  PushSummary summary = SummaryOf(engine, "batch", batch.robot.str(), batch.id.str(), batch.edges.size());
  if (summary.held_before == 1) summary.held_before = 0;  // the one that asked the server what it has
  return summary;
}

Result<Awaited> Await(const Context& context, const PushEdgesOptions& options, const EdgesToPush& batch,
                      ResultWatch& watch) {
  AwaitPlace place{batch.robot, SessionId(), {}, 0, WhereText(context.dds), std::llround(options.give_up_s * 1e9)};
  for (const Edge& edge : batch.edges) place.edges.insert(edge.id.str());
  return watch.Await(std::move(place), {{}, [&](const std::string& line) { context.err << line << std::endl; }});
}

// What was retired stays so when it is pushed again.
void SayRetired(const EdgesToPush& batch, const Document& revision, std::ostream& err) {
  std::set<std::string> pushed;
  for (const Edge& edge : batch.edges) pushed.insert(edge.id.str());
  for (const Document& edge : revision["edges"].Items()) {
    const Document why = edge["diagnoses"][0];
    if (why["code"].Text() != kRetiredCode || !pushed.contains(edge["id"].Text())) continue;
    err << Plain("Edge " + edge["id"].Text().substr(0, 16) + ", " + edge["frame_a"].Text("?") + " - " +
                 edge["frame_b"].Text("?") + ", stays retired when it is pushed again: " +
                 Sentence({ErrorCode::kInvalidInput, why["what"].Text(), why["cure"].Text()}))
        << std::endl;
  }
}

bool Names(const EdgesToPush& batch, const std::string& sensor) {
  return std::any_of(batch.edges.begin(), batch.edges.end(), [&](const Edge& edge) {
    return edge.frame_a.str() == sensor || edge.frame_b.str() == sensor;
  });
}

Status RunPushEdges(Context& context, const PushEdgesOptions& options) {
  SetThreadRank(ThreadRank::kWorks);  // the robot has more urgent work than this
  RIGCAL_ASSIGN(const EdgesToPush batch, ReadEdges(options));
  RIGCAL_TRY(CheckCount(batch, options));
  SayUnitDoubt(options.file, UnitDoubt(batch.edges), context.err);
  RIGCAL_ASSIGN(const auto participant, wire::Participant::Open(context.dds));
  RIGCAL_ASSIGN(auto watch, ResultWatch::Open(participant, context.dds, batch.robot));
  if (!options.new_robot) RIGCAL_TRY(CheckNewRobot(watch.connection(), batch.robot, context.timeout));
  RIGCAL_ASSIGN(const PushSummary summary, Send(context, options, participant, batch));
  context.err << summary.items << " edges of " << summary.robot << " are stored";
  if (summary.held_before > 0) context.err << " (" << summary.held_before << " were there before)";
  context.err << std::endl;
  if (options.no_wait) {
    if (context.json) context.out << ResultJson(summary, nullptr) << std::endl;
    return {};
  }
  RIGCAL_ASSIGN(const Awaited awaited, Await(context, options, batch, watch));
  if (context.json)
    context.out << ResultJson(summary, &awaited) << std::endl;
  else
    PrintResult(awaited, context.out);
  SayRetired(batch, awaited.show["document"], context.err);
  SayRetiredSensors(batch.robot.str(), awaited.show["document"]["retired_sensors"],
                    [&](const std::string& sensor) { return Names(batch, sensor); }, context.err);
  context.exit_code = JudgeResult(awaited);
  return {};
}

}  // namespace

void AddPushEdges(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("push-edges", "Send finished pairwise results, wait for the new calibration");
  auto options = std::make_shared<PushEdgesOptions>();
  verb->add_option("FILE", options->file, "JSON (docs/edges-format.md), or a pose graph by the suffix .g2o")
      ->required();
  CLI::Option* assumed = verb->add_option("--assumed-sigma", options->assumed_sigma,
                                          "FILE is a URDF, tf2, Autoware or Kalibr file, and each pose of it is this sure, 1 sigma per axis");
  assumed->type_name("MM,DEG");
  verb->add_option("--frame", options->frames, "With it: a sensor, and the frame of FILE that is its; the first is what others are measured from")
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
               "  rigcal push-edges robot.urdf --robot mapper-01 --assumed-sigma 5,0.5 --frame left --frame top=top_lidar_link\n");
  verb->callback([&context, options] {
    if (const Status done = RunPushEdges(context, *options); !done) context.exit_code = Report(done.error(), context);
  });
}

}  // namespace rigcal::client
