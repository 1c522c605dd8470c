#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/text/table.h"
#include "client/verbs.h"
#include "server/base/stamp.h"

namespace rigcal::client {
namespace {

// Calibrated, and older than it may be.
bool IsOverdue(const Document& row) { return row["overdue"].Flag() && !row["calibrated_at"].IsNull(); }

// Nothing that it has counts: there is no date that it could be late by.
bool IsNotCalibrated(const Document& row) { return row["overdue"].Flag() && row["calibrated_at"].IsNull(); }

bool Any(const Document& document, bool (*is_so)(const Document&)) {
  const auto rows = document["robots"].Items();
  return std::any_of(rows.begin(), rows.end(), is_so);
}

// A robot that is overdue by the age that was asked for alone may be all right otherwise.
std::string StepOfOverdue(const Document& status) {
  const bool asks = status["word"].Text("ok") != "ok";
  return asks ? status["next_step"].Text("-") : "Capture a session and push it.";
}

void PrintOverdue(const Document& document, std::ostream& out) {
  Table table({{"OVERDUE"}, {"CALIBRATED"}, {"AGE", Align::kRight}, {"VERDICT"}, {"NEXT STEP"}});
  for (const Document& row : document["robots"].Items())
    if (IsOverdue(row))
      table.Add({row["robot"].Text("?"), row["calibrated_at"].Text("-"), AgeOf(row["age_ns"]),
                 row["verdict"]["level"].Text("unknown"), StepOfOverdue(row["status"])});
  if (!table.empty()) table.Print(out);
}

void PrintNotCalibrated(const Document& document, std::ostream& out) {
  Table table({{"NOT CALIBRATED"}, {"VERDICT"}, {"NEXT STEP"}});
  for (const Document& row : document["robots"].Items())
    if (IsNotCalibrated(row))
      table.Add({row["robot"].Text("?"), row["verdict"]["level"].Text("unknown"), StepOfOverdue(row["status"])});
  if (!table.empty()) table.Print(out);
}

// `site` empty: of the whole fleet.
void PrintDue(const Document& document, const std::string& site, std::ostream& out) {
  const bool all_calibrated = !Any(document, IsNotCalibrated);
  if (!Any(document, IsOverdue))
    out << "No robot is overdue: " << document["robots"].size() << " known" << (site.empty() ? "" : " at " + site)
        << (all_calibrated ? ", all calibrated within " : "; those that are calibrated are so within ")
        << (document["max_age_ns"].IsNull() ? "the time that their policies allow" : AgeOf(document["max_age_ns"]))
        << ".\n";
  PrintOverdue(document, out);
  PrintNotCalibrated(document, out);
}

// Those that are due soon, by their age or by the drift of a sensor.
void PrintSoon(const Document& document, std::ostream& out) {
  Table table({{"DUE"}, {"BY"}, {"DATES"}, {"SITE"}});
  bool any = false;
  for (const Document& row : document["robots"].Items()) {
    if (IsOverdue(row) || row["status"]["word"].Text() != "due") continue;
    const Document due = row["due"];
    table.Add({row["robot"].Text("?"), DayOf(due["at"]), due["text"].Text("-"), row["site"].Text("-")});
    any = true;
  }
  if (any) table.Print(out);
}

// Those that somebody has to see to whatever the date: moved, failed, not known, to be approved or to be applied.
void PrintOthers(const Document& document, std::ostream& out) {
  Table table({{"ALSO"}, {"STATUS"}, {"NEXT STEP"}, {"WHY"}});
  for (const Document& row : document["robots"].Items()) {
    const Document status = row["status"];
    const std::string word = status["word"].Text("ok");
    const bool to_mend = word == "ok" && row["verdict"]["level"].Text() == "warn";
    if (row["overdue"].Flag() || (word == "ok" && !to_mend) || word == "due" || word == "overdue") continue;
    table.Add({row["robot"].Text("?"), to_mend ? "to mend" : word, status["next_step"].Text("-"),
               (to_mend ? row["verdict"] : status)["why"].Text("-")});
  }
  if (!table.empty()) table.Print(out);
}

// Without an age the policy of each robot decides.
ExitCode AskDue(const Context& context, const std::optional<std::int64_t>& max_age_ns, const std::string& site) {
  std::vector<Field> asked;
  if (max_age_ns) asked.emplace_back("max_age_ns", *max_age_ns);
  if (!site.empty()) asked.emplace_back("site", site);
  const auto print = [&site](const Document& document, std::ostream& out) {
    PrintDue(document, site, out);
    PrintSoon(document, out);
    PrintOthers(document, out);
  };
  return Answer(context, {"due", JsonObject(asked), print, [](const Document& document) {
                            return Any(document, IsOverdue) || Any(document, IsNotCalibrated) ? ExitCode::kVerdictFail
                                                                                              : ExitCode::kGood;
                          }});
}

// The calendar as it is: for a file, or for a program that reads it.
ExitCode AskCalendar(const Context& context, const std::string& site) {
  const std::string parameters = site.empty() ? "{}" : JsonObject({{"site", site}});
  const auto print = [](const Document& document, std::ostream& out) { out << document["ics"].Text(); };
  return Answer(context, {"due_ics", parameters, print, {}});
}

struct DueOptions {
  std::string max_age, site;
  bool ics = false;
};

ExitCode RunDue(const Context& context, const DueOptions& options) {
  if (options.max_age.empty()) return AskDue(context, std::nullopt, options.site);
  const auto max_age_ns = ParseDuration(options.max_age);
  if (!max_age_ns) {
    Report(max_age_ns.error(), context);
    return ExitCode::kUsage;
  }
  return AskDue(context, *max_age_ns, options.site);
}

}  // namespace

void AddDue(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("due", "List the robots whose calibration is older than an age");
  auto options = std::make_shared<DueOptions>();
  CLI::Option* max_age =
      verb->add_option("--max-age", options->max_age,
                       "Oldest age that is good: 90d, 12h, 30m, 45s (default: as the policies say, else 90d)")
          ->type_name("AGE");
  verb->add_flag("--ics", options->ics, "Print the due dates as a calendar (RFC 5545)")->excludes(max_age);
  verb->add_option("--site", options->site, "Only robots of this site, as session.yaml names it under conditions")
      ->type_name("SITE");
  verb->footer(
      "Exit code 1 if any is, or if any is not calibrated: nothing that it has counts. --json lists all robots.\n"
      "With --site all of that is of the robots there; a site at which no robot is, is refused.\n"
      "Below stand those that are due within a week, or were by the drift of a sensor, then those that moved, failed,\n"
      "are not known, wait for approval, or run something else than what is in use, whatever their date.\n"
      "Server: /due.ics\n"
      "Examples:\n"
      "  rigcal due\n"
      "  rigcal due --site 'hall 3'\n"
      "  rigcal due --ics --site 'hall 3' > due.ics\n"
      "  rigcal due --max-age 30d || mail -s 'robots to calibrate' team@example.org\n");
  verb->callback([&context, options] {
    context.exit_code = options->ics ? AskCalendar(context, options->site) : RunDue(context, *options);
  });
}

}  // namespace rigcal::client
