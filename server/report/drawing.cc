#include "server/report/drawing.h"

#include <algorithm>

#include "server/report/text.h"

namespace rigcal::report {

std::string FillGraph(Dictionary& svg, const formats::RevisionInput& revision, const std::vector<ShownEdge>& edges) {
  const std::size_t sensors = revision.solution.poses.size();
  const bool has_links = sensors <= kRingMax && std::any_of(edges.begin(), edges.end(), [](const ShownEdge& shown) {
                           return shown.detailed;
                         });
  svg.SetValue("ROLE", has_links ? "group" : "img");
  svg.SetValue("LABEL", "Sensor graph: " + Count(sensors, "sensor", "sensors") + ", " +
                            Count(revision.edges.size(), "edge", "edges"));
  return sensors > kRingMax ? FillMap(svg, revision, edges) : FillRing(svg, revision, edges);
}

std::string RenderGraphSvg(const formats::RevisionInput& revision) {
  Dictionary svg("graph");
  FillGraph(svg, revision, InOrder(revision));
  return Expand("graph.tpl", svg).value_or("");
}

}  // namespace rigcal::report
