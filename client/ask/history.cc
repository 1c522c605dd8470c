#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "client/page_options.h"
#include "client/positive.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "server/base/limits.h"
#include "server/model/approval/decision.h"

namespace rigcal::client {
namespace {

struct HistoryOptions {
  std::string robot;
  int limit = 20, before = 0;
};

// "right drifted", "unchanged", "nothing told"; nothing of a revision without a session.
std::string FoundText(const Document& as_found) {
  std::string state = as_found["state"].Text(), names;
  if (state == "not_measured") state = "nothing told";
  for (const Document& sensor : as_found["drifted"].Items()) names += (names.empty() ? "" : ", ") + sensor.Text();
  return names.empty() ? state : names + " " + state;
}

// Of the verdict; after it by what the revision was made, where nothing was measured for it.
std::string WhyText(const Document& revision) {
  const std::string why = revision["verdict"]["why"].Text(), cause = revision["cause"].Text();
  return cause.empty() ? why : why + " (" + cause + ")";
}

// When what was measured of a sensor became past, and why; the newest first.
void PrintEpochs(const Document& document, std::ostream& out) {
  const std::vector<Document> epochs = document["epochs"].Items();
  if (epochs.empty()) return;
  Table table({{"EPOCH FROM"}, {"SENSOR"}, {"WHY"}});
  for (const Document& epoch : epochs)
    table.Add({epoch["begins_at"].Text("-"), epoch["sensor"].Text("?"), Plain(epoch["text"].Text())});
  out << '\n';
  table.Print(out);
}

void PrintHistory(const Document& document, const HistoryOptions& options, std::ostream& out) {
  const std::vector<Document> revisions = document["revisions"].Items();
  if (revisions.empty()) PrintEpochs(document, out);
  const char* none =
      options.before > 0 ? kNoOlderOnes : "There is no revision yet. Send a session with `rigcal push DIR`.\n";
  if (revisions.empty()) out << none;
  if (revisions.empty()) return;
  const auto is_found = [](const Document& revision) { return !FoundText(revision["as_found"]).empty(); };
  const bool found = std::any_of(revisions.begin(), revisions.end(), is_found);
  std::vector<Column> columns = {{"REVISION", Align::kRight}, {"SOLVED"}, {"VERDICT"}, {"STATE"}, {"WHY"}};
  if (found) columns.insert(columns.end() - 1, {"AS FOUND"});
  Table table(columns);
  for (const Document& revision : revisions) {
    std::vector<std::string> cells = {CountOf(revision["revision"]), revision["created_at"].Text("-"),
                                      revision["verdict"]["level"].Text("unknown"),
                                      WordFor(RevisionStateOf(revision["state"].Text())), WhyText(revision)};
    if (found) cells.insert(cells.end() - 1, FoundText(revision["as_found"]));
    table.Add(cells);
  }
  table.Print(out);
  PrintEpochs(document, out);
  PrintNextPage(document, "rigcal history " + options.robot + " --limit " + std::to_string(options.limit), out);
}

ExitCode RunHistory(const Context& context, const HistoryOptions& options) {
  std::vector<Field> parameters = {{"robot", options.robot}, {"limit", std::int64_t{options.limit}}};
  if (options.before > 0) parameters.emplace_back("before", std::int64_t{options.before});
  const auto print = [&](const Document& document, std::ostream& out) { PrintHistory(document, options, out); };
  return Answer(context, {"revisions", JsonObject(parameters), print, {}});
}

}  // namespace

void AddHistory(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("history",
                                      "List a robot's revisions with their verdicts and what their newest session "
                                      "found, and epochs of its sensors, the newest first");
  auto options = std::make_shared<HistoryOptions>();
  verb->add_option("ROBOT", options->robot, "The robot's id")->required();
  verb->add_option("--limit", options->limit, "So many revisions (default 20)")
      ->type_name("N")
      ->check(CLI::Range(std::int64_t{1}, limits::kPageRowsMax));
  verb->add_option("--before", options->before, "Only those before this revision")->type_name("N")->check(Positive());
  verb->footer(
      "Exit code 0, whatever the verdicts: `rigcal show ROBOT --revision N` ends with that of one revision.\n"
      "Examples:\n"
      "  rigcal history mapper-01\n"
      "  rigcal history mapper-01 --limit 50 --before 471\n"
      "  rigcal history mapper-01 --json\n");
  verb->callback([&context, options] { context.exit_code = RunHistory(context, *options); });
}

}  // namespace rigcal::client
