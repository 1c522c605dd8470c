// What edges and loops say against each other, by size: the words and the order in which it is told.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/fleet/assess.h"

namespace rigcal::fleet {

// What the others say of an edge, as far as that was worked out (EdgeInfluence::off).
[[nodiscard]] std::optional<Vector6d> OffByOthers(const GraphSolution& solution, const EdgeId& edge);
[[nodiscard]] PoseLimits LimitsOfEdge(const Policy& policy, const Edge& edge);

// Half a sentence that goes on with a size, by how many times the limit that is.
struct Disagreement {
  std::string what;
  Vector6d off = Vector6d::Zero();
  PoseLimit limit;
  std::vector<SensorId> sensors = {};  // that are to be captured again
  const Edge* edge = nullptr;          // null: it is of more than one
  [[nodiscard]] double Times() const { return TimesLimit(off, limit); }
};
[[nodiscard]] std::string PairDiffers(const SensorId& a, const SensorId& b);  // "left and right differ by "
[[nodiscard]] std::string LoopIsOpen(const CycleResidual& loop);  // "the loop of left and right is open by "

// Of each the largest; nothing that is said twice.
class Collected {
 public:
  void Add(Disagreement one);
  // The one that is the most times its limit; null: there is none.
  [[nodiscard]] const Disagreement* Largest() const;
  // " (and 2 others by less)"; empty where there is no other.
  [[nodiscard]] std::string AndMore() const;
  // Of all that were added, those of the largest first.
  [[nodiscard]] std::vector<SensorId> Sensors() const;

 private:
  std::map<std::string, Disagreement> all_;
};

}  // namespace rigcal::fleet
