#include "server/fleet/findings/disagreements.h"

#include <algorithm>

#include "server/fleet/wording.h"

namespace rigcal::fleet {

std::optional<Vector6d> OffByOthers(const GraphSolution& solution, const EdgeId& edge) {
  const std::vector<EdgeInfluence>& all = solution.influences.edges;
  const auto found = std::lower_bound(all.begin(), all.end(), edge,
                                      [](const EdgeInfluence& one, const EdgeId& id) { return one.edge < id; });
  return found != all.end() && found->edge == edge && found->checked ? std::optional(found->off) : std::nullopt;
}

PoseLimits LimitsOfEdge(const Policy& policy, const Edge& edge) { return LimitsOf(policy, edge.frame_a, edge.frame_b); }

std::string PairDiffers(const SensorId& a, const SensorId& b) { return a.str() + " and " + b.str() + " differ by "; }
std::string LoopIsOpen(const CycleResidual& loop) { return "the loop of " + List(loop.sensors) + " is open by "; }

void Collected::Add(Disagreement one) {
  const double times = one.Times();
  const auto [at, is_new] = all_.try_emplace(one.what, one);
  if (!is_new && times > at->second.Times()) at->second = std::move(one);
}

const Disagreement* Collected::Largest() const {
  const Disagreement* largest = nullptr;
  for (const auto& [what, one] : all_)
    if (largest == nullptr || one.Times() > largest->Times()) largest = &one;
  return largest;
}

std::string Collected::AndMore() const {
  if (all_.size() < 2) return "";
  return all_.size() == 2 ? " (and one other by less)"
                          : " (and " + std::to_string(all_.size() - 1) + " others by less)";
}

std::vector<SensorId> Collected::Sensors() const {
  std::vector<SensorId> sensors;
  const auto add = [&](const Disagreement& one) {
    for (const SensorId& sensor : one.sensors)
      if (std::find(sensors.begin(), sensors.end(), sensor) == sensors.end()) sensors.push_back(sensor);
  };
  if (const Disagreement* largest = Largest(); largest != nullptr) add(*largest);
  for (const auto& [what, one] : all_) add(one);
  return sensors;
}

}  // namespace rigcal::fleet
