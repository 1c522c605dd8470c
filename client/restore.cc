#include <CLI/CLI.hpp>
#include <memory>

#include "client/order.h"
#include "client/standing_text.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

void PrintRestored(const Document& done, std::ostream& out) { out << StandingText(done["session"]) << std::endl; }

}  // namespace

void AddRestore(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("restore", "Let a superseded session count again, instead of what superseded it");
  auto options = std::make_shared<OrderOptions>();
  verb->add_option("SESSION", options->id, "The session's id, or its first 8 digits or more")->required();
  verb->add_option("--reason", options->reason, "Why, for those who come after")->type_name("TEXT");
  AddOrderOptions(*verb, *options);
  verb->footer(
      "Of sessions of the same pictures the one counts that was pushed or restored last. Nothing is deleted.\n"
      "Examples:\n"
      "  rigcal sessions mapper-01           which are superseded, and by which\n"
      "  rigcal restore 0123456789abcdef\n"
      "  rigcal restore 01234567 --reason \"the other has a wrong square size\" --by Ada\n");
  verb->callback([&context, options] {
    const Status done = GiveOrder(context, {"restore", "session", PrintRestored}, *options);
    if (!done) context.exit_code = Report(done.error(), context);
  });
}

}  // namespace rigcal::client
