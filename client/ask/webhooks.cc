#include <CLI/CLI.hpp>

#include "client/text/table.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

// What became of the newest attempt, and when the next one is.
std::string TroubleOf(const Document& row) {
  const std::string error = row["last_error"].Text();
  if (!row["configured"].Flag()) return "not configured any more: what waits is sent when it is again";
  if (error.empty()) return "-";
  const std::string next = row["next_try_at"].Text();
  return error + (next.empty() ? "" : "; next try " + next);
}

void PrintWebhooks(const Document& document, std::ostream& out) {
  const std::vector<Document> rows = document["webhooks"].Items();
  if (rows.empty()) out << "No webhook is configured: rigcald --webhook URL --webhook-secret-file FILE\n";
  if (rows.empty()) return;
  Table table({{"WEBHOOK"},
               {"WAITING", Align::kRight},
               {"DELIVERED", Align::kRight},
               {"OLDEST"},
               {"ATTEMPTS", Align::kRight},
               {"LAST ERROR"}});
  for (const Document& row : rows)
    table.Add({row["url"].Text("?"), CountOf(row["waiting"]), CountOf(row["delivered"]), row["oldest_at"].Text("-"),
               CountOf(row["attempts"]), TroubleOf(row)});
  table.Print(out);
}

bool AnyTrouble(const Document& document) {
  for (const Document& row : document["webhooks"].Items())
    if (!row["last_error"].IsNull()) return true;
  return false;
}

}  // namespace

void AddWebhooks(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("webhooks", "List who is told of changes by HTTP, and what waits for them");
  verb->footer(
      "What waits is never dropped: it goes out when its receiver answers with HTTP status 200 to 299. Exit code 1 if "
      "one\n"
      "did not take what was sent last, else 0. docs/alerts.md tells receivers what they get.\n"
      "Examples:\n"
      "  rigcal webhooks\n"
      "  rigcal webhooks --json\n");
  verb->callback([&context] {
    context.exit_code = Answer(context, {"webhooks", "{}", PrintWebhooks, [](const Document& document) {
                                           return AnyTrouble(document) ? ExitCode::kVerdictFail : ExitCode::kGood;
                                         }});
  });
}

}  // namespace rigcal::client
