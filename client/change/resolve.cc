#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>

#include "client/change/order.h"
#include "client/named.h"
#include "client/positive.h"
#include "client/text/progress.h"
#include "client/text/recomputation_text.h"
#include "client/verbs.h"
#include "server/base/limits.h"

namespace rigcal::client {
namespace {

using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

constexpr milliseconds kLookAgainAfter(500);

struct ResolveOptions {
  std::string robot, model, board, who;
  bool all = false, status = false, no_wait = false;
  int run = 0;
  double give_up_s = 60.0;
};

std::int64_t ResolveNow_ns() { return SteadyClock::now().time_since_epoch() / std::chrono::nanoseconds(1); }

// A robot by its name, or one of the others: exactly one.
std::vector<Field> ScopeFields(const ResolveOptions& options) {
  std::vector<Field> fields;
  if (options.all) fields.push_back(Field::Raw("all", "true"));
  if (!options.model.empty()) fields.emplace_back("model", options.model);
  if (!options.robot.empty()) fields.emplace_back("robot", options.robot);
  if (!options.board.empty()) fields.emplace_back("board", options.board);
  return fields;
}

// Asks again where the server is away for a while: it is started anew, and goes on.
class RunFollower {
 public:
  RunFollower(Connection& connection, const Context& context, double give_up_s)
      : connection_(connection), context_(context), give_up_(std::llround(give_up_s * 1e3)) {}

  [[nodiscard]] Result<std::string> Ask(std::int64_t run, std::int64_t limit) {
    std::vector<Field> fields = {{"limit", limit}};
    if (run > 0) fields.emplace_back("run", run);
    const auto began = SteadyClock::now();
    while (true) {
      auto answer = connection_.Ask("recomputation", JsonObject(fields), std::min(context_.timeout, give_up_));
      if (answer || answer.error().code != ErrorCode::kUnreachable || SteadyClock::now() - began >= give_up_)
        return answer;
    }
  }

  // Until the run is done: its document.
  [[nodiscard]] Result<std::string> Follow(std::int64_t run) {
    Progress progress(context_.err, context_.err_is_terminal, "re-computing", ResolveNow_ns(),
                      Progress::Unit::kSessions);
    while (true) {
      RIGCAL_ASSIGN(const std::string text, Ask(run, 0));
      RIGCAL_ASSIGN(const Document document, Document::Parse(text, "the server's answer to 'recomputation'"));
      if (document["done"].Flag()) break;
      const Document sessions = document["sessions"];
      progress.Show(
          {sessions["done"].Integer().value_or(0), sessions["total"].Integer().value_or(0), ChangedText(document)},
          ResolveNow_ns());
      std::this_thread::sleep_for(kLookAgainAfter);
    }
    progress.Clear();
    return Ask(run, limits::kPageRowsMax);
  }

