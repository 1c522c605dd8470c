#include <CLI/CLI.hpp>
#include <memory>

#include "client/edge_table.h"
#include "client/table.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

void PrintAnswer(const Document& document, std::ostream& out) {
  const auto edges = document["edges"].Items();
  if (edges.empty()) out << "This robot has no edges yet. Send a session with `rigcal push DIR`.\n";
  PrintEdges(edges, out, EdgeIds::kShown);
}

}  // namespace

void AddEdges(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("edges", "List a robot's pairwise results with their uncertainty");
  auto robot = std::make_shared<std::string>();
  verb->add_option("ROBOT", *robot, "The robot's id")->required();
  verb->footer(
      "EDGE: the first digits of its id, for `rigcal retire`. --json has the whole ids.\n"
      "p, rpy: pose of B in A. sigma: one standard deviation per axis of B. |e|: how far the edge is from the graph.\n"
      "A failed edge is listed with its reason and what to do. lidar_lidar+gicp: polished, as the session asked for.\n"
      "Examples:\n"
      "  rigcal edges mapper-01\n"
      "  rigcal edges mapper-01 --json\n");
  verb->callback([&context, robot] {
    context.exit_code = Answer(context, {"edges", JsonObject({{"robot", *robot}}), PrintAnswer, {}});
  });
}

}  // namespace rigcal::client
