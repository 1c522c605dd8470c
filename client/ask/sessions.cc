#include <CLI/CLI.hpp>
#include <memory>

#include "client/page_options.h"
#include "client/text/standing_text.h"
#include "client/text/table.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

void PrintSessions(const Document& document, std::ostream& out) {
  if (document["sessions"].size() == 0) out << "No session is known yet. Send one with `rigcal push DIR`.\n";
  if (document["sessions"].size() == 0) return;
  Table table({{"SESSION"},
               {"ROBOT"},
               {"STATE"},
               {"CAPTURED"},
               {"FILES", Align::kRight},
               {"BYTES", Align::kRight},
               {"JOBS", Align::kRight},
               {"OPERATOR"}});
  for (const Document& row : document["sessions"].Items()) {
    const auto done = row["jobs_total"].Integer().value_or(0) - row["jobs_waiting"].Integer().value_or(0);
    table.Add({row["session"].Text("?").substr(0, 16), row["robot"].Text("?"),
               IsRetired(row)      ? "retired"
               : IsSuperseded(row) ? "superseded"
                                   : row["state"].Text("?"),
               row["captured_at"].Text("-"), CountOf(row["payloads_held"]) + "/" + CountOf(row["payloads"]),
               ByteText(row["bytes"].Number().value_or(0.0)), std::to_string(done) + "/" + CountOf(row["jobs_total"]),
               row["operator"].Text()});
  }
  table.Print(out);
  for (const Document& row : document["sessions"].Items())
    if (IsSuperseded(row) || IsRetired(row)) out << StandingText(row) << '\n';
}

struct SessionsOptions {
  std::string robot;
  PageOptions page;
};

ExitCode RunSessions(const Context& context, const SessionsOptions& options) {
  std::vector<Field> parameters;
  if (!options.robot.empty()) parameters.emplace_back("robot", options.robot);
  AddTo(parameters, options.page);
  const std::string command =
      "rigcal sessions" + (options.robot.empty() ? "" : " " + options.robot) + LimitText(options.page);
  const auto print = [&](const Document& document, std::ostream& out) {
    if (document["sessions"].size() == 0 && !options.page.before.empty())
      out << kNoOlderOnes;
    else
      PrintSessions(document, out);
    PrintNextPage(document, command, out);
  };
  return Answer(context, {"sessions", JsonObject(parameters), print, {}});
}

}  // namespace

void AddSessions(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("sessions", "List the capture sessions of all robots, or of one");
  auto options = std::make_shared<SessionsOptions>();
  verb->add_option("ROBOT", options->robot, "Only this robot's");
  AddPageOptions(*verb, options->page, "sessions", "the whole id of a session");
  verb->footer(
      "FILES: on the server's disk / in all. JOBS: sensor pairs done / in all. --json has the whole session ids.\n"
      "A superseded session does not count: another one of the same pictures was pushed, or restored, after it. Nor "
      "does a\n"
      "retired one: somebody took it out with `rigcal retire`.\n"
      "Examples:\n"
      "  rigcal sessions\n"
      "  rigcal sessions mapper-01 --limit 20\n");
  verb->callback([&context, options] { context.exit_code = RunSessions(context, *options); });
}

}  // namespace rigcal::client
