#include <CLI/CLI.hpp>
#include <memory>

#include "client/table.h"
#include "client/verbs.h"
#include "server/base/stamp.h"

namespace rigcal::client {
namespace {

bool AnyOverdue(const Document& document) {
  for (const Document& row : document["robots"].Items())
    if (row["overdue"].Flag()) return true;
  return false;
}

void PrintDue(const Document& document, std::ostream& out) {
  if (!AnyOverdue(document)) {
    out << "No robot is overdue: " << document["robots"].size() << " known, all calibrated within "
        << (document["max_age_ns"].IsNull() ? "the time that their policies allow" : AgeOf(document["max_age_ns"]))
        << ".\n";
    return;
  }
  Table table({{"OVERDUE"}, {"CALIBRATED"}, {"AGE", Align::kRight}, {"VERDICT"}});
  for (const Document& row : document["robots"].Items())
    if (row["overdue"].Flag())
      table.Add({row["robot"].Text("?"), row["calibrated_at"].Text("never"), AgeOf(row["age_ns"]),
                 row["verdict"]["level"].Text("unknown")});
  table.Print(out);
}

ExitCode AskDue(const Context& context, const std::string& parameters) {
  return Answer(context, {"due", parameters, PrintDue, [](const Document& document) {
                            return AnyOverdue(document) ? ExitCode::kVerdictFail : ExitCode::kGood;
                          }});
}

// Without an age the policy of each robot decides.
ExitCode RunDue(const Context& context, const std::string& max_age) {
  if (max_age.empty()) return AskDue(context, "{}");
  const auto max_age_ns = ParseDuration(max_age);
  if (!max_age_ns) {
    Report(max_age_ns.error(), context);
    return ExitCode::kUsage;
  }
  return AskDue(context, JsonObject({{"max_age_ns", *max_age_ns}}));
}

}  // namespace

void AddDue(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("due", "List the robots whose calibration is older than an age");
  auto max_age = std::make_shared<std::string>();
  verb->add_option("--max-age", *max_age,
                   "Oldest age that is good: 90d, 12h, 30m, 45s (default: as the policies say, else 90d)")
      ->type_name("AGE");
  verb->footer(
      "A robot that was never calibrated is overdue. Exit code 1 if any is; --json lists all robots.\n"
      "Examples:\n"
      "  rigcal due\n"
      "  rigcal due --max-age 30d || mail -s 'robots to calibrate' team@example.org\n");
  verb->callback([&context, max_age] { context.exit_code = RunDue(context, *max_age); });
}

}  // namespace rigcal::client
