#include <CLI/CLI.hpp>
#include <memory>

#include "client/order.h"
#include "client/table.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

void PrintRetired(const Document& done, std::ostream& out) {
  const Document edge = done["edge"];
  out << Plain("Edge " + edge["id"].Text("?").substr(0, 16) + " of " + done["robot"].Text("?") + ", " +
               edge["frame_a"].Text("?") + " - " + edge["frame_b"].Text("?") +
               ", does not count any more: " + edge["diagnoses"][0]["what"].Text())
      << ".\n";
}

}  // namespace

void AddRetire(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("retire", "Let a wrong edge take no part any more, for good");
  auto options = std::make_shared<OrderOptions>();
  verb->add_option("EDGE", options->id, "The edge's id, or its first 8 digits or more")->required();
  verb->add_option("--reason", options->reason, "Why it is wrong, for those who come after")
      ->required()
      ->type_name("TEXT");
  AddOrderOptions(*verb, *options);
  verb->footer(
      "The edge stays listed as past, with who retired it and why. Pushed again it stays retired; the right value is\n"
      "another edge, and counts.\n"
      "Examples:\n"
      "  rigcal edges mapper-01           the ids of its edges\n"
      "  rigcal retire 0123456789ab --reason \"typed 1.2 for 0.12\"\n");
  verb->callback([&context, options] {
    const Status done = GiveOrder(context, {"retire", "edge", PrintRetired}, *options);
    if (!done) context.exit_code = Report(done.error(), context);
  });
}

}  // namespace rigcal::client
