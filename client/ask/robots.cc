#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>

#include "client/positive.h"
#include "client/text/table.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

struct PartOptions {
  std::int64_t limit = 0;  // 0: all
  std::string after;
};

std::string PartParameters(const PartOptions& options) {
  std::vector<Field> parameters;
  if (options.limit > 0) parameters.emplace_back("limit", options.limit);
  if (!options.after.empty()) parameters.emplace_back("after", options.after);
  return JsonObject(parameters);
}

void PrintNone(const PartOptions& options, std::ostream& out) {
  if (!options.after.empty()) out << "No robot comes after " << Plain(options.after) << ".\n";
  if (options.after.empty()) out << "No robot is known yet. Send a session with `rigcal push DIR`.\n";
}

// Columns of names: there where a robot has one. The member's name, and the title.
constexpr std::array<std::pair<const char*, const char*>, 3> kNames = {
    {{"rig_model", "MODEL"}, {"site", "SITE"}, {"operator", "OPERATOR"}}};

std::vector<std::string> NamesIn(const std::vector<Document>& rows, std::vector<Column>& columns) {
  std::vector<std::string> members;
  for (const auto& [member, title] : kNames) {
    const bool any = std::any_of(rows.begin(), rows.end(), [&](const Document& row) { return !row[member].IsNull(); });
    if (any) columns.push_back({title}), members.emplace_back(member);
  }
  return members;
}

void PrintRobots(const Document& document, const PartOptions& options, std::ostream& out) {
  if (document["robots"].size() == 0) return PrintNone(options, out);
  const std::vector<Document> rows = document["robots"].Items();
  std::vector<Column> columns = {{"ROBOT"},
                                 {"VERDICT"},
                                 {"REVISION", Align::kRight},
                                 {"AGE", Align::kRight},
                                 {"DUE", Align::kRight},
                                 {"SESSIONS", Align::kRight},
                                 {"EDGES", Align::kRight},
                                 {"JOBS", Align::kRight},
                                 {"STATUS"},
                                 {"DRIVE"}};
  const std::vector<std::string> names = NamesIn(rows, columns);
  Table table(columns);
  for (const Document& row : rows) {
    std::vector<std::string> cells = {
        row["robot"].Text("?"),          OverdueBefore(row) + row["verdict"]["level"].Text("unknown"),
        CountOf(row["revision"]),        AgeOf(row["age_ns"]),
        DayOf(row["due"]["at"]),         CountOf(row["sessions"]),
        CountOf(row["edges"]),           CountOf(row["jobs_waiting"]),
        row["status"]["word"].Text("-"), DriveText(row)};
    for (const std::string& member : names) cells.push_back(row[member].Text());
    table.Add(std::move(cells));
  }
  table.Print(out);
  const std::string next = Plain(document["next"].Text());
  if (!next.empty()) out << "More: rigcal robots --limit " << options.limit << " --after " << next << '\n';
}

}  // namespace

void AddRobots(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("robots", "List the robots with their verdict and the age of their calibration");
  auto options = std::make_shared<PartOptions>();
  verb->add_option("--limit", options->limit, "List so many of them, by id (default: all)")
      ->check(Positive())
      ->type_name("N");
  verb->add_option("--after", options->after, "Begin after this robot")->type_name("ROBOT");
  verb->footer(
      "Exit code 0, whatever the verdicts: `rigcal show ROBOT` ends with that of one robot.\n"
      "Examples:\n"
      "  rigcal robots\n"
      "  rigcal robots --json\n"
      "  rigcal robots --limit 100 --after mapper-0099\n");
  verb->callback([&context, options] {
    const auto print = [options](const Document& document, std::ostream& out) { PrintRobots(document, *options, out); };
    context.exit_code = Answer(context, {"robots", PartParameters(*options), print, {}});
  });
}

}  // namespace rigcal::client
