#include "server/fleet/causes/cause_findings.h"

#include <algorithm>

#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

bool ExplainsFailures(const RootCause& cause) { return !cause.edges.empty(); }
// By what was measured of them, sensors whose poses are known in part are not where they are drawn.
bool MisplacesPart(const RootCause& cause, const GraphSolution& solution) {
  return (cause.kind == CauseKind::kFarFromNominal || cause.kind == CauseKind::kNominalUnit ||
          cause.kind == CauseKind::kOffRigModel) &&
         std::any_of(solution.poses.begin(), solution.poses.end(), [&](const SensorPose& pose) {
           return !pose.known &&
                  std::find(cause.sensors.begin(), cause.sensors.end(), pose.sensor) != cause.sensors.end();
         });
}

bool NamesNotMeasured(const RootCause& cause) { return cause.kind == CauseKind::kNotMeasured; }

bool Names(const RootCause& cause, const SensorId& sensor) {
  return std::find(cause.sensors.begin(), cause.sensors.end(), sensor) != cause.sensors.end();
}

std::set<SensorId> TiedSensors(const GraphSolution& solution) {
  std::set<SensorId> tied;
  for (const SensorPose& pose : solution.poses)
    if (pose.known || !pose.unobservable_basis.empty()) tied.insert(pose.sensor);
  return tied;
}

std::set<SensorId> EndsExplainedBy(const RootCause& cause, const std::vector<Edge>& edges) {
  const std::set<EdgeId> ids(cause.edges.begin(), cause.edges.end());
  std::set<SensorId> ends;
  for (const Edge& edge : edges)
    if (ids.contains(edge.id)) ends.insert({edge.frame_a, edge.frame_b});
  return ends;
}

// With those that only good edges to these tie. `left` are those that have no pose and are lost to nothing so far.
void AddThoseTiedToLost(const std::vector<Edge>& edges, std::set<SensorId>& left, std::set<SensorId>& lost) {
  const auto lose = [&](const SensorId& by, const SensorId& sensor) {
    return lost.contains(by) && left.erase(sensor) > 0 && lost.insert(sensor).second;
  };
  for (bool more = !lost.empty(); more;) {
    more = false;
    for (const Edge& edge : edges)
      if (edge.state == EdgeState::kGood) more |= lose(edge.frame_a, edge.frame_b) || lose(edge.frame_b, edge.frame_a);
  }
}

std::set<SensorId> NotTiedEnds(const std::vector<Edge>& edges, const GraphSolution& solution) {
  const std::set<SensorId> tied = TiedSensors(solution);
  std::set<SensorId> ends;
  for (const Edge& edge : edges)
    for (const SensorId& sensor : {edge.frame_a, edge.frame_b})
      if (!tied.contains(sensor)) ends.insert(sensor);
  return ends;
}

// Of each cause the sensors without a pose whose failures it explains, and those that hang on these. A sensor is lost
// to one cause only: that which names it, of several the first; if none does, the first that explains a failure of it.
std::vector<std::set<SensorId>> LostTo(const std::vector<RootCause>& causes, const std::vector<Edge>& edges,
                                       const GraphSolution& solution) {
  std::set<SensorId> left = NotTiedEnds(edges, solution);
  std::vector<std::set<SensorId>> lost(causes.size());
  for (const bool named : {true, false})
    for (std::size_t k = 0; k < causes.size(); ++k)
      for (const SensorId& sensor : EndsExplainedBy(causes[k], edges))
        if ((!named || Names(causes[k], sensor)) && left.erase(sensor) > 0) lost[k].insert(sensor);
  for (std::set<SensorId>& of_cause : lost) AddThoseTiedToLost(edges, left, of_cause);
  return lost;
}

// With what it makes of poses: of these, which have none, and of those that it mis-scales.
Finding WithEffect(const RootCause& cause, const std::string& not_known) {
  Finding finding = FindingOf(cause);
  const std::string both = not_known + (not_known.empty() || cause.effect.empty() ? "" : ", and ") + cause.effect;
  if (!both.empty()) finding.why += "; so " + both;
  return finding;
}

std::string NotKnownText(const std::set<SensorId>& sensors) {
  const bool one = sensors.size() == 1;
  return std::string(one ? "the pose of " : "the poses of ") + List(std::vector(sensors.begin(), sensors.end())) +
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
  const std::vector<std::set<SensorId>> lost = LostTo(causes, edges, solution);
  std::set<SensorId> explained;
  for (const std::set<SensorId>& of_cause : lost) explained.insert(of_cause.begin(), of_cause.end());
  for (const RootCause& cause : causes)
    if (NamesNotMeasured(cause)) explained.insert(cause.sensors.begin(), cause.sensors.end());
  const std::vector<Finding> others = FindUnknownSensors(edges, solution, headers, explained);
  if (explained.empty() && others.empty()) return {};
  std::vector<Finding> findings;
  for (std::size_t k = 0; k < causes.size(); ++k) {
    if (!ExplainsFailures(causes[k]) && !MisplacesPart(causes[k], solution)) continue;
    findings.push_back(WithEffect(causes[k], lost[k].empty() ? "" : NotKnownText(lost[k])));
  }
  for (const Finding& other : FindingsOf(causes, NamesNotMeasured)) findings.push_back(other);
  findings.insert(findings.end(), others.begin(), others.end());
  return findings;
}

std::vector<Finding> FindDoubted(const std::vector<RootCause>& causes) {
  std::vector<Finding> findings;
  for (const RootCause& cause : causes)
    if (!cause.doubted.empty()) findings.push_back(WithEffect(cause, ""));
  return findings;
}

std::set<SensorId> DoubtedBy(const std::vector<RootCause>& causes) {
  std::set<SensorId> doubted;
  for (const RootCause& cause : causes) {
    doubted.insert(cause.doubted.begin(), cause.doubted.end());
    if (cause.kind == CauseKind::kFarFromNominal) doubted.insert(cause.sensors.begin(), cause.sensors.end());
  }
  return doubted;
}

std::vector<const Edge*> UnexplainedFailures(const std::vector<Edge>& edges, const SessionTimes& captured_at,
                                             const std::vector<RootCause>& causes) {
  const std::set<EdgeId> explained = ExplainedBy(causes);
  std::vector<const Edge*> open = FindOpenFailures(edges, captured_at);
  std::erase_if(open, [&](const Edge* edge) { return explained.contains(edge->id); });
  return open;
}

}  // namespace rigcal::fleet
