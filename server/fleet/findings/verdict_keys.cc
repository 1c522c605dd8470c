#include "server/fleet/findings/verdict_keys.h"

#include <algorithm>

#include "server/fleet/findings/findings.h"
#include "server/fleet/findings/not_needed.h"

namespace rigcal::fleet {
namespace {

using Keys = std::vector<std::string>;

Keys KeysOfDisagreement(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy,
                        const std::vector<SessionEstimate>& estimates) {
  const auto worst = MostContradicting(edges, WithoutRefinedPairs(edges, solution, policy, estimates), policy);
  if (!worst) return {"open_loop"};
  const auto& [first, second] = std::minmax(worst->edge->frame_a, worst->edge->frame_b);
  return {"disagree " + first.str() + " " + second.str()};
}

// Where they decide: beyond the tolerance, or as a warning among others.
Keys KeysOfIntrinsics(VerdictLevel level, const std::vector<SessionEstimate>& estimates, const Policy& policy) {
  const auto wrong = FindWrongIntrinsics(estimates, policy);
  Keys keys;
  if (!wrong || (level == VerdictLevel::kFail && !wrong->is_beyond)) return keys;
  for (const SensorId& camera : wrong->finding.accused) keys.push_back("wrong_intrinsics " + camera.str());
  return keys;
}

Keys KeysOfUnknown(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy) {
  Keys keys;
  for (const SensorPose& pose : solution.poses)
    if (!pose.known && pose.measured_part) keys.push_back("measured_in_part " + pose.sensor.str());
  if (!SensorsOfFewCaptures(edges, solution).empty()) keys.emplace_back("few_captures");
  if (!keys.empty()) return keys;
  for (const SensorId& sensor : UncertainSensors(solution, policy)) keys.push_back("uncertain " + sensor.str());
  return keys;
}

Keys KeysOfWarning(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy,
                   const OtherPaths& others) {
  Keys keys;
  if (const auto apart = FindApart(solution, policy, {}))
    for (const SensorId& sensor : apart->accused) keys.push_back("apart " + sensor.str());
  if (FindUncheckedSensors(edges, solution)) keys.emplace_back("unchecked");
  if (!FindHardlyChecked(edges, solution, policy, others).empty()) keys.emplace_back("hardly_checked");
  return keys;
}

Keys KeysOfLevel(VerdictLevel level, const std::vector<Edge>& edges, const GraphSolution& solution,
                 const Policy& policy, const std::vector<SessionEstimate>& estimates, const OtherPaths& others) {
  if (Keys keys = KeysOfIntrinsics(level, estimates, policy); !keys.empty()) return keys;
  if (level == VerdictLevel::kFail) return KeysOfDisagreement(edges, solution, policy, estimates);
  return level == VerdictLevel::kUnknown ? KeysOfUnknown(edges, solution, policy)
                                         : KeysOfWarning(edges, solution, policy, others);
}

}  // namespace

std::vector<std::string> KeysOfVerdict(const Verdict& verdict, const std::vector<Edge>& edges,
                                       const GraphSolution& solution, const Policy& policy,
                                       const std::vector<SessionEstimate>& estimates,
                                       const std::vector<std::string>& cause_keys, const OtherPaths& others) {
  if (verdict.level == VerdictLevel::kPass) return {};
  Keys keys = KeysOfMoves(estimates, solution, policy);
  const auto taken = TakenAsKnown(solution, policy);
  if (keys.empty() && cause_keys.empty())
    keys = KeysOfLevel(verdict.level, edges, taken ? *taken : solution, policy, estimates, others);
  if (keys.size() > kVerdictKeysMax) keys.resize(kVerdictKeysMax);
  return keys;
}

}  // namespace rigcal::fleet
