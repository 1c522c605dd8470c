#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <csignal>
#include <memory>
#include <set>
#include <utility>

#include "client/change/agent_file.h"
#include "client/change/order.h"
#include "client/push/new_robot.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "idl/convert.h"
#include "server/model/approval/decision.h"

namespace rigcal::client {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kAgentTick(200);    // how long Ctrl-C may go unnoticed
constexpr milliseconds kAgentAgain(2000);  // what failed is tried again after so long
constexpr int kAgentTakes = 4096;

std::atomic<bool> agent_interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");
void OnAgentInterrupt(int) { agent_interrupted = true; }

struct AgentOptions {
  std::string robot, file, who;
  bool once = false;
};

// What came of a look at what is announced.
struct AgentLook {
  std::int64_t revision = 0;  // that the file holds now; 0: nothing that is announced is in use
  Digest digest;
  bool written = false;
  Stamp applied_at = {};
};

class Agent {
 public:
  [[nodiscard]] static Result<Agent> Open(const Context& context, const AgentOptions& options);
  // True: something was announced since the last call, or what failed is due again.
  [[nodiscard]] Result<bool> HasNews();
  // Brings the file up to what is announced and in use, and tells the server. The file stays as it is on any error.
  [[nodiscard]] Result<AgentLook> Look();
  void LookAgain() { again_at_ = Clock::now() + kAgentAgain; }
  // Of a file that is there already.
  [[nodiscard]] Status TellOld();
  // Until the server says that it has kept the report of `look`, however often the report has to be sent again.
  // kUnreachable where the time is over before.
  [[nodiscard]] Status AwaitKept(const AgentLook& look);
  // A robot that is known, and of whose name this one is a slip; else empty.
  [[nodiscard]] std::string MeantRobot() { return SlipOf(connection_, RobotId(options_.robot), context_->timeout); }
  // Why nothing was applied: it was interrupted, nothing is in use, or what is was not announced yet.
  [[nodiscard]] Error WhyNothing();

 private:
  using Clock = std::chrono::steady_clock;
  Agent(const Context& context, const AgentOptions& options, wire::Participant participant, Connection connection,
        wire::Reader<rigcal_wire_Calibration> calibrations, wire::Writer<rigcal_wire_CalibrationInUse> reports,
        wire::WaitSet waitset)
      : context_(&context),
        options_(options),
        participant_(std::move(participant)),
        connection_(std::move(connection)),
        calibrations_(std::move(calibrations)),
        reports_(std::move(reports)),
        waitset_(std::move(waitset)) {}
  [[nodiscard]] Result<std::string> Show(std::int64_t revision);
  [[nodiscard]] Result<bool> IsKept(const AgentLook& look);
  // "revision 4 is a candidate: ..."; of none that nobody can approve any.
  [[nodiscard]] Result<std::string> Candidates();
  [[nodiscard]] Status Tell(const Digest& digest, std::int64_t revision, Stamp applied_at);

