#include <CLI/CLI.hpp>
#include <memory>

#include "client/change/order.h"
#include "client/text/standing_text.h"
#include "client/verbs.h"

namespace rigcal::client {

void AddRestore(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("restore", "Let what was retired, or a superseded session, count again");
  auto options = std::make_shared<OrderOptions>();
  verb->add_option("THING", options->id,
                   "An edge or a session by its id, or its first 8 digits or more; a sensor of --robot")
      ->required();
  verb->add_option("--reason", options->reason, "Why, for those who come after")->type_name("TEXT");
  AddOrderOptions(*verb, *options);
  verb->footer(
      "Of sessions of the same pictures the one counts that was pushed or restored last. Nothing is deleted.\n"
      "Examples:\n"
      "  rigcal sessions mapper-01           which are superseded or retired, and why\n"
      "  rigcal restore 0123456789abcdef\n"
      "  rigcal restore 01234567 --reason \"the other has a wrong square size\" --by Ada\n"
      "  rigcal restore front_left --robot mapper-01 --reason \"back on its mount\"\n");
  verb->callback([&context, options] {
    const Status done = GiveOrder(context, {"restore", PrintStanding}, *options);
    if (!done) context.exit_code = Report(done.error(), context);
  });
}

}  // namespace rigcal::client
