#include "client/exchange/graph_export.h"

#include "server/base/files/durable_file.h"
#include "server/formats/documents.h"
#include "server/formats/edges/g2o.h"

namespace rigcal::client {
namespace {

struct ExportedGraph {
  std::int64_t revision = 0;
  std::size_t edges = 0, sensors = 0, in_part = 0;
};

Result<ExportedGraph> WriteGraph(const Context& context, const GraphExport& wanted) {
  // Of a server that does not know `whole` every document is.
  std::vector<Field> parameters = {{"robot", wanted.robot}, Field::Raw("whole", "true")};
  if (wanted.revision > 0) parameters.emplace_back("revision", std::int64_t{wanted.revision});
  RIGCAL_ASSIGN(const std::string text, AskOnce(context, "show", JsonObject(parameters)));
  RIGCAL_ASSIGN(const Document shown, Document::Parse(text, "the server's answer"));
  RIGCAL_ASSIGN(const formats::RevisionInput revision, formats::ReadRevisionDocument(shown["document"].Dump()));
  if (!revision.whole)
    return Fail(ErrorCode::kUnsupported, "the server's document has no information matrices",
                "Install a newer rigcald.");
  RIGCAL_ASSIGN(const std::string g2o, formats::WriteG2o(revision.edges, revision.solution.poses, revision.reference));
  RIGCAL_TRY(WriteDurably(wanted.file, g2o));
  ExportedGraph exported{shown["revision"].Integer().value_or(0)};
  for (const Edge& edge : revision.edges) exported.edges += edge.state == EdgeState::kGood ? 1 : 0;
  for (const SensorPose& pose : revision.solution.poses) {
    exported.sensors += pose.known ? 1 : 0;
    exported.in_part += pose.measured_part ? 1 : 0;
  }
  return exported;
}

void PrintExportedGraph(const ExportedGraph& exported, const std::string& file, std::ostream& out) {
  out << file << ": " << exported.edges << " edges and " << exported.sensors << " poses of revision "
      << exported.revision << '\n';
  if (exported.in_part > 0)
    out << "beside them " << exported.in_part << (exported.in_part == 1 ? " pose" : " poses")
        << " of which not every direction was measured: a comment before each in the file says which\n";
}

}  // namespace

ExitCode ExportGraph(const Context& context, const GraphExport& wanted) {
  const auto exported = WriteGraph(context, wanted);
  if (!exported) return Report(exported.error(), context);
  if (context.json)
    context.out << JsonObject({{"edges", static_cast<std::int64_t>(exported->edges)},
                               {"file", wanted.file},
                               {"revision", exported->revision},
                               {"robot", wanted.robot},
                               {"sensors", static_cast<std::int64_t>(exported->sensors)},
                               {"sensors_in_part", static_cast<std::int64_t>(exported->in_part)}})
                << std::endl;
  else
    PrintExportedGraph(*exported, wanted.file, context.out);
  return ExitCode::kGood;
}

}  // namespace rigcal::client
