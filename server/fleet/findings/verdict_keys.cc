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
