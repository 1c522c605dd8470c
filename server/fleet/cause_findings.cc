#include "server/fleet/cause_findings.h"

#include <algorithm>

#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

bool ExplainsFailures(const RootCause& cause) { return !cause.edges.empty(); }
bool NamesNotMeasured(const RootCause& cause) { return cause.kind == CauseKind::kNotMeasured; }

// Sensors without a pose whose failures a cause explains, and those that hang on these.
std::vector<SensorId> LostTo(const std::vector<RootCause>& causes, const std::vector<Edge>& edges,
                             const GraphSolution& solution) {
  const std::set<EdgeId> explained = ExplainedBy(causes);
  std::set<SensorId> tied, lost;
  for (const SensorPose& pose : solution.poses)
    if (pose.known || !pose.unobservable_basis.empty()) tied.insert(pose.sensor);
  const auto lose_ends = [&](const Edge& edge) {
    const std::size_t before = lost.size();
    for (const SensorId& sensor : {edge.frame_a, edge.frame_b})
      if (!tied.contains(sensor)) lost.insert(sensor);
    return lost.size() > before;
  };
  bool more = false;
  for (const Edge& edge : edges) more |= explained.contains(edge.id) && lose_ends(edge);
  while (more) {
    more = false;
    for (const Edge& edge : edges)
      if (edge.state == EdgeState::kGood && (lost.contains(edge.frame_a) || lost.contains(edge.frame_b)))
        more |= lose_ends(edge);
  }
  return {lost.begin(), lost.end()};
}

std::string NotKnownText(const std::vector<SensorId>& sensors) {
  const bool one = sensors.size() == 1;
  return std::string(one ? "the pose of " : "the poses of ") + List(sensors) +
         (one ? " is not known" : " are not known");
}

}  // namespace

std::vector<Finding> FindNothing(const std::vector<Edge>& edges, const SessionTimes& captured_at,
                                 const std::vector<RootCause>& causes) {
  const auto none = FindNoEdges(edges);
  if (!none) return {};
  std::vector<Finding> findings = FindingsOf(causes, ExplainsFailures);
  if (findings.empty()) return {*none};
  if (const auto rest = FindFailedEdges(UnexplainedFailures(edges, captured_at, causes))) findings.push_back(*rest);
  return findings;
}

std::vector<Finding> FindMisplaced(const std::vector<RootCause>& causes, const std::set<SensorId>& around) {
  return FindingsOf(causes, [&](const RootCause& cause) {
    const bool near = std::any_of(cause.sensors.begin(), cause.sensors.end(),
                                  [&](const SensorId& sensor) { return around.contains(sensor); });
    return cause.kind == CauseKind::kExchanged || (cause.kind == CauseKind::kFarFromNominal && near);
  });
}

std::vector<Finding> FindUnknown(const std::vector<Edge>& edges, const GraphSolution& solution,
                                 const SessionHeaders& headers, const std::vector<RootCause>& causes) {
  const std::vector<SensorId> lost = LostTo(causes, edges, solution);
  std::set<SensorId> explained(lost.begin(), lost.end());
  for (const RootCause& cause : causes)
    if (NamesNotMeasured(cause)) explained.insert(cause.sensors.begin(), cause.sensors.end());
  const std::vector<Finding> others = FindUnknownSensors(edges, solution, headers, explained);
  if (explained.empty() && others.empty()) return {};
  std::vector<Finding> findings = FindingsOf(causes, ExplainsFailures);
  if (!lost.empty()) findings.back().why += "; so " + NotKnownText(lost);
  for (const Finding& other : FindingsOf(causes, NamesNotMeasured)) findings.push_back(other);
  findings.insert(findings.end(), others.begin(), others.end());
  return findings;
}

std::vector<const Edge*> UnexplainedFailures(const std::vector<Edge>& edges, const SessionTimes& captured_at,
                                             const std::vector<RootCause>& causes) {
  const std::set<EdgeId> explained = ExplainedBy(causes);
  std::vector<const Edge*> open = FindOpenFailures(edges, captured_at);
  std::erase_if(open, [&](const Edge* edge) { return explained.contains(edge->id); });
  return open;
}

}  // namespace rigcal::fleet
