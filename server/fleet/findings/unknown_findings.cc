#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "server/fleet/findings/failures.h"
#include "server/fleet/findings/findings.h"
#include "server/fleet/findings/partial_poses.h"
#include "server/fleet/wording.h"
#include "server/model/edges/past.h"

namespace rigcal::fleet {
namespace {

std::string WithoutStop(std::string sentence) {
  if (!sentence.empty() && sentence.back() == '.') sentence.pop_back();
  return sentence;
}

struct Motion {
  const char* code;  // of the note that an edge gives for what it leaves open
  const char* text;
};
constexpr std::array kMotions = {Motion{"planar_motion", "the robot was turned about one axis only"},
                                 Motion{"turning_on_the_spot", "the robot was only turned on the spot"},
                                 Motion{"pure_translation", "the robot was moved but not turned"},
                                 Motion{"straight_line", "the robot was moved along one line only"}};

// What most edges say of why they leave directions open, if it is the motion.
std::optional<Finding> WhyOpen(const std::vector<Edge>& edges) {
  std::map<std::string, std::pair<int, const Diagnosis*>> notes;
  for (const Edge& edge : edges) {
    if (edge.state != EdgeState::kGood || edge.uncertainty.rank == 6) continue;
    for (const Diagnosis& note : edge.diagnoses) {
      auto& [count, first] = notes[note.code];
      if (count++ == 0) first = &note;
    }
  }
  std::optional<Finding> why;
  int most = 0;
  for (const Motion& motion : kMotions)
    if (const auto found = notes.find(motion.code); found != notes.end() && found->second.first > most)
      most = found->second.first, why = Finding{motion.text, WithoutStop(found->second.second->cure)};
  return why;
}

// Sensors of which the same is open.
struct AlikeOpen {
  std::vector<SensorId> sensors;
  std::string frame;
  bool several = false, told = true;  // how well the rest of each is known is told
  double sigma_m = 0.0, sigma_rad = 0.0;
};

std::map<std::string, AlikeOpen> OpenAlike(const std::vector<PartialPose>& partial) {
  std::map<std::string, AlikeOpen> alike;
  for (const PartialPose& one : partial) {
    AlikeOpen& group = alike[one.open];
    group.sensors.push_back(one.sensor);
    group.frame = one.frame;
    group.several = one.several;
    group.told = group.told && one.sigma_m && one.sigma_rad;
    group.sigma_m = std::max(group.sigma_m, one.sigma_m.value_or(0.0));
    group.sigma_rad = std::max(group.sigma_rad, one.sigma_rad.value_or(0.0));
  }
  return alike;
}

Finding OpenDirections(const std::vector<PartialPose>& partial, const std::vector<Edge>& edges) {
  const auto reason = WhyOpen(edges);
  Finding finding;
  std::vector<SensorId> sensors;
  for (const auto& [open, group] : OpenAlike(partial)) {
    finding.why += (finding.why.empty() ? "" : "; ") + open + " of " + List(group.sensors) +
                   (group.frame.empty() ? "" : " in " + group.frame) +
                   (group.several ? " were not measured" : " was not measured");
    if (reason && sensors.empty()) finding.why += ", as " + reason->why;
    finding.why += "; the rest was" + (group.told ? ", to " + SigmaText(group.sigma_m, group.sigma_rad) : "");
    sensors.insert(sensors.end(), group.sensors.begin(), group.sensors.end());
  }
  finding.what_to_do =
      reason ? reason->what_to_do : "Capture " + List(sensors) + " again, with boards and motion in every direction";
  finding.accused = std::move(sensors);
  return finding;
}

// Without a pose, and without directions that would be known. Nobody asks for sensors that are gone from the robot.
std::vector<SensorId> ApartSensors(const std::vector<Edge>& edges, const GraphSolution& solution) {
  std::vector<SensorId> apart;
  std::set<SensorId> solved, only_failed;
  for (const SensorPose& pose : solution.poses) {
    solved.insert(pose.sensor);
    if (!pose.known && pose.unobservable_basis.empty()) apart.push_back(pose.sensor);
  }
  for (const Edge& edge : edges)
    for (const SensorId& sensor : {edge.frame_a, edge.frame_b})
      if (!solved.contains(sensor) && !AsksForNoSensor(edge)) only_failed.insert(sensor);
  apart.insert(apart.end(), only_failed.begin(), only_failed.end());
  return apart;
}

// Of the failed edges that could tie one of these, the first of those that fail for what most do; null: none says why.
const Edge* FailedTie(const std::vector<Edge>& edges, const std::vector<SensorId>& apart) {
  std::map<std::string, std::pair<int, const Edge*>> failed;
  for (const Edge& edge : edges) {
    const bool ties = std::any_of(apart.begin(), apart.end(), [&](const SensorId& one) { return IsEndOf(edge, one); });
    if (!ties || edge.state != EdgeState::kFailed || IsPast(edge) || edge.diagnoses.empty()) continue;
    auto& [count, first] = failed[edge.diagnoses.front().code];
    if (count++ == 0) first = &edge;
  }
  const auto most = std::max_element(failed.begin(), failed.end(),
                                     [](const auto& x, const auto& y) { return x.second.first < y.second.first; });
  return most == failed.end() ? nullptr : most->second.second;
}

Finding NotTied(const std::vector<SensorId>& apart, const std::vector<Edge>& edges, const GraphSolution& solution) {
  for (const Diagnosis& diagnosis : solution.diagnoses)
    if (diagnosis.code == "not_judged" || diagnosis.code == "singular")
      return {diagnosis.what, WithoutStop(diagnosis.cure)};
  const std::string sensors = List(apart), them = apart.size() == 1 ? "it" : "them";
  const SensorPose* reference = ReferenceOf(solution);
  Finding finding{(apart.size() == 1 ? "the pose of " : "the poses of ") + sensors +
                      (apart.size() == 1 ? " is" : " are") + " not known: no good edge ties " + them + " to " +
                      (reference ? reference->sensor.str() : "the reference"),
                  "Capture " + sensors + " together with sensors that are known", apart};
  if (const Edge* failed = FailedTie(edges, apart)) {
    const Diagnosis& why = failed->diagnoses.front();
    finding.why +=
        " (" + failed->frame_a.str() + " - " + failed->frame_b.str() + " failed: " + WithoutStop(why.what) + ")";
    finding.what_to_do = WithoutStop(why.cure);
  }
  return finding;
}

}  // namespace

std::vector<Finding> FindUnknownSensors(const std::vector<Edge>& edges, const GraphSolution& solution,
                                        const SessionHeaders& headers, const std::set<SensorId>& explained) {
  std::vector<PartialPose> partial;
  for (const SensorPose& pose : solution.poses)
    if (!pose.known && !pose.unobservable_basis.empty()) partial.push_back(PartialPoseOf(pose, solution, headers));
  std::vector<SensorId> apart = ApartSensors(edges, solution);
  std::erase_if(apart, [&](const SensorId& sensor) { return explained.contains(sensor); });
  std::vector<Finding> findings;
  if (!partial.empty()) findings.push_back(OpenDirections(partial, edges));
  if (!apart.empty()) findings.push_back(NotTied(apart, edges, solution));
  return findings;
}

}  // namespace rigcal::fleet
