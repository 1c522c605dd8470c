#include <CLI/CLI.hpp>
#include <memory>

#include "client/table.h"
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

void PrintStatus(const Document& document, std::ostream& out) {
  PrintServer(document, out);
  PrintOpenBatches(document, out);
  if (document["robots"].size() == 0) out << "No robot is known yet. Send a session with `rigcal push DIR`.\n";
  if (document["robots"].size() == 0) return;
  Table table({{"ROBOT"}, {"REVISION", Align::kRight}, {"AGE", Align::kRight}, {"JOBS", Align::kRight}, {"VERDICT"}});
  for (const Document& row : document["robots"].Items())
    table.Add({row["robot"].Text("?"), CountOf(row["revision"]), AgeOf(row["age_ns"]), CountOf(row["jobs_waiting"]),
               OverdueBefore(row) + VerdictText(row["verdict"])});
  table.Print(out);
}

}  // namespace

void AddStatus(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("status", "Show what the server is doing, and each robot's verdict in words");
  auto robot = std::make_shared<std::string>();
  verb->add_option("ROBOT", *robot, "Only this robot");
  verb->footer("Of one robot: " + std::string(kVerdictCodes) +
               "Of all robots 0, whatever their verdicts.\n"
               "Examples:\n"
               "  rigcal status\n"
               "  rigcal status mapper-01\n"
               "  rigcal status --timeout 1 && echo a server is there\n");
  verb->callback([&context, robot] {
    const std::string parameters = robot->empty() ? "{}" : JsonObject({{"robot", *robot}});
    const auto judge = [](const Document& document) {
      const Document row = document["robots"][std::size_t{0}];
      return Judge(row["verdict"], row);
    };
    context.exit_code = robot->empty() ? Answer(context, {"status", parameters, PrintStatus, {}})
                                       : Answer(context, {"status", parameters, PrintStatus, judge});
  });
}

}  // namespace rigcal::client
