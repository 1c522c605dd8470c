#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "client/ask/report_zip.h"
#include "client/positive.h"
#include "client/text/table.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

struct ReportOptions {
  std::string robot, out;
  int revision = 0;
};

struct Place {
  std::int64_t revision = 0;
  std::string address, file;
  std::string missing;  // why the server that answers does not have it yet; empty: it has
  std::optional<ZipSummary> zip;
};

Result<std::int64_t> KnownRevision(Connection& connection, const Context& context, const ReportOptions& options) {
  RIGCAL_ASSIGN(const Document revisions,
                connection.AskDocument("revisions", JsonObject({{"robot", options.robot}}), context.timeout));
  std::int64_t newest = 0;
  for (const Document& row : revisions["revisions"].Items()) {
    const std::int64_t number = row["revision"].Integer().value_or(0);
    if (number == options.revision) return number;
    newest = std::max(newest, number);
  }
  if (options.revision == 0 && newest > 0) return newest;
  const std::string which = options.revision > 0 ? "revision " + std::to_string(options.revision) : "revision yet";
  return Fail(ErrorCode::kNotFound, "robot '" + options.robot + "' has no " + which,
              "`rigcal robots` shows each robot's newest one");
}

// Asked for, a report that was pruned is drawn again.
Result<std::string> WhyNotThereYet(Connection& connection, const Context& context, const std::string& robot,
                                   std::int64_t revision) {
  const auto files =
      connection.AskDocument("report_files", JsonObject({{"robot", robot}, {"revision", revision}}), context.timeout);
  if (files) return std::string();
  if (files.error().code != ErrorCode::kBusy) return Fail(files.error());
  return files.error().what;
}

Result<Place> Find(const Context& context, const ReportOptions& options) {
  RIGCAL_ASSIGN(const auto participant, wire::Participant::Open(context.dds));
  RIGCAL_ASSIGN(auto connection, Connection::Open(participant, context.dds));
  Place place;
  RIGCAL_ASSIGN(place.revision, KnownRevision(connection, context, options));
  RIGCAL_ASSIGN(const Document status,
                connection.AskDocument("status", JsonObject({{"robot", options.robot}}), context.timeout));
  place.address = ReportAddress(status, options.robot, place.revision);
  place.file = "reports/" + options.robot + "/" + std::to_string(place.revision) + "/index.html";
  if (options.out.empty()) {
    RIGCAL_ASSIGN(place.missing, WhyNotThereYet(connection, context, options.robot, place.revision));
    return place;
  }
  RIGCAL_ASSIGN(place.zip, WriteReportZip(connection, context.timeout, options.robot, place.revision, options.out));
  return place;
}

ExitCode RunReport(const Context& context, const ReportOptions& options) {
  const auto place = Find(context, options);
  if (!place) return Report(place.error(), context);
  if (context.json) {
    context.out << JsonObject({{"address", place->address},
                               {"file_in_data_folder", place->file},
                               Field::Raw("is_there", place->missing.empty() ? "true" : "false"),
                               options.out.empty() ? Field::Raw("zip", "null") : Field("zip", options.out),
                               {"revision", place->revision},
                               {"robot", options.robot}})
                << std::endl;
    return ExitCode::kGood;
  }
  if (place->address.empty())
    context.out << "The server has no HTTP address (`rigcald --http HOST:PORT` gives it one).\n";
  else
    context.out << "address  " << place->address << '\n';
  context.out << "file     " << place->file << "  (in the server's data folder; opens from disk)\n";
  if (!place->missing.empty())
    context.out << "It is not there yet: " << place->missing << ". Ask for it again in a few seconds.\n";
  if (place->zip)
    context.out << "zip      " << options.out << "  (" << place->zip->files
                << " files; unpack it and open index.html)\n";
  return ExitCode::kGood;
}

}  // namespace

void AddReport(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("report", "Tell where a robot's report is, or fetch it as a zip");
  auto options = std::make_shared<ReportOptions>();
  verb->add_option("ROBOT", options->robot, "The robot's id")->required();
  verb->add_option("--revision", options->revision, "A numbered revision (default: the newest)")
      ->check(Positive())
      ->type_name("N");
  verb->add_option("--out", options->out, "Write the whole report into this zip: it opens without the server")
      ->type_name("FILE.zip");
  verb->footer(
      "Examples:\n"
      "  rigcal report mapper-01\n"
      "  rigcal report mapper-01 --revision 3\n"
      "  rigcal report mapper-01 --out mapper-01.zip\n"
      "  xdg-open \"$(rigcal report mapper-01 --json | jq -r .address)\"\n");
  verb->callback([&context, options] { context.exit_code = RunReport(context, *options); });
}

}  // namespace rigcal::client
