// Poses that too few captures stand behind for anybody to say how well they are known.
#include <algorithm>
#include <map>
#include <set>

#include "server/fleet/findings/failures.h"
#include "server/fleet/findings/findings.h"
#include "server/fleet/wording.h"
#include "server/model/edges/captures_wanted.h"

namespace rigcal::fleet {
namespace {

constexpr std::size_t kCapturesLeast = 5;  // that a jackknife is made of

// Captures of good pairs of a sensor with some of the others. An edge that was pushed with its covariance says how well
// it is known by itself.
struct Behind {
  std::set<std::pair<SessionId, CaptureId>> captures;
  bool finished = false;
  [[nodiscard]] bool IsEnough() const { return finished || captures.size() >= kCapturesLeast; }
};

void Add(const Edge& edge, Behind& behind) {
  behind.finished |= edge.captures.empty();
  for (const CaptureResidual& one : edge.captures)
    if (one.used) behind.captures.emplace(edge.session, one.capture);
}

// `with`: only pairs with these; null: all.
std::map<SensorId, Behind> BehindSensors(const std::vector<Edge>& edges, const std::set<SensorId>* with) {
  std::map<SensorId, Behind> behind;
  for (const Edge& edge : edges) {
    if (edge.state != EdgeState::kGood) continue;
    if (with == nullptr || with->contains(edge.frame_b)) Add(edge, behind[edge.frame_a]);
    if (with == nullptr || with->contains(edge.frame_a)) Add(edge, behind[edge.frame_b]);
  }
  return behind;
}

std::set<SensorId> ReachedFrom(const SensorId& reference, const std::vector<Edge>& edges) {
  std::set<SensorId> reached = {reference};
  for (bool more = true; more;) {
    more = false;
    for (const auto& [sensor, behind] : BehindSensors(edges, &reached))
      if (behind.IsEnough() && reached.insert(sensor).second) more = true;
  }
  return reached;
}

}  // namespace

std::vector<SensorId> SensorsOfFewCaptures(const std::vector<Edge>& edges, const GraphSolution& solution) {
  const SensorPose* reference = ReferenceOf(solution);
  if (reference == nullptr) return {};
  const std::set<SensorId> reached = ReachedFrom(reference->sensor, edges);
  const std::map<SensorId, Behind> behind = BehindSensors(edges, nullptr);
  std::vector<SensorId> few;
  for (const SensorPose& pose : solution.poses)
    if (pose.known && !reached.contains(pose.sensor) && behind.contains(pose.sensor)) few.push_back(pose.sensor);
  return few;
}

Finding FewCapturesBehind(const std::vector<SensorId>& sensors, const std::vector<Edge>& edges) {
  const std::map<SensorId, Behind> behind = BehindSensors(edges, nullptr);
  std::size_t most = 0;
  for (const SensorId& sensor : sensors) most = std::max(most, behind.at(sensor).captures.size());
  const bool one = sensors.size() == 1;
  return {"only " + std::to_string(most) + (most == 1 ? " capture stands" : " captures stand") + " behind the " +
              (one ? "pose of " : "poses of ") + List(sensors) + ": too few to tell how well " +
              (one ? "it is" : "they are") + " known",
          "Take " + std::to_string(kCapturesUsual) + " captures, with the board at different distances and tilts",
          sensors,
          {"Captures behind the pose of " + sensors.front().str(),
           std::to_string(behind.at(sensors.front()).captures.size()), "at least " + std::to_string(kCapturesLeast)}};
}

}  // namespace rigcal::fleet