  const Context* context_;
  AgentOptions options_;
  wire::Participant participant_;
  Connection connection_;
  wire::Reader<rigcal_wire_Calibration> calibrations_;
  wire::Writer<rigcal_wire_CalibrationInUse> reports_;
  wire::WaitSet waitset_;
  std::set<std::int64_t> announced_;  // revisions
  std::int64_t last_ = 0;             // of them
  std::optional<Clock::time_point> again_at_ = {};
};

Result<Agent> Agent::Open(const Context& context, const AgentOptions& options) {
  RIGCAL_ASSIGN(const RobotId robot, RobotId::Parse(options.robot));
  const std::string partition = wire::RobotPartition(robot);
  RIGCAL_ASSIGN(auto participant, wire::Participant::Open(context.dds));
  RIGCAL_ASSIGN(auto connection, Connection::Open(participant, context.dds));
  RIGCAL_ASSIGN(auto calibrations, wire::Reader<rigcal_wire_Calibration>::Open(participant, {partition}));
  RIGCAL_ASSIGN(auto reports, wire::Writer<rigcal_wire_CalibrationInUse>::Open(participant, {partition}));
  RIGCAL_ASSIGN(auto waitset, wire::WaitSet::Open(participant));
  RIGCAL_TRY(waitset.Attach(calibrations.get()));
  return Agent(context, options, std::move(participant), std::move(connection), std::move(calibrations),
               std::move(reports), std::move(waitset));
}

Result<bool> Agent::HasNews() {
  RIGCAL_TRY(waitset_.Wait(kAgentTick));
  bool any = false;
  RIGCAL_TRY(calibrations_.Take(kAgentTakes, [&](const rigcal_wire_Calibration& sample, const wire::SampleOrigin&) {
    last_ = sample.revision;
    announced_.insert(last_);
    any = true;
  }));
  const bool due = again_at_ && Clock::now() >= *again_at_;
  if (any || due) again_at_.reset();
  return any || due;
}

Result<std::string> Agent::Show(std::int64_t revision) {
  return connection_.Ask("show", JsonObject({{"robot", options_.robot}, {"revision", revision}}), context_->timeout);
}

// What was announced last is not in use any more where the next announcement is on its way.
Result<AgentLook> Agent::Look() {
  AgentLook look;
  RIGCAL_ASSIGN(std::string text, Show(last_));
  RIGCAL_ASSIGN(Document shown, Document::Parse(text, "the server's answer to 'show'"));
  const std::int64_t in_use = shown["in_use"]["revision"].Integer().value_or(0);
  if (!announced_.contains(in_use)) return look;
  if (in_use != last_) {
    RIGCAL_ASSIGN(text, Show(in_use));
    RIGCAL_ASSIGN(shown, Document::Parse(text, "the server's answer to 'show'"));
  }
  RIGCAL_ASSIGN(look.digest, Digest::Parse(shown["digest"].Text()));
  RIGCAL_ASSIGN(const auto old, LookAtApplied(options_.file));
  look.written = !old || old->digest != look.digest;
  if (look.written) RIGCAL_TRY(Apply(DocumentIn(text), look.digest, options_.file));
  RIGCAL_ASSIGN(const auto applied, LookAtApplied(options_.file));
  look.revision = in_use;
  look.applied_at = applied ? applied->applied_at : SystemClock().Now();
  RIGCAL_TRY(Tell(look.digest, in_use, look.applied_at));
  return look;
}

Status Agent::Tell(const Digest& digest, std::int64_t revision, Stamp applied_at) {
  rigcal_wire_CalibrationInUse sample{};
  RIGCAL_TRY(wire::CopyText(options_.robot, sample.robot_id, sizeof sample.robot_id, "robot_id"));
  RIGCAL_TRY(wire::CopyText(digest.str(), sample.digest, sizeof sample.digest, "digest"));
  RIGCAL_TRY(wire::CopyText(options_.who, sample.who, sizeof sample.who, "--by"));
  sample.revision = static_cast<std::uint32_t>(revision);
  sample.applied_ns = applied_at.ns;
  RIGCAL_TRY(reports_.WaitForReader(context_->timeout));
  RIGCAL_TRY(reports_.Write(sample));
  return reports_.WaitForAcks(context_->timeout);
}

Status Agent::TellOld() {
  RIGCAL_ASSIGN(const auto old, LookAtApplied(options_.file));
  return old ? Tell(old->digest, 0, old->applied_at) : Status();
}

// A server of before tells the number alone.
Result<bool> Agent::IsKept(const AgentLook& look) {
  RIGCAL_ASSIGN(const std::string text, Show(last_));
  RIGCAL_ASSIGN(const Document shown, Document::Parse(text, "the server's answer to 'show'"));
  const Document runs = shown["runs"];
  if (!runs.Has("digest")) return runs["revision"].Integer() == look.revision;
  return runs["digest"].Text() == look.digest.str();
}

Status Agent::AwaitKept(const AgentLook& look) {
  const auto until = Clock::now() + context_->timeout;
  while (!agent_interrupted) {
    RIGCAL_ASSIGN(const bool kept, IsKept(look));
    if (kept) return {};
    if (Clock::now() >= until) break;
    RIGCAL_TRY(HasNews());  // a moment
    RIGCAL_TRY(Tell(look.digest, look.revision, look.applied_at));
  }
  return Fail(ErrorCode::kUnreachable,
              options_.file + " is revision " + std::to_string(look.revision) + " of " + options_.robot +
                  ", but the server has not kept the report of it" + (agent_interrupted ? ": interrupted" : ""),
              "Run it again: the file is left as it is, and reported once more.");
}

// The newest first.
Result<std::string> Agent::Candidates() {
  constexpr std::int64_t kLookedAt = 20;
  RIGCAL_ASSIGN(
      const std::string text,
      connection_.Ask("revisions", JsonObject({{"robot", options_.robot}, {"limit", kLookedAt}}), context_->timeout));
  RIGCAL_ASSIGN(const Document told, Document::Parse(text, "the server's answer to 'revisions'"));
  std::string numbers, newest;
  for (const Document& row : told["revisions"].Items()) {
    if (RevisionStateOf(row["state"].Text()) != RevisionState::kCandidate) continue;
    if (newest.empty()) newest = CountOf(row["revision"]);
    numbers += (numbers.empty() ? "" : ", ") + CountOf(row["revision"]);
  }
  if (numbers.empty())
    return "`rigcal show " + options_.robot + "` says why: there is no candidate that can be approved.";
  return "Look at what can be approved, revision " + numbers + ", then `rigcal approve " + options_.robot + " " +
         newest + " --reason TEXT`.";
}

Error Agent::WhyNothing() {
  const std::string stays = ": " + options_.file + " stays as it is";
  if (agent_interrupted)
    return {ErrorCode::kBusy, "interrupted before a calibration of robot '" + options_.robot + "' was applied" + stays,
            "Run it again."};
  const auto text = Show(0);
  if (!text) return text.error();
  const auto shown = Document::Parse(*text, "the server's answer to 'show'");
  if (!shown) return shown.error();
  if (const auto in_use = (*shown)["in_use"]["revision"].Integer())
    return {ErrorCode::kUnreachable,
            "revision " + std::to_string(*in_use) + " of robot '" + options_.robot +
                "' is in use, but was not announced yet" + stays,
            "Run it again, or give it longer: --timeout."};
  const auto candidates = Candidates();
  return {ErrorCode::kConflict, "no calibration of robot '" + options_.robot + "' is in use" + stays,
          candidates ? *candidates : "`rigcal show " + options_.robot + "` says why."};
}

void PrintLook(const Context& context, const AgentOptions& options, const AgentLook& look) {
  if (context.json)
    context.out << JsonObject({{"digest", look.digest.str()},
                               {"file", options.file},
                               {"revision", look.revision},
                               {"robot", options.robot},
                               Field::Raw("written", look.written ? "true" : "false")})
                << std::endl;
  else
    context.out << Plain(options.file) << (look.written ? " is now" : " is") << " revision " << look.revision << " of "
                << options.robot << ", sha256 " << look.digest.str() << std::endl;
}

// Until what is announced is applied, and the server knows it, or the time is over.
Status RunOnce(const Context& context, const AgentOptions& options, Agent& agent) {
  const auto until = std::chrono::steady_clock::now() + context.timeout;
  while (!agent_interrupted && std::chrono::steady_clock::now() < until) {
    RIGCAL_ASSIGN(const bool news, agent.HasNews());
    if (!news) continue;
    RIGCAL_ASSIGN(const AgentLook look, agent.Look());
    if (look.revision == 0) continue;
    PrintLook(context, options, look);
    return agent.AwaitKept(look);
  }
  return Fail(agent.WhyNothing());
}

// Until Ctrl-C: what fails is said, and tried again.
Status RunForEver(const Context& context, const AgentOptions& options, Agent& agent) {
  if (const std::string meant = agent.MeantRobot(); !meant.empty())
    context.err << "Robot " << options.robot << " is not known, and " << meant
                << " is: this waits for what is approved of " << options.robot << ". End it with Ctrl-C where " << meant
                << " was meant." << std::endl;
  std::int64_t told = 0;
  while (!agent_interrupted) {
    RIGCAL_ASSIGN(const bool news, agent.HasNews());
    if (!news) continue;
    const auto look = agent.Look();
    if (look && look->revision > 0 && std::exchange(told, look->revision) != look->revision)
      PrintLook(context, options, *look);
    if (look) continue;
    (void)Report(look.error(), context.err);
    agent.LookAgain();
  }
  return {};
}

Status RunAgent(const Context& context, const AgentOptions& options) {
  struct sigaction action {};
  action.sa_handler = OnAgentInterrupt;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  RIGCAL_ASSIGN(Agent agent, Agent::Open(context, options));
  if (const Status told = agent.TellOld(); !told) {
    if (options.once) return told;
    (void)Report(told.error(), context.err);
  }
  return options.once ? RunOnce(context, options, agent) : RunForEver(context, options, agent);
}

}  // namespace

