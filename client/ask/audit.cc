#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "client/page_options.h"
#include "client/positive.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "server/base/limits.h"

namespace rigcal::client {
namespace {

constexpr const char* kVerifyWord = "verify";

struct AuditOptions {
  std::string what, robot;
  std::int64_t limit = 20, before = 0;
};

// Of the document that was decided about, as its first digits; empty: it is no decision.
std::string DigestIn(const Document& row) { return row["digest"].Text().substr(0, 12); }

void PrintAudit(const Document& document, const AuditOptions& options, std::ostream& out) {
  const std::vector<Document> rows = document["rows"].Items();
  if (rows.empty()) out << (options.before > 0 ? kNoOlderOnes : "Nobody has decided anything yet.\n");
  if (rows.empty()) return;
  const bool any = std::any_of(rows.begin(), rows.end(), [](const Document& row) { return !DigestIn(row).empty(); });
  std::vector<Column> columns = {{"NUMBER", Align::kRight}, {"AT"}, {"WHO"}, {"WHAT"}};
  if (any) columns.insert(columns.end() - 1, Column{"DIGEST"});
  Table table(columns);
  for (const Document& row : rows) {
    std::vector<std::string> cells = {CountOf(row["number"]), row["at"].Text("-"), row["who"].Text("?"),
                                      row["what"].Text("?")};
    if (any) cells.insert(cells.end() - 1, DigestIn(row));
    table.Add(std::move(cells));
  }
  table.Print(out);
  const std::string robot = options.robot.empty() ? "" : " " + options.robot;
  PrintNextPage(document, "rigcal audit" + robot + " --limit " + std::to_string(options.limit), out);
}

std::string FromBeforeText(const Document& document) {
  const std::int64_t rows = document["from_before"].Integer().value_or(0);
  if (rows == 0) return "";
  return std::to_string(rows) + " decisions, standings, policies, rig models and board measures are from before the " +
         "audit held each: it holds them together, as they were then.\n";
}

std::string WithoutDigestText(const Document& document) {
  const std::int64_t decisions = document["without_digest"].Integer().value_or(0);
  if (decisions == 0) return "";
  return std::to_string(decisions) + (decisions == 1 ? " decision is" : " decisions are") +
         " from before decisions held what they are about: the number of its revision is held, not its poses.\n";
}

// Those that are not told yet.
void PrintRowFaults(const Document& document, std::size_t told, std::ostream& out) {
  const std::vector<Document> faults = document["row_faults"].Items();
  for (std::size_t i = told; i < faults.size(); ++i) out << "! " << Plain(faults[i]["what"].Text("?")) << ".\n";
  const std::int64_t total = document["row_faults_total"].Integer().value_or(0);
  if (total > static_cast<std::int64_t>(faults.size()))
    out << "! " << total - static_cast<std::int64_t>(faults.size()) << " more do not hold either.\n";
}

void PrintAuditCheck(const Document& document, std::ostream& out) {
  const Document fault = document["fault"], head = document["head"];
  const std::string rows = CountOf(document["rows"]);
  if (!fault.IsNull()) {
    const bool chain_holds = document["chain_holds"].Flag();
    const std::string before = rows == "0"   ? ""
                               : chain_holds ? " Its " + rows + " rows are as they were written."
                                             : " The " + rows + " before it are as they were written.";
    out << "The audit does not hold: " << Plain(fault["what"].Text("?")) << '.' << before
        << " Compare it with a backup, and find out who can write to the server's disk.\n";
    PrintRowFaults(document, chain_holds ? 1 : 0, out);
    return;
  }
  out << "The audit is as it was written: " << rows << (rows == "1" ? " row" : " rows")
      << ", each with the hash of the one before.\n"
      << FromBeforeText(document) << WithoutDigestText(document) << "head  " << CountOf(head["number"]) << ' '
      << Plain(head["hash"].Text("?")) << '\n'
      << "That the newest rows were cut off is seen only by a head that is kept elsewhere: note it down.\n";
}

ExitCode RunVerify(const Context& context) {
  return Answer(context, {"audit_verify", "{}", PrintAuditCheck, [](const Document& document) {
                            return document["fault"].IsNull() ? ExitCode::kGood : ExitCode::kVerdictFail;
                          }});
}

ExitCode RunAudit(const Context& context, const AuditOptions& options) {
  std::vector<Field> parameters = {{"limit", options.limit}};
  if (!options.robot.empty()) parameters.emplace_back("robot", options.robot);
  if (options.before > 0) parameters.emplace_back("before", options.before);
  const auto print = [&](const Document& document, std::ostream& out) { PrintAudit(document, options, out); };
  return Answer(context, {"audit", JsonObject(parameters), print, {}});
}

}  // namespace

void AddAudit(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("audit", "List who decided what, or verify that nobody has changed that list");
  auto options = std::make_shared<AuditOptions>();
  verb->add_option("ROBOT", options->what, "Only what is about this robot; or the word verify");
  verb->add_option("--robot", options->robot, "The same, of a robot that is called verify")->type_name("ID");
  CLI::Option* limit = verb->add_option("--limit", options->limit, "So many rows, the newest first (default 20)")
                           ->type_name("N")
                           ->check(CLI::Range(std::int64_t{1}, limits::kPageRowsMax));
  CLI::Option* before =
      verb->add_option("--before", options->before, "Only those before this row")->type_name("N")->check(Positive());
  verb->footer(
      "Every decision of a person or a policy is a row that is never changed, and holds the hash of the row before "
      "it.\n"
      "DIGEST: of the document that was decided about, as `rigcal show ROBOT --json` has it.\n"
      "`verify` walks through all and names the first that does not hold: exit code 1, else 0. That the newest rows "
      "were\n"
      "cut off no chain can tell: keep the head that it prints elsewhere, and compare.\n"
      "Examples:\n"
      "  rigcal audit\n"
      "  rigcal audit mapper-01 --limit 50\n"
      "  rigcal audit verify\n");
  verb->callback([&context, options, limit, before] {
    const bool verifies = options->what == kVerifyWord;
    if (!options->what.empty() && !options->robot.empty()) throw CLI::ExcludesError("--robot", options->what);
    if (verifies && limit->count() + before->count() > 0) throw CLI::ExcludesError("verify", "--limit and --before");
    if (options->robot.empty()) options->robot = options->what;
    context.exit_code = verifies ? RunVerify(context) : RunAudit(context, *options);
  });
}

}  // namespace rigcal::client
