#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <utility>

#include "client/text/approval_text.h"
#include "client/text/table.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

void PrintServer(const Document& document, std::ostream& out) {
  out << "rigcald " << Plain(document["version"].Text("?")) << ", up " << AgeOf(document["uptime_ns"]) << ", "
      << CountOf(document["jobs_waiting"]) << " jobs waiting";
  const std::string address = Plain(document["http_address"].Text());
  if (!address.empty()) out << ", reports at " << address << "/";
  out << '\n';
  const Document problem = document["problem"];
  if (!problem.IsNull())
    out << "The server is not well: " << Plain(problem["what"].Text()) << ". " << Plain(problem["cure"].Text()) << '\n';
}

void PrintOpenBatches(const Document& document, std::ostream& out) {
  for (const Document& batch : document["open_batches"].Items())
    out << "! " << OpenBatchText(batch) << "\n  -> " << kCompleteBatch << '\n';
}

// "3 robots: 1 do not drive, 2 OK to drive".
void PrintCounts(const std::vector<Document>& rows, std::ostream& out) {
  std::map<DriveKind, int> counts;
  for (const Document& row : rows) ++counts[KindOf(row["verdict"], row)];
  out << rows.size() << (rows.size() == 1 ? " robot:" : " robots:");
  const char* between = " ";
  for (const DriveKind kind : kDriveKinds)
    if (counts[kind] > 0) out << std::exchange(between, ", ") << counts[kind] << ' ' << WordsFor(kind);
  out << '\n';
}

// It may drive and is within its tolerances, with something to mend by a day.
bool IsToMend(const Document& row) {
  return row["status"]["word"].Text() == "ok" && row["verdict"]["level"].Text() == "warn";
}

// Of one robot: its status in words, and of each sensor that is not all right.
void PrintStatusOfOne(const Document& row, std::ostream& out) {
  const auto print = [&](const std::string& of, const Document& status, const std::string& word) {
    out << of << word << ": " << Plain(status["why"].Text()) << ' ' << Plain(status["next_step"].Text()) << '\n';
  };
  const auto word_of = [](const Document& status) { return Plain(status["word"].Text("unknown")); };
  if (row["status"].IsNull()) return;
  print("Status ", row["status"], IsToMend(row) ? "to mend" : word_of(row["status"]));
  for (const Document& sensor : row["sensors"].Items())
    if (const Document status = sensor["status"];
        status["word"].Text() != "ok" && status["why"].Text() != row["status"]["why"].Text())
      print("  " + Plain(sensor["id"].Text("?")) + " ", status, word_of(status));
}

// What may be driven comes first: of one robot its rule, of several how many there are of each kind.
void PrintStatus(const Document& document, bool of_one, std::ostream& out) {
  const std::vector<Document> rows = document["robots"].Items();
  if (of_one && !rows.empty()) PrintDrive(rows.front(), out);
  if (of_one && !rows.empty()) PrintStatusOfOne(rows.front(), out);
  if (!of_one && !rows.empty()) PrintCounts(rows, out);
  PrintServer(document, out);
  PrintOpenBatches(document, out);
  if (document["robots"].size() == 0) out << "No robot is known yet. Send a session with `rigcal push DIR`.\n";
  if (document["robots"].size() == 0) return;
  Table table({{"ROBOT"},
               {"STATUS"},
               {"REVISION", Align::kRight},
               {"AGE", Align::kRight},
               {"JOBS", Align::kRight},
               {"VERDICT"}});
  for (const Document& row : rows) {
    const std::string drive = of_one ? "" : DriveText(row);
    const std::string in_use = InUseText(row), runs = RunsText(row);
    table.Add({row["robot"].Text("?"), IsToMend(row) ? "to mend" : row["status"]["word"].Text("-"),
               CountOf(row["revision"]), AgeOf(row["age_ns"]), CountOf(row["jobs_waiting"]),
               drive + (drive.empty() ? "" : " ") + OverdueBefore(row) + VerdictText(row["verdict"], row) +
                   (in_use.empty() ? "" : " " + in_use) + (runs.empty() ? "" : " " + runs)});
  }
  table.Print(out);
}

ExitCode JudgeAll(const Document& document) {
  ExitCode worst = ExitCode::kGood;
  for (const Document& row : document["robots"].Items()) worst = Worse(worst, Judge(row["verdict"], row));
  return worst;
}

}  // namespace

void AddStatus(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("status", "Show what the server is doing, and each robot's verdict in words");
  auto robot = std::make_shared<std::string>();
  verb->add_option("ROBOT", *robot, "Only this robot");
  verb->footer(std::string(kVerdictCodes) +
               "Of several robots that of the worst: fail, unknown, warn, pass. Without any robot 0.\n"
               "Examples:\n"
               "  rigcal status\n"
               "  rigcal status mapper-01\n");
  verb->callback([&context, robot] {
    const bool of_one = !robot->empty();
    const std::string parameters = of_one ? JsonObject({{"robot", *robot}}) : "{}";
    const auto print = [of_one](const Document& document, std::ostream& out) { PrintStatus(document, of_one, out); };
    context.exit_code = Answer(context, {"status", parameters, print, JudgeAll});
  });
}

}  // namespace rigcal::client
