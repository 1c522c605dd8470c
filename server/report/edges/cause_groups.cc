#include "server/report/edges/cause_groups.h"

#include <algorithm>
#include <optional>
#include <set>
#include <unordered_map>

#include "server/report/text/edge_state.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kPairsListedMax = 200;

using TwoSensors = std::pair<SensorId, SensorId>;

TwoSensors SensorsOf(const Edge& edge) { return std::minmax(edge.frame_a, edge.frame_b); }

class CauseByEdge {
 public:
  CauseByEdge(const std::vector<Cause>& causes, const std::vector<ShownEdge>& edges) {
    for (std::size_t i = 0; i < causes.size(); ++i)
      for (const EdgeId& edge : causes[i].edges) by_id_.emplace(edge, i);
    for (const ShownEdge& shown : edges)
      if (const auto found = by_id_.find(shown.edge->id); found != by_id_.end())
        by_pair_.emplace(SensorsOf(*shown.edge), found->second);
  }
  [[nodiscard]] std::optional<std::size_t> Of(const Edge& edge) const {
    if (!HasFailed(edge)) return std::nullopt;
    if (const auto found = by_id_.find(edge.id); found != by_id_.end()) return found->second;
    const auto found = by_pair_.find(SensorsOf(edge));
    return found == by_pair_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  std::unordered_map<EdgeId, std::size_t> by_id_;
  std::map<TwoSensors, std::size_t> by_pair_;
};

EdgeGroup GroupOf(const Cause& cause, std::vector<const ShownEdge*> edges, std::size_t number) {
  std::set<TwoSensors> pairs;
  bool detailed = false;
  for (const ShownEdge* shown : edges) {
    pairs.insert(SensorsOf(*shown->edge));
    detailed |= shown->detailed;
  }
  return {&cause, std::move(edges), pairs.size(), detailed ? "g-" + std::to_string(number) : std::string()};
}

void FillPair(Dictionary& pair, const ShownEdge& shown) {
  Dictionary* name = pair.AddSectionDictionary(shown.detailed ? "LINK" : "PLAIN");
  name->SetValue("ANCHOR", shown.anchor);
  name->SetValue("FROM", shown.edge->frame_a.str());
  name->SetValue("TO", shown.edge->frame_b.str());
}

}  // namespace

EdgesByCause GroupByCause(const formats::RevisionInput& revision, const std::vector<ShownEdge>& edges) {
  const CauseByEdge cause_of(revision.causes, edges);
  std::vector<std::vector<const ShownEdge*>> by_cause(revision.causes.size());
  for (const ShownEdge& shown : edges)
    if (const auto cause = cause_of.Of(*shown.edge)) by_cause[*cause].push_back(&shown);
  EdgesByCause grouped;
  for (const ShownEdge& shown : edges)
    if (const auto cause = cause_of.Of(*shown.edge); !cause || by_cause[*cause].size() < 2)
      grouped.others.push_back(&shown);
  for (std::size_t i = 0; i < by_cause.size(); ++i)
    if (by_cause[i].size() > 1) grouped.groups.push_back(GroupOf(revision.causes[i], std::move(by_cause[i]), i + 1));
  return grouped;
}

void FillPairs(Dictionary& parent, const std::vector<const ShownEdge*>& edges) {
  Dictionary* list = parent.AddIncludeDictionary("PAIRS");
  list->SetFilename("pairs.tpl");
  for (std::size_t i = 0; i < std::min(edges.size(), kPairsListedMax); ++i)
    FillPair(*list->AddSectionDictionary("PAIR"), *edges[i]);
  if (edges.size() > kPairsListedMax) ShowValue(*list, "MORE", "COUNT", std::to_string(edges.size() - kPairsListedMax));
}

}  // namespace rigcal::report
