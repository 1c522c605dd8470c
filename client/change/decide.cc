#include <CLI/CLI.hpp>
#include <memory>

#include "client/change/order.h"
#include "client/named.h"
#include "client/positive.h"
#include "client/text/approval_text.h"
#include "client/text/table.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

struct DecideOptions {
  std::string robot, who, reason;
  int revision = 0;
};

void PrintDecided(const Document& done, std::ostream& out) { out << DecidedText(done) << '\n'; }

ExitCode RunDecide(const Context& context, const std::string& verb, const DecideOptions& options) {
  std::vector<Field> parameters = {{"robot", options.robot}, {"who", WhoAsks(options.who)}, {"reason", options.reason}};
  if (options.revision > 0) parameters.emplace_back("revision", std::int64_t{options.revision});
  return Answer(context, {verb, JsonObject(parameters), PrintDecided, {}});
}

void AddDecide(CLI::App& app, Context& context, const std::string& name, const std::string& description,
               const std::string& footer) {
  CLI::App* verb = app.add_subcommand(name, description);
  auto options = std::make_shared<DecideOptions>();
  const bool needs_revision = name == "rollback";
  verb->add_option("ROBOT", options->robot, "The robot's id")->required();
  verb->add_option("REVISION", options->revision, "Its number: that which was looked at")
      ->check(Positive())
      ->required(needs_revision);
  verb->add_option("--reason", options->reason, "Why, for those who come after")->required()->type_name("TEXT");
  verb->add_option("--by", options->who, "Who decides (default: the login name)")->check(Named())->type_name("NAME");
  verb->footer(footer);
  verb->callback([&context, name, options] { context.exit_code = RunDecide(context, name, *options); });
}

}  // namespace

void AddApprove(CLI::App& app, Context& context) {
  AddDecide(
      app, context, "approve", "Let a robot use a revision",
      "Only what passes or warns can be approved. Where the policy says `approval: person` nothing else lets a "
      "robot use a\n"
      "revision; else a pass is approved by itself (docs/approval.md). Without a number nothing is approved: the\n"
      "answer names the newest candidate.\n"
      "Examples:\n"
      "  rigcal show mapper-01              what is in use, and what is a candidate\n"
      "  rigcal approve mapper-01 4 --reason \"checked against the wall\"\n");
}

void AddReject(CLI::App& app, Context& context) {
  AddDecide(app, context, "reject", "Say that no robot is to use a revision",
            "If it was in use, the one before it is from now on. It can be approved again.\n"
            "Examples:\n"
            "  rigcal reject mapper-01 4 --reason \"the mast was bent\"\n");
}

void AddRollback(CLI::App& app, Context& context) {
  AddDecide(app, context, "rollback", "Let a robot use an earlier approved revision again",
            "Those after it are used no more, until one of them is approved or rolled back to. With `approval: "
            "automatic` the next\n"
            "revision that passes is in use again; set `approval: person` of the robot to keep it where it is.\n"
            "Examples:\n"
            "  rigcal history mapper-01           its revisions, and which is in use\n"
            "  rigcal rollback mapper-01 3 --reason \"4 was taken on the wrong floor\"\n");
}

}  // namespace rigcal::client
