#include <CLI/CLI.hpp>
#include <memory>

#include "client/change/order.h"
#include "client/text/standing_text.h"
#include "client/verbs.h"

namespace rigcal::client {

void AddRetire(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("retire", "Let a wrong edge or session, or a sensor that is gone, count no more");
  auto options = std::make_shared<OrderOptions>();
  verb->add_option("THING", options->id,
                   "An edge or a session by its id, or its first 8 digits or more; a sensor of --robot")
      ->required();
  verb->add_option("--reason", options->reason, "Why, for those who come after")->required()->type_name("TEXT");
  AddOrderOptions(*verb, *options);
  verb->footer(
      "It stays listed as past, with who retired it and why, and `rigcal restore` brings it back. Pushed again it "
      "stays\n"
      "retired: an edge with the right value is another edge, a session with a corrected session.yaml another session, "
      "and\n"
      "counts. A sensor is retired that is gone from the robot: nobody asks for it any more, and what a later session "
      "says\n"
      "of it does not count either. The reference sensor is kept until another can take its place.\n"
      "Examples:\n"
      "  rigcal edges mapper-01           the ids of its edges\n"
      "  rigcal retire 0123456789ab --reason \"typed 1.2 for 0.12\"\n"
      "  rigcal sessions mapper-01        the ids of its sessions\n"
      "  rigcal retire fedcba9876543210 --reason \"the board was bent\"\n"
      "  rigcal retire front_left --robot mapper-01 --reason \"taken off\"\n");
  verb->callback([&context, options] {
    const Status done = GiveOrder(context, {"retire", PrintStanding}, *options);
    if (!done) context.exit_code = Report(done.error(), context);
  });
}

}  // namespace rigcal::client
