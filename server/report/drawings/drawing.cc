#include "server/report/drawings/drawing.h"

#include <algorithm>

#include "server/model/edges/past.h"
#include "server/report/text/text.h"

namespace rigcal::report {

// What does not count is not drawn.
std::string FillGraph(Dictionary& svg, const formats::RevisionInput& revision, std::vector<ShownEdge> edges) {
  std::erase_if(edges, [](const ShownEdge& shown) { return IsPast(*shown.edge); });
  const std::size_t past = revision.edges.size() - edges.size();
  const std::size_t sensors = revision.solution.poses.size();
  const bool has_links = sensors <= kRingMax &&
                         std::any_of(edges.begin(), edges.end(), [](const ShownEdge& shown) { return shown.detailed; });
  svg.SetValue("ROLE", has_links ? "group" : "img");
  svg.SetValue("LABEL",
               "Sensor graph: " + Count(sensors, "sensor", "sensors") + ", " + Count(edges.size(), "edge", "edges"));
  const std::string note = sensors > kRingMax ? FillMap(svg, revision, edges) : FillRing(svg, revision, edges);
  return past == 0 ? note : note + " " + Count(past, "past edge is", "past edges are") + " not drawn.";
}

std::string RenderGraphSvg(const formats::RevisionInput& revision) {
  Dictionary svg("graph");
  FillGraph(svg, revision, InOrder(revision));
  return Expand("graph.tpl", svg).value_or("");
}

}  // namespace rigcal::report
