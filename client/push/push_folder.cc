#include "client/push/push_folder.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <random>

#include "client/push/new_robot.h"
#include "client/push/push_result.h"
#include "client/text/edge_table.h"
#include "client/text/progress.h"
#include "client/text/standing_text.h"
#include "client/text/table.h"
#include "client/wire/session_outlet.h"
#include "server/base/process/thread_rank.h"
#include "server/formats/sessions/session_contents.h"
#include "server/formats/sessions/session_folder.h"
#include "server/model/edges/past.h"
#include "server/model/edges/unit_doubt.h"

namespace rigcal::client {
namespace {

struct Folder {
  SessionToPush session;
  FileMarks marks;
};

// As if session.yaml had named them.
Status TakeRemounted(const std::vector<std::string>& names, SessionHeader& header) {
  for (const std::string& name : names) {
    RIGCAL_ASSIGN(SensorId sensor, SensorId::Parse(name));
    rigcal::AddRemounted(std::move(sensor), header);
  }
  return Validate(header);
}

Result<Folder> ReadFolder(const Context& context, const PushOptions& options) {
  Folder folder;
  folder.marks = MarkFiles(options.folder);
  Progress progress(context.err, context.err_is_terminal, "Reading", SteadyNow_ns());
  auto manifest = formats::ReadSessionFolder(options.folder, [&](std::int64_t done, std::int64_t total) {
    progress.Show({done, total, ""}, SteadyNow_ns());
  });
  progress.Clear();
  if (!manifest) return Fail(manifest.error());
  RIGCAL_TRY(TakeRemounted(options.remounted, manifest->header));
  const auto trackers = formats::ReadTrackers(options.folder, *manifest);
  for (const auto& [file, doubt] : UnitDoubts(manifest->header, trackers)) SayUnitDoubt(file, doubt, context.err);
  folder.session = SessionOf(*manifest);
  return folder;
}

// A capture is there when its files of all sensors are.
std::string CaptureText(const PushEngine& engine, const std::vector<Payload>& payloads) {
  std::map<std::string, bool> captures;
  for (std::uint32_t i = 0; i < payloads.size(); ++i) {
    const auto [entry, is_new] = captures.emplace(payloads[i].capture.str(), engine.chunks().held()[i]);
    if (!is_new) entry->second = entry->second && engine.chunks().held()[i];
  }
  std::size_t held = 0;
  for (const auto& [name, is_held] : captures) held += is_held ? 1 : 0;
  return std::to_string(held) + "/" + std::to_string(captures.size()) + " captures";
}

// File by file, in a drawn order.
std::vector<std::uint32_t> ShuffledChunks(const PushPlan& plan, std::uint64_t seed) {
  std::vector<std::vector<std::uint32_t>> chunks_of_file;
  std::uint32_t count = 0;
  for (const std::int64_t size_bytes : plan.payload_bytes) {
    chunks_of_file.emplace_back(static_cast<std::size_t>((size_bytes + plan.chunk_bytes - 1) / plan.chunk_bytes));
    std::iota(chunks_of_file.back().begin(), chunks_of_file.back().end(), count);
    count += static_cast<std::uint32_t>(chunks_of_file.back().size());
  }
  std::shuffle(chunks_of_file.begin(), chunks_of_file.end(), std::mt19937_64(seed));
  std::vector<std::uint32_t> order;
  for (const auto& chunks : chunks_of_file) order.insert(order.end(), chunks.begin(), chunks.end());
  return order;
}

PushPlan PlanOf(const SessionToPush& session, const PushOptions& options) {
  PushPlan plan;
  for (const Payload& payload : session.payloads) plan.payload_bytes.push_back(payload.size_bytes);
  if (options.shuffle_seed) plan.send_order = ShuffledChunks(plan, *options.shuffle_seed);
  plan.give_up_ns = std::llround(options.give_up_s * 1e9);
  return plan;
}

Result<PushSummary> Send(const Context& context, const PushOptions& options, const wire::Participant& participant,
                         const Folder& folder) {
  const SessionToPush& session = folder.session;
  RIGCAL_ASSIGN(const auto outlet,
                SessionOutlet::Open(participant, session, FilePieces(options.folder, session.payloads, folder.marks)));
  PushEngine engine(PlanOf(session, options), SteadyNow_ns());
  Progress progress(context.err, context.err_is_terminal, "Sending", SteadyNow_ns());
  std::size_t counted = 0;
  std::string detail = CaptureText(engine, session.payloads);
  const TransferHooks hooks{[&](const PushEngine& state, std::int64_t now_ns) {
                              const PushCounts& counts = state.chunks().counts();
                              if (counts.payloads_held != counted && progress.IsDue(now_ns)) {
                                counted = counts.payloads_held;
                                detail = CaptureText(state, session.payloads);
                              }
                              progress.Skip(counts.held_at_first_bytes);
                              progress.Show({state.chunks().ArrivedBytes(), counts.total_bytes, detail}, now_ns);
                            },
                            [&](const std::string& line) { progress.Say(line); }};
  const std::int64_t start_ns = SteadyNow_ns();
  const Status done =
      RunTransfer(participant, {session.robot, session.id.str(), WhereText(context.dds)}, engine, *outlet, hooks);
  progress.Clear();
  if (!done) return Fail(done.error());
  PushSummary summary = SummaryOf(engine, "session", session.robot.str(), session.id.str(), session.payloads.size());
  summary.transfer_ns = SteadyNow_ns() - start_ns;
  return summary;
}

void SaySent(const Context& context, const PushSummary& summary) {
  context.err << "Session " << summary.id.substr(0, 16) << " of " << summary.robot << " is stored: " << summary.items
              << " files, " << ByteText(static_cast<double>(summary.total));
  if (summary.held_before > 0)
    context.err << " (" << ByteText(static_cast<double>(summary.held_before)) << " were there before)";
  context.err << std::endl;
}

Result<Awaited> Await(const Context& context, const PushOptions& options, const SessionToPush& session,
                      ResultWatch& watch) {
  Progress progress(context.err, context.err_is_terminal, "Calibrating", SteadyNow_ns(), Progress::Unit::kPairs);
  std::optional<std::int64_t> done_before;
  const AwaitHooks hooks{[&](const Document& edge) {
                           progress.Clear();
                           (context.json ? context.err : context.out) << EdgeLine(edge) << std::endl;
                         },
                         [&](const std::string& line) { progress.Say(line); },
                         [&](std::int64_t done, std::int64_t total) {
                           if (!done_before) progress.Skip(*(done_before = done));
                           progress.Show({done, total, ""}, SteadyNow_ns());
                         }};
  auto awaited = watch.Await(
      {session.robot, session.id, {}, 0, WhereText(context.dds), std::llround(options.give_up_s * 1e9)}, hooks);
  progress.Clear();
  return awaited;
}

// Who says that the name is right is told whose the files are, too: one option answers both.
Status CheckMeant(const Context& context, const SessionToPush& session, Connection& connection) {
  const Status name = CheckNewRobot(connection, session.robot, context.timeout),
               files = CheckWhoseFiles(connection, session.robot, session.payloads, context.timeout);
  if (name || files) return name ? files : name;
  return Fail(ErrorCode::kConflict, name.error().what + "; also, " + files.error().what, files.error().cure);
}

}  // namespace

Status PushFolder(Context& context, const PushOptions& options) {
  SetThreadRank(ThreadRank::kWorks);  // the robot has more urgent work than this
  RIGCAL_ASSIGN(const Folder folder, ReadFolder(context, options));
  RIGCAL_ASSIGN(const auto participant, wire::Participant::Open(context.dds));
  RIGCAL_ASSIGN(auto watch, ResultWatch::Open(participant, context.dds, folder.session.robot));
  if (!options.new_robot) RIGCAL_TRY(CheckMeant(context, folder.session, watch.connection()));
  RIGCAL_ASSIGN(const PushSummary summary, Send(context, options, participant, folder));
  SaySent(context, summary);
  if (options.no_wait) {
    if (context.json) context.out << ResultJson(summary, nullptr) << std::endl;
    return {};
  }
  RIGCAL_ASSIGN(const Awaited awaited, Await(context, options, folder.session, watch));
  if (context.json)
    context.out << ResultJson(summary, &awaited) << std::endl;
  else
    PrintResult(awaited, context.out);
  SayStanding(awaited.session, context.err);
  SayRetiredSensors(
      folder.session.robot.str(), awaited.retired_sensors, [](const std::string&) { return true; }, context.err);
  context.exit_code = JudgeResult(awaited);
  return {};
}

}  // namespace rigcal::client
