#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "client/positive.h"
#include "client/verbs.h"
#include "server/base/durable_file.h"
#include "server/formats/documents.h"
#include "server/formats/g2o.h"

namespace rigcal::client {
namespace {

struct ExportOptions {
  std::string robot, out;
  int revision = 0;
};

struct Exported {
  std::int64_t revision = 0;
  std::size_t edges = 0, sensors = 0, in_part = 0;
};

Result<Exported> Export(const Context& context, const ExportOptions& options) {
  if (std::filesystem::path(options.out).extension() != ".g2o")
    return Fail(ErrorCode::kInvalidInput, "the suffix of " + options.out + " names no format", "Let it end in .g2o");
  // Of a server that does not know `whole` every document is.
  std::vector<Field> parameters = {{"robot", options.robot}, Field::Raw("whole", "true")};
  if (options.revision > 0) parameters.emplace_back("revision", std::int64_t{options.revision});
  RIGCAL_ASSIGN(const std::string text, AskOnce(context, "show", JsonObject(parameters)));
  RIGCAL_ASSIGN(const Document shown, Document::Parse(text, "the server's answer"));
  RIGCAL_ASSIGN(const formats::RevisionInput revision, formats::ReadRevisionDocument(shown["document"].Dump()));
  if (!revision.whole)
    return Fail(ErrorCode::kUnsupported, "the server's document has no information matrices", "Install a newer rigcald.");
  RIGCAL_ASSIGN(const std::string g2o, formats::WriteG2o(revision.edges, revision.solution.poses, revision.reference));
  RIGCAL_TRY(WriteDurably(options.out, g2o));
  Exported exported{shown["revision"].Integer().value_or(0)};
  for (const Edge& edge : revision.edges) exported.edges += edge.state == EdgeState::kGood ? 1 : 0;
  for (const SensorPose& pose : revision.solution.poses) {
    exported.sensors += pose.known ? 1 : 0;
    exported.in_part += pose.measured_part ? 1 : 0;
  }
  return exported;
}

void PrintExported(const Exported& exported, const std::string& file, std::ostream& out) {
  out << file << ": " << exported.edges << " edges and " << exported.sensors << " poses of revision " << exported.revision << '\n';
  if (exported.in_part > 0)
    out << "beside them " << exported.in_part << (exported.in_part == 1 ? " pose" : " poses")
        << " of which not every direction was measured: a comment before each in the file says which\n";
}

ExitCode RunExport(const Context& context, const ExportOptions& options) {
  const auto exported = Export(context, options);
  if (!exported) return Report(exported.error(), context);
  if (context.json)
    context.out << JsonObject({{"edges", static_cast<std::int64_t>(exported->edges)},
                               {"file", options.out},
                               {"revision", exported->revision},
                               {"robot", options.robot},
                               {"sensors", static_cast<std::int64_t>(exported->sensors)},
                               {"sensors_in_part", static_cast<std::int64_t>(exported->in_part)}})
                << std::endl;
  else
    PrintExported(*exported, options.out, context.out);
  return ExitCode::kGood;
}

}  // namespace

void AddExport(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("export", "Write a robot's graph into a file for other programs");
  auto options = std::make_shared<ExportOptions>();
  verb->add_option("ROBOT", options->robot, "The robot's id")->required();
  verb->add_option("--out", options->out, "The file; its suffix names the format, which is g2o")
      ->required()
      ->type_name("FILE.g2o");
  verb->add_option("--revision", options->revision, "A numbered revision (default: the newest)")
      ->check(Positive())
      ->type_name("N");
  verb->footer(
      "Good edges with their information, and the solved poses; before one of which a direction was not measured a comment "
      "says so. `rigcal push-edges` reads it back, number by number.\n"
      "Examples:\n"
      "  rigcal export mapper-01 --out mapper-01.g2o\n"
      "  rigcal export mapper-01 --revision 3 --out before.g2o\n");
  verb->callback([&context, options] { context.exit_code = RunExport(context, *options); });
}

}  // namespace rigcal::client
