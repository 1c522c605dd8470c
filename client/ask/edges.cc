#include <CLI/CLI.hpp>
#include <memory>

#include "client/page_options.h"
#include "client/text/edge_table.h"
#include "client/text/table.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

void PrintAnswer(const Document& document, std::ostream& out) {
  const auto edges = document["edges"].Items();
  if (edges.empty()) out << "This robot has no edges yet. Send a session with `rigcal push DIR`.\n";
  PrintEdges(edges, out, EdgeIds::kShown);
}

struct EdgesOptions {
  std::string robot, in;
  PageOptions page;
};

ExitCode RunEdges(const Context& context, const EdgesOptions& options) {
  std::vector<Field> parameters = {{"robot", options.robot}};
  if (!options.in.empty()) parameters.emplace_back("in", options.in);
  AddTo(parameters, options.page);
  const auto print = [&](const Document& document, std::ostream& out) {
    if (document["edges"].size() == 0 && !options.page.before.empty())
      out << kNoOlderOnes;
    else
      PrintAnswer(document, out);
    PrintNextPage(
        document,
        "rigcal edges " + options.robot + (options.in.empty() ? "" : " --in " + options.in) + LimitText(options.page),
        out);
  };
  return Answer(context, {"edges", JsonObject(parameters), print, {}});
}

}  // namespace

void AddEdges(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("edges", "List a robot's pairwise results with their uncertainty");
  auto options = std::make_shared<EdgesOptions>();
  verb->add_option("ROBOT", options->robot, "The robot's id")->required();
  verb->add_option("--in", options->in, "Those that this merged edge stands for, the oldest first; by pages the newest")
      ->type_name("EDGE");
  AddPageOptions(*verb, options->page, "edges", "the whole id of an edge");
  verb->footer(
      "EDGE: the first digits of its id, for `rigcal retire`. --json has the whole ids.\n"
      "p, rpy: pose of B in A. sigma: one standard deviation per axis of B. |e|: how far the edge is from the graph.\n"
      "A failed edge is listed with its reason and what to do. lidar_lidar+gicp: polished, as the session asked for.\n"
      "Examples:\n"
      "  rigcal edges mapper-01\n"
      "  rigcal edges mapper-01 --limit 50 --json\n"
      "  rigcal edges mapper-01 --in 0123456789ab    the visits that one edge of the report stands for\n");
  verb->callback([&context, options] { context.exit_code = RunEdges(context, *options); });
}

}  // namespace rigcal::client
