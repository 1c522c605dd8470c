#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "server/fleet/findings.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

const Diagnosis* DiagnosisOf(const GraphSolution& solution, const std::string& sensor) {
  for (const Diagnosis& diagnosis : solution.diagnoses)
    if (diagnosis.what.find("sensor " + sensor + " ") != std::string::npos ||
        diagnosis.what.find("sensor " + sensor + ":") != std::string::npos)
      return &diagnosis;
  return nullptr;
}

std::string WithoutStop(std::string sentence) {
  if (!sentence.empty() && sentence.back() == '.') sentence.pop_back();
  return sentence;
}

// Sensors without a pose: those whose edges leave a few directions open, and those that no good edge ties at all.
struct Unknown {
  std::vector<std::string> open, apart;
  std::size_t directions_max = 0;  // left open, of one sensor
};

Unknown UnknownOf(const std::vector<Edge>& edges, const GraphSolution& solution) {
  Unknown unknown;
  std::set<SensorId> solved;
  for (const SensorPose& pose : solution.poses) {
    solved.insert(pose.sensor);
    if (pose.known) continue;
    (pose.unobservable_basis.empty() ? unknown.apart : unknown.open).push_back(pose.sensor.str());
    unknown.directions_max = std::max(unknown.directions_max, pose.unobservable_basis.size());
  }
  std::set<SensorId> only_failed;
  for (const Edge& edge : edges)
    for (const SensorId& sensor : {edge.frame_a, edge.frame_b})
      if (!solved.contains(sensor)) only_failed.insert(sensor);
  for (const SensorId& sensor : only_failed) unknown.apart.push_back(sensor.str());
  return unknown;
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

std::optional<Finding> FindOpenSensors(const Unknown& unknown, const std::vector<Edge>& edges) {
  const auto reason = WhyOpen(edges);
  if (unknown.open.empty() || !reason) return std::nullopt;
  const std::string count = std::to_string(unknown.directions_max) + " directions";
  std::string why = "the pose of " + List(unknown.open) + " is known but for " +
                    (unknown.directions_max == 1 ? "one direction" : count) + ": " + reason->why;
  if (!unknown.apart.empty()) why += "; no good edges tie " + List(unknown.apart) + " to the reference";
  return Finding{why, reason->what_to_do};
}

}  // namespace

std::optional<Finding> FindUnknownSensors(const std::vector<Edge>& edges, const GraphSolution& solution) {
  const Unknown unknown = UnknownOf(edges, solution);
  std::vector<std::string> all = unknown.apart;
  all.insert(all.end(), unknown.open.begin(), unknown.open.end());
  if (all.empty()) return std::nullopt;
  if (auto open = FindOpenSensors(unknown, edges)) return open;
  const Diagnosis* diagnosis = DiagnosisOf(solution, all.front());
  if (all.size() == 1 && diagnosis != nullptr) return Finding{diagnosis->what, WithoutStop(diagnosis->cure)};
  const std::string them = all.size() == 1 ? "it" : "them";
  return Finding{"the pose of " + List(all) + " is not known: no good edges tie " + them + " fully to the reference",
                 "Capture a session that shows " + List(all) + " together with sensors that are known"};
}

}  // namespace rigcal::fleet
