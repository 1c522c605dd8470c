#include "client/change/order.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>

#include "client/named.h"
#include "client/push/await_result.h"
#include "client/push/push_result.h"
#include "idl/security.h"

namespace rigcal::client {

std::string LoginName() {
  for (const char* variable : {"LOGNAME", "USER"})
    if (const char* name = std::getenv(variable); name != nullptr && *name != 0) return name;
  return "user " + std::to_string(geteuid());
}

std::string WhoAsks(const std::string& given) {
  if (!given.empty()) return given;
  const std::filesystem::path folder = wire::IdentityFolder({});
  if (folder.empty()) return LoginName();
  const auto identity = ReadIdentity(folder, SystemClock().Now());
  return identity && identity->holder == IdentityHolder::kOperator ? identity->name : LoginName();
}

namespace {

std::string ParametersOf(const OrderOptions& options) {
  std::vector<Field> fields = {{"thing", options.id}, {"who", WhoAsks(options.who)}};
  if (!options.reason.empty()) fields.emplace_back("reason", options.reason);
  if (!options.robot.empty()) fields.emplace_back("robot", options.robot);
  return JsonObject(fields);
}

// The standing and the robot of what was asked for: `done` has them itself, or its session has.
const Document& Holder(const Document& done, const Document& session) { return session.IsNull() ? done : session; }

Result<Awaited> AwaitRevision(const Context& context, const OrderOptions& options, const Document& done) {
  const Document session = done["session"];
  const Document& holder = Holder(done, session);
  RIGCAL_ASSIGN(const RobotId robot, RobotId::Parse(holder["robot"].Text()));
  RIGCAL_ASSIGN(const auto participant, wire::Participant::Open(context.dds));
  RIGCAL_ASSIGN(auto watch, ResultWatch::Open(participant, context.dds, robot));
  AwaitPlace place{robot,
                   SessionId(),
                   {},
                   holder["standing"]["number"].Integer().value_or(0),
                   WhereText(context.dds),
                   std::llround(options.give_up_s * 1e9),
                   done["set"]["version"].Integer().value_or(0)};
  return watch.Await(std::move(place), {{}, [&](const std::string& line) { context.err << line << std::endl; }});
}

std::string OrderJson(const std::string& done, const Awaited& awaited) {
  return JsonObject({Field::Raw("done", done), Field::Raw("show", awaited.has_revision ? awaited.show_text : "null")});
}

}  // namespace

void AddOrderOptions(CLI::App& verb, OrderOptions& options) {
  verb.add_option("--by", options.who, "Who asks for it (default: the login name)")->check(Named())->type_name("NAME");
  verb.add_option("--robot", options.robot,
                  "The sensor's robot; of an id: only this robot's, where its first digits fit several")
      ->type_name("ID");
  verb.add_flag("--no-wait", options.no_wait, "End when it is safe on the server's disk");
  verb.add_option("--timeout-total", options.give_up_s, "Give up after so many seconds without any answer (default 60)")
      ->check(CLI::Range(0.1, 1e7))
      ->type_name("S");
}

Status GiveOrder(Context& context, const OrderToGive& order, const OrderOptions& options) {
  RIGCAL_ASSIGN(const std::string text, AskOnce(context, order.verb, ParametersOf(options)));
  return FollowOrder(context, order, options, text);
}

Status FollowOrder(Context& context, const OrderToGive& order, const OrderOptions& options, const std::string& text) {
  RIGCAL_ASSIGN(const Document done, Document::Parse(text, "the server's answer to '" + order.verb + "'"));
  if (!context.json) order.print(done, context.out);
  Awaited awaited;
  if (!options.no_wait && done["revision_follows"].Flag(true)) {
    RIGCAL_ASSIGN(awaited, AwaitRevision(context, options, done));
    if (!context.json) PrintResult(awaited, context.out);
    context.exit_code = JudgeResult(awaited);
  }
  if (context.json) context.out << OrderJson(text, awaited) << std::endl;
  return {};
}

}  // namespace rigcal::client
