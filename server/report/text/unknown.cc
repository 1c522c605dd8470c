#include "server/report/text/unknown.h"

#include <set>
#include <vector>

#include "server/model/edges/past.h"
#include "server/report/text/edge_state.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

using Neighbours = std::map<SensorId, std::set<SensorId>>;

bool IsGood(const Edge& edge) { return edge.state == EdgeState::kGood; }

Neighbours NeighboursBy(const std::vector<Edge>& edges, bool (*is)(const Edge&)) {
  Neighbours neighbours;
  for (const Edge& edge : edges) {
    if (!is(edge)) continue;
    neighbours[edge.frame_a].insert(edge.frame_b);
    neighbours[edge.frame_b].insert(edge.frame_a);
  }
  return neighbours;
}

std::set<SensorId> Reached(const Neighbours& neighbours, const SensorId& start) {
  std::set<SensorId> reached = {start};
  std::vector<SensorId> open = {start};
  while (!open.empty()) {
    const SensorId here = open.back();
    open.pop_back();
    const auto found = neighbours.find(here);
    if (found == neighbours.end()) continue;
    for (const SensorId& next : found->second)
      if (reached.insert(next).second) open.push_back(next);
  }
  return reached;
}

std::string Listed(const std::set<SensorId>& sensors) {
  constexpr std::size_t kListedMax = 4;
  std::string text;
  std::size_t count = 0;
  for (const SensorId& sensor : sensors) {
    if (count == kListedMax) return text + " and " + std::to_string(sensors.size() - kListedMax) + " more";
    text += (count++ ? ", " : "") + sensor.str();
  }
  return text;
}

// "the height was not measured; the rest is good to 0.66 mm and 0.11 deg"
std::string WhatWasMeasured(const SensorPose& pose, const std::optional<Eigen::Matrix3d>& R_ref_robot) {
  const std::size_t open_count = pose.unobservable_basis.size();
  const std::vector<AxisResult> axes = AxesOf(pose, R_ref_robot);
  const std::vector<std::string> names = NamesOfOpen(axes, open_count);
  std::string open;
  for (const std::string& name : names) open += (open.empty() ? "" : ", ") + InSentence(name);
  const RestSigma rest = WorstSigmaOf(axes);
  std::string sigmas = rest.m ? SigmaMm(*rest.m) + " mm" : "";
  if (rest.rad) sigmas += (sigmas.empty() ? "" : " and ") + SigmaDeg(*rest.rad) + " deg";
  return open + (names.size() > 1 || open_count > 1 ? " were" : " was") + " not measured" +
         (sigmas.empty() ? "" : "; the rest is good to " + sigmas);
}

}  // namespace

std::map<SensorId, std::string> WhyUnknown(const formats::RevisionInput& revision) {
  const Neighbours good = NeighboursBy(revision.edges, IsGood), failed = NeighboursBy(revision.edges, HasFailed),
                   past = NeighboursBy(revision.edges, IsPast);
  const std::set<SensorId> reached = Reached(good, revision.reference);
  std::map<SensorId, std::string> why;
  for (const SensorPose& pose : revision.solution.poses) {
    if (pose.known) continue;
    if (pose.measured_part)
      why[pose.sensor] = WhatWasMeasured(pose, revision.solution.R_ref_robot);
    else if (reached.count(pose.sensor) > 0)
      why[pose.sensor] = "its edges leave a direction of its pose free";
    else if (const auto linked = good.find(pose.sensor); linked != good.end())
      why[pose.sensor] = "it is joined only to " + Listed(linked->second) + ", which no good edge joins to " +
                         revision.reference.str();
    else if (const auto tried = failed.find(pose.sensor); tried != failed.end())
      why[pose.sensor] = "every edge to it failed: " + Listed(tried->second);
    else if (const auto before = past.find(pose.sensor); before != past.end())
      why[pose.sensor] = "its edges do not count any more: " + Listed(before->second);
    else
      why[pose.sensor] = "no edge names it";
  }
  return why;
}

}  // namespace rigcal::report
