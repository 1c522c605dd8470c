#include "client/push/push_batch.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "client/push/new_robot.h"
#include "client/push/push_result.h"
#include "client/text/progress.h"
#include "client/text/standing_text.h"
#include "client/text/table.h"
#include "server/model/edges/past.h"
#include "server/model/edges/unit_doubt.h"

namespace rigcal::client {
namespace {

constexpr std::size_t kInFlightMax = 2000;

Status CheckCount(const EdgesToPush& batch, const BatchOptions& options) {
  if (batch.edges.empty())
    return Fail(ErrorCode::kInvalidInput, options.origin + " has no edges", "Give a file with at least one edge");
  if (batch.edges.size() > limits::kEdgesPerBatchMax)
    return Fail(ErrorCode::kInvalidInput,
                options.origin + " has more than " + std::to_string(limits::kEdgesPerBatchMax) + " edges",
                "Split the file");
  return {};
}

Result<PushSummary> Send(const Context& context, const BatchOptions& options, const wire::Participant& participant,
                         const EdgesToPush& batch) {
  RIGCAL_ASSIGN(const auto outlet, EdgeOutlet::Open(participant, batch));
  PushPlan plan = BatchPlan(batch.edges.size(), kInFlightMax);
  plan.send_order = batch.send_order;
  plan.give_up_ns = std::llround(options.give_up_s * 1e9);
  PushEngine engine(std::move(plan), SteadyNow_ns());
  Progress progress(context.err, context.err_is_terminal, "Sending", SteadyNow_ns(), Progress::Unit::kEdges);
  const TransferHooks hooks{[&](const PushEngine& state, std::int64_t now_ns) {
                              const PushCounts& counts = state.chunks().counts();
                              progress.Skip(counts.held_at_first_bytes);
                              progress.Show({counts.held_bytes, counts.total_bytes, ""}, now_ns);
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

Result<Awaited> Await(const Context& context, const BatchOptions& options, const EdgesToPush& batch,
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
  return std::any_of(batch.edges.begin(), batch.edges.end(),
                     [&](const Edge& edge) { return edge.frame_a.str() == sensor || edge.frame_b.str() == sensor; });
}

}  // namespace

Status PushBatch(Context& context, const BatchOptions& options, const EdgesToPush& batch) {
  RIGCAL_TRY(CheckCount(batch, options));
  SayUnitDoubt(options.origin, UnitDoubt(batch.edges), context.err);
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
  SayRetiredSensors(
      batch.robot.str(), awaited.show["document"]["retired_sensors"],
      [&](const std::string& sensor) { return Names(batch, sensor); }, context.err);
  context.exit_code = JudgeResult(awaited);
  return {};
}

}  // namespace rigcal::client