 private:
  Connection& connection_;
  const Context& context_;
  milliseconds give_up_;
};

// The run that was asked for, or is asked about.
Result<Document> AskForRun(const Context& context, const ResolveOptions& options, Connection& connection,
                           RunFollower& follower) {
  if (options.status) {
    RIGCAL_ASSIGN(const std::string text, follower.Ask(options.run, 0));
    return Document::Parse(text, "the server's answer to 'recomputation'");
  }
  std::vector<Field> fields = ScopeFields(options);
  fields.emplace_back("who", WhoAsks(options.who));
  RIGCAL_ASSIGN(const std::string text, connection.Ask("resolve", JsonObject(fields), context.timeout));
  return Document::Parse(text, "the server's answer to 'resolve'");
}

void SayHowToLeave(const Context& context, const Document& asked) {
  if (context.json || asked["done"].Flag()) return;
  const bool is_again = asked.Has("new") && !asked["new"].Flag();
  context.err << (is_again ? "This was asked for before. " : "") << RunText(asked)
              << " Ctrl-C leaves it: the server goes on, and `rigcal resolve --status` follows it." << std::endl;
}

Result<ExitCode> Resolve(const Context& context, const ResolveOptions& options) {
  RIGCAL_ASSIGN(const auto participant, wire::Participant::Open(context.dds));
  RIGCAL_ASSIGN(auto connection, Connection::Open(participant, context.dds));
  RunFollower follower(connection, context, options.give_up_s);
  RIGCAL_ASSIGN(const Document asked, AskForRun(context, options, connection, follower));
  const std::int64_t run = asked["run"].Integer().value_or(0);
  if (!options.no_wait) SayHowToLeave(context, asked);
  RIGCAL_ASSIGN(const std::string text,
                options.no_wait ? follower.Ask(run, limits::kPageRowsMax) : follower.Follow(run));
  RIGCAL_ASSIGN(const Document document, Document::Parse(text, "the server's answer to 'recomputation'"));
  if (context.json)
    context.out << text << std::endl;
  else
    PrintRecomputation(document, context.out);
  const std::int64_t failed =
      document["sessions"]["failed"].Integer().value_or(0) + document["robots_count"]["failed"].Integer().value_or(0);
  return failed > 0 ? ExitCode::kVerdictUnknown : ExitCode::kGood;
}

// `said`: what of ROBOT, --all, --model, --board and --status stands on the command line.
void CheckScope(const ResolveOptions& options, const std::vector<std::string>& said) {
  if (said.empty()) throw CLI::RequiredError("One of ROBOT, --all, --model, --board and --status");
  if (said.size() > 1)
    throw CLI::ExcludesError(said[0] + " and " + said[1] + " contradict each other: name one of them",
                             CLI::ExitCodes::ExcludesError);
  if (!options.status && ScopeFields(options).empty()) throw CLI::RequiredError("A name after " + said[0]);
}

void RunResolve(Context& context, const ResolveOptions& options, const std::vector<std::string>& said) {
  CheckScope(options, said);
  const auto done = Resolve(context, options);
  context.exit_code = done ? *done : Report(done.error(), context);
}

}  // namespace

void AddResolve(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(
      "resolve", "Compute stored sessions again with the server's software of today, and show what would change");
  auto options = std::make_shared<ResolveOptions>();
  CLI::Option* robot = verb->add_option("ROBOT", options->robot, "Of this robot");
  CLI::Option* all = verb->add_flag("--all", options->all, "Of all robots");
  CLI::Option* model =
      verb->add_option("--model", options->model, "Of the robots of this rig model, as sessions name it")
          ->type_name("NAME");
  CLI::Option* board = verb->add_option("--board", options->board,
                                        "Of the robots that this board was shown to, with its size as it was measured "
                                        "last")
                           ->type_name("SERIAL");
  CLI::Option* status = verb->add_flag("--status", options->status,
                                       "Follow the newest run, or tell what came of it; nothing is asked for");
  verb->add_option("--run", options->run, "Of --status: this run")->type_name("N")->check(Positive())->needs(status);
  verb->add_option("--by", options->who, "Who asks for it (default: the login name)")
      ->check(Named())
      ->type_name("NAME");
  verb->add_flag("--no-wait", options->no_wait, "Tell how far it is now, and end");
  verb->add_option("--timeout-total", options->give_up_s,
                   "Give up after so many seconds without any answer (default 60)")
      ->check(CLI::Range(0.1, 1e7))
      ->type_name("S");
  verb->footer(
      "Nothing that is approved or in use changes: what comes out is a candidate for each robot, held until a person "
      "approves it, "
      "whatever\n"
      "the policy says; a robot for which nothing changes gets none. What is pushed meanwhile comes first. A run "
      "outlives "
      "Ctrl-C and the\n"
      "server's end; asked twice it is one run. Sessions whose files are gone are kept as they are (docs/resolve.md).\n"
      "Exit code: 0 done, 6 something failed.\n"
      "Examples:\n"
      "  rigcal resolve mapper-01                       after an update of the server\n"
      "  rigcal resolve --all --no-wait                 begin, and look later\n"
      "  rigcal resolve --status                        follow it, or see what came of it\n"
      "  rigcal resolve --board B-7                     a board was measured anew\n"
      "  rigcal approve mapper-01 5 --reason \"as good, and newer\"\n");
  verb->callback([&context, options, scopes = std::vector{robot, all, model, board, status}] {
    std::vector<std::string> said;
    for (const CLI::Option* scope : scopes)
      if (scope->count() > 0) said.push_back(scope->get_name());
    RunResolve(context, *options, said);
  });
}

}  // namespace rigcal::client
