#include "server/formats/documents.h"
#include "server/formats/edges/edge_fields.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kEdgeBytesMax = 256u << 20;

}  // namespace

std::string WriteEdge(const Edge& edge) {
  return WriteObject([&](JsonWriter& out) {
    WriteEdgeSummary(out, edge);
    WriteEdgeDetail(out, edge);
    WriteBlocks(out, edge.uncertainty.blocks);
  });
}

Result<Edge> ReadEdge(std::string_view text) {
  const JsonKind kind = {"edge", "Ask for the edge again; docs/api.md describes the document.", kEdgeBytesMax};
  RIGCAL_ASSIGN(JsonDocument document, JsonDocument::Parse(text, kind));
  Edge edge = ReadEdgeFields(document.Root());
  edge.uncertainty.blocks = ReadBlocks(document.Root().At("blocks"));
  RIGCAL_TRY(document.status());
  RIGCAL_TRY(Validate(edge));
  return edge;
}

}  // namespace rigcal::formats
