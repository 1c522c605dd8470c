#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>

#include "client/ask/checks.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "client/wire/transfer.h"
#include "server/base/stamp.h"
#include "server/base/version.h"

namespace rigcal::client {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kDiscoverWithin(2000);
constexpr int kRoundTrips = 5;

struct Findings {
  std::vector<Check> checks;
  bool has_server = false;
};

std::optional<std::int64_t> FreeHere() {
  std::error_code error;
  const auto space = std::filesystem::space(".", error);
  if (error) return std::nullopt;
  return static_cast<std::int64_t>(space.available);
}

// One answer of `health`, and when it was here.
struct Health {
  Document document;
  std::int64_t round_trip_ns = 0, offset_ns = 0;
  bool has_time = false;
};

Result<Health> AskHealth(Connection& connection, milliseconds timeout) {
  Health health;
  const Stamp wall = SystemClock().Now();
  const std::int64_t start_ns = SteadyNow_ns();
  RIGCAL_ASSIGN(health.document, connection.AskDocument("health", "{}", timeout));
  health.round_trip_ns = SteadyNow_ns() - start_ns;
  const auto server_now = ParseIso(health.document["now"].Text());
  health.has_time = server_now.has_value();
  if (server_now) health.offset_ns = server_now->ns - (wall.ns + health.round_trip_ns / 2);
  return health;
}

void CheckAnswers(const std::vector<Health>& answers, std::vector<Check>& checks) {
  std::vector<Health> sorted = answers;
  std::sort(sorted.begin(), sorted.end(),
            [](const Health& x, const Health& y) { return x.round_trip_ns < y.round_trip_ns; });
  const Health& fastest = sorted.front();
  const Document& document = fastest.document;
  checks.push_back(JudgeRoundTrip(sorted[sorted.size() / 2].round_trip_ns));
  checks.push_back(JudgeVersions(std::string(Version()), kWireProtocol, document["version"].Text("?"),
                                 document["protocol"].Integer()));
  if (fastest.has_time) checks.push_back(JudgeClock(fastest.offset_ns, fastest.round_trip_ns));
  checks.push_back(JudgeDisk("disk of server", document["disk_free_bytes"].Integer()));
  const Document lost = document["lost_files"];
  std::vector<std::string> names;
  for (const Document& file : lost["first"].Items())
    names.push_back(Plain(file["robot"].Text() + " " + file["path"].Text() + " (" + file["state"].Text() +
                          ", session " + file["session"].Text().substr(0, 16) + ")"));
  if (!lost.IsNull()) checks.push_back(JudgeLostFiles(lost["count"].Integer().value_or(0), names));
  const Document problem = document["problem"];
  if (!problem.IsNull())
    checks.push_back({"server", CheckLevel::kFail, Plain(problem["what"].Text()), Plain(problem["cure"].Text())});
}

Check JudgeIdentity(const DdsIdentity& identity) {
  constexpr std::int64_t kSoon_ns = 30LL * 86'400'000'000'000;
  const std::string text = TextOf(identity) + ", good until " + ToIso(identity.not_after);
  if (identity.not_after.ns - SystemClock().Now().ns > kSoon_ns) return {"identity", CheckLevel::kOk, text, ""};
  return {"identity", CheckLevel::kWarn, text, "Make the next one: `rigcal identity new ... --renew`"};
}

Status CheckServer(const Context& context, Findings& findings) {
  RIGCAL_ASSIGN(const auto participant, wire::Participant::Open(context.dds));
  findings.checks.push_back({"dds", CheckLevel::kOk, "takes part in " + WhereText(context.dds), ""});
  if (participant.identity() != nullptr) findings.checks.push_back(JudgeIdentity(*participant.identity()));
  RIGCAL_ASSIGN(auto connection, Connection::Open(participant, context.dds));
  const std::int64_t start_ns = SteadyNow_ns();
  RIGCAL_TRY(connection.WaitForServer(
      std::max(kDiscoverWithin, context.timeout_is_given ? context.timeout : kDiscoverWithin)));
  const double found_ms = static_cast<double>(SteadyNow_ns() - start_ns) * 1e-6;
  findings.checks.push_back({"discovery", CheckLevel::kOk, "found a rigcald after " + Fixed(found_ms, 0) + " ms", ""});
  if (const Status one = connection.CheckOneServer(); !one) {
    findings.checks.push_back({"servers", CheckLevel::kFail, one.error().what, one.error().cure});
    return {};
  }
  std::vector<Health> answers;
  for (int i = 0; i < kRoundTrips; ++i) {
    RIGCAL_ASSIGN(Health health, AskHealth(connection, context.timeout));
    answers.push_back(std::move(health));
  }
  findings.has_server = true;
  CheckAnswers(answers, findings.checks);
  RIGCAL_ASSIGN(const Document status,
                connection.AskDocument("status", JsonObject({{"limit", std::int64_t{1}}}), context.timeout));
  for (const Document& batch : status["open_batches"].Items())
    findings.checks.push_back({"edges", CheckLevel::kWarn, OpenBatchText(batch), kCompleteBatch});
  return {};
}

Findings Look(const Context& context) {
  Findings findings;
  findings.checks.push_back(JudgeInterfaces(ListInterfaces()));
  findings.checks.push_back(JudgeReceiveBuffer(ReceiveBufferMax()));
  findings.checks.push_back(JudgeDisk("disk here", FreeHere()));
  if (const Status seen = CheckServer(context, findings); !seen) {
    const bool is_absent = seen.error().code == ErrorCode::kUnreachable;
    findings.checks.push_back({is_absent ? "discovery" : "server", CheckLevel::kFail, Plain(seen.error().what),
                               is_absent
                                   ? "Start `rigcald --data DIR` with the same domain and tag; let UDP ports 7400-7700 "
                                     "through firewalls; between machines the network must pass multicast"
                                   : Plain(seen.error().cure)});
  }
  return findings;
}

void Print(const Findings& findings, std::ostream& out) {
  Table table({{"CHECK"}, {""}, {"FOUND"}});
  for (const Check& check : findings.checks) {
    table.Add({check.name, NameOf(check.level), check.text});
    if (!check.cure.empty()) table.Add({"", "", "-> " + check.cure});
  }
  table.Print(out);
}

void PrintJson(const Findings& findings, ExitCode code, std::ostream& out) {
  std::string list = "[";
  for (const Check& check : findings.checks)
    list +=
        (list.size() > 1 ? "," : "") +
        JsonObject({{"cure", check.cure}, {"level", NameOf(check.level)}, {"name", check.name}, {"text", check.text}});
  out << JsonObject({Field::Raw("checks", list + "]"), Field::Raw("good", code == ExitCode::kGood ? "true" : "false")})
      << std::endl;
}

ExitCode Run(const Context& context) {
  const Findings findings = Look(context);
  const bool failed = std::any_of(findings.checks.begin(), findings.checks.end(),
                                  [](const Check& check) { return check.level == CheckLevel::kFail; });
  const ExitCode code = !findings.has_server ? ExitCode::kUnreachable
                        : failed             ? ExitCode::kVerdictFail
                                             : ExitCode::kGood;
  if (context.json)
    PrintJson(findings, code, context.out);
  else
    Print(findings, context.out);
  return code;
}

}  // namespace

void AddDoctor(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("doctor", "Check what may be in the way between here and the server");
  verb->footer(
      "Network, socket buffers, disks, discovery, round trip, versions, clocks; each with what to do.\n"
      "Exit code 3 if no server answers, 1 if a check fails.\n"
      "Examples:\n"
      "  rigcal doctor\n"
      "  rigcal doctor --domain 3\n"
      "  rigcal doctor --json\n");
  verb->callback([&context] { context.exit_code = Run(context); });
}

}  // namespace rigcal::client
