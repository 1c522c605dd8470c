#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <csignal>
#include <map>
#include <memory>
#include <utility>

#include "client/positive.h"
#include "client/text/approval_text.h"
#include "client/text/edge_table.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "server/base/stamp.h"

namespace rigcal::client {
namespace {

using SteadyClock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kTick(200);  // how long Ctrl-C may go unnoticed
constexpr milliseconds kHintAfter(2000);

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");
void OnInterrupt(int) { interrupted = true; }

struct WatchOptions {
  std::string robot;
  int count = 0;
};

std::string DoneText(const Document& data) {
  const std::int64_t all = data["jobs_total"].Integer().value_or(0),
                     waiting = data["jobs_waiting"].Integer().value_or(0);
  return std::to_string(all - waiting) + " of " + std::to_string(all) + " pairs done";
}

std::string VerdictAndKeep(const Document& data) {
  const std::string keep = FallbackText(data["verdict"], data);
  return VerdictText(data["verdict"], data) + (keep.empty() ? "" : " " + keep);
}

std::string TextOf(const std::string& kind, const Document& data) {
  if (kind == "edge") {
    const Document edge = data["edge"].IsNull() ? data : data["edge"];
    return EdgeLine(edge) + (data["jobs_total"].IsNull() ? "" : "  (" + DoneText(data) + ")");
  }
  if (kind == "session_closed")
    return "session " + data["session"].Text("?").substr(0, 16) + " came whole: " + CountOf(data["payloads"]) +
           " files, " + CountOf(data["jobs_total"]) + " pairs of sensors to calibrate";
  if (kind == "graph_update")
    return CountOf(data["sensors_known"]) + " of " + CountOf(data["sensors"]) + " sensors known, " +
           CountOf(data["edges"]) + " edges (provisional)";
  if (kind == "revision") return "revision " + CountOf(data["revision"]) + ", " + VerdictAndKeep(data);
  if (kind == "decision") return DecidedText(data);
  if (kind == "published") return "report of revision " + CountOf(data["revision"]) + " at " + data["path"].Text("?");
  return data.Dump();
}

// For people: to the second, in UTC.
std::string TimeText(std::int64_t stamp_ns) {
  std::string text = ToIso({stamp_ns}).substr(0, 19);
  text[10] = ' ';
  return text;
}

// How many sensors each robot knows. The graph is announced with every edge; people are told when this changes.
using KnownSensors = std::map<std::string, std::string>;

bool IsOldNews(const rigcal_wire_Event& event, const Document& data, KnownSensors& known) {
  if (std::string(event.kind) != "graph_update") return false;
  const std::string now = CountOf(data["sensors_known"]) + "/" + CountOf(data["sensors"]);
  return std::exchange(known[event.robot_id], now) == now;
}

// False if there was nothing worth a line.
bool PrintWatch(const Context& context, const rigcal_wire_Event& event, KnownSensors& known) {
  const auto data = Document::Parse(event.json ? event.json : "{}", "the event");
  const std::string robot = event.robot_id, kind = event.kind;
  if (context.json) {
    context.out << JsonObject({Field::Raw("data", data ? data->Dump() : "null"),
                               {"kind", kind},
                               {"robot", robot},
                               {"sequence_number", static_cast<std::int64_t>(event.sequence_number)},
                               {"stamp", ToIso({event.stamp_ns})},
                               {"subject_id", event.subject_id}})
                << std::endl;
    return true;
  }
  if (data && IsOldNews(event, *data, known)) return false;
  const std::string text = data ? TextOf(kind, *data) : "(not readable)";
  context.out << TimeText(event.stamp_ns) << "  " << Plain(robot) << "  " << Plain(kind) << "  " << Plain(text)
              << std::endl;
  return true;
}

Status WatchLoop(const Context& context, const WatchOptions& options) {
  RIGCAL_ASSIGN(const auto participant, wire::Participant::Open(context.dds));
  const std::string partition = options.robot.empty() ? wire::kAllRobotsPartition : "robot/" + options.robot;
  RIGCAL_ASSIGN(auto events, wire::Reader<rigcal_wire_Event>::Open(participant, {partition}));
  RIGCAL_ASSIGN(auto waitset, wire::WaitSet::Open(participant));
  RIGCAL_TRY(waitset.Attach(events.get()));
  RIGCAL_ASSIGN(auto one_server, OneServer::Open(participant, WhereText(context.dds)));
  const auto start = SteadyClock::now();
  const auto is_over = [&] { return context.timeout_is_given && SteadyClock::now() - start >= context.timeout; };
  bool hinted = false;
  int seen = 0;
  KnownSensors known;
  const auto is_enough = [&] { return options.count > 0 && seen >= options.count; };
  while (!interrupted && !is_over() && !is_enough()) {
    RIGCAL_TRY(waitset.Wait(kTick));
    RIGCAL_TRY(one_server.CheckOften());
    if (!hinted && seen == 0 && events.MatchedWriters() == 0 && SteadyClock::now() - start > kHintAfter) {
      context.err << "Nothing is announced yet on " << WhereText(context.dds) << "; waiting (Ctrl-C ends). "
                  << "`rigcal doctor` tells whether a server is there." << std::endl;
      hinted = true;
    }
    RIGCAL_TRY(events.Take(256, [&](const rigcal_wire_Event& event, const wire::SampleOrigin&) {
      if (is_enough()) return;
      if (PrintWatch(context, event, known)) ++seen;
    }));
  }
  return {};
}

ExitCode RunWatch(const Context& context, const WatchOptions& options) {
  struct sigaction action {};
  action.sa_handler = OnInterrupt;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  if (!options.robot.empty())
    if (const auto robot = RobotId::Parse(options.robot); !robot) return Report(robot.error(), context);
  const Status done = WatchLoop(context, options);
  return done ? ExitCode::kGood : Report(done.error(), context);
}

}  // namespace

void AddWatch(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("watch", "Print what happens as it happens, until Ctrl-C");
  auto options = std::make_shared<WatchOptions>();
  verb->add_option("ROBOT", options->robot, "Only this robot");
  verb->add_option("--count", options->count, "End after so many events")->check(Positive())->type_name("N");
  verb->footer(
      "Times are UTC. With --json: one JSON object a line, every event. --timeout S ends after S seconds.\n"
      "Examples:\n"
      "  rigcal watch\n"
      "  rigcal watch mapper-01 --count 10\n"
      "  rigcal watch mapper-01 --timeout 60 --json\n");
  verb->callback([&context, options] { context.exit_code = RunWatch(context, *options); });
}

}  // namespace rigcal::client