void AddAgent(CLI::App& app, Context& context) {
  CLI::App* verb =
      app.add_subcommand("agent", "On a robot: keep a file as the calibration that is in use, and report it");
  auto options = std::make_shared<AgentOptions>();
  verb->add_option("ROBOT", options->robot, "The robot's id")->required();
  verb->add_option("--out", options->file, "The file: the revision's document, its sha256 is the digest")
      ->required()
      ->type_name("FILE");
  verb->add_option("--by", options->who, "The program that applies it, as it is reported (default: rigcal agent)")
      ->type_name("NAME");
  verb->add_flag(
      "--once", options->once,
      "End when the file is what is announced, and the server has kept the report of it; an error if not, within "
      "--timeout");
  verb->footer(
      "Only what is announced, and so was approved, is ever written; at once and whole, also where the power goes. On "
      "any error\n"
      "the file stays as it is. What runs is told to the server, which shows where it is not what is in use.\n"
      "Examples:\n"
      "  rigcal agent mapper-01 --out calibration.json\n"
      "  rigcal agent mapper-01 --out calibration.json --once\n");
  verb->callback([&context, options] {
    if (options->who.empty()) options->who = "rigcal agent";
    const Status done = RunAgent(context, *options);
    if (!done) context.exit_code = Report(done.error(), context);
  });
}

}  // namespace rigcal::client
