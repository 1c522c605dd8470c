#include <CLI/CLI.hpp>

#include "client/table.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

void PrintRobots(const Document& document, std::ostream& out) {
  if (document["robots"].size() == 0) out << "No robot is known yet. Send a session with `rigcal push DIR`.\n";
  if (document["robots"].size() == 0) return;
  Table table({{"ROBOT"},
               {"VERDICT"},
               {"REVISION", Align::kRight},
               {"AGE", Align::kRight},
               {"SESSIONS", Align::kRight},
               {"EDGES", Align::kRight},
               {"JOBS", Align::kRight}});
  for (const Document& row : document["robots"].Items())
    table.Add({row["robot"].Text("?"), OverdueBefore(row) + row["verdict"]["level"].Text("unknown"),
               CountOf(row["revision"]), AgeOf(row["age_ns"]), CountOf(row["sessions"]), CountOf(row["edges"]),
               CountOf(row["jobs_waiting"])});
  table.Print(out);
}

}  // namespace

void AddRobots(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("robots", "List the robots with their verdict and the age of their calibration");
  verb->footer(
      "Exit code 0, whatever the verdicts: `rigcal show ROBOT` ends with that of one robot.\n"
      "Examples:\n"
      "  rigcal robots\n"
      "  rigcal robots --json\n");
  verb->callback([&context] { context.exit_code = Answer(context, {"robots", "{}", PrintRobots, {}}); });
}

}  // namespace rigcal::client
