#include "server/fleet/assess.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "server/fleet/findings.h"

namespace rigcal::fleet {
namespace {

std::string Capitalised(std::string text) {
  if (!text.empty()) text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  return text;
}

std::string Uncapitalised(std::string text) {
  if (!text.empty()) text.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(text.front())));
  return text;
}

// One sentence each, however many findings.
Verdict VerdictFrom(VerdictLevel level, const std::vector<Finding>& findings) {
  Verdict verdict;
  verdict.level = level;
  for (const Finding& finding : findings) {
    const bool first = verdict.why.empty();
    verdict.why += first ? Capitalised(finding.why) : "; also, " + finding.why;
    verdict.what_to_do += first ? finding.what_to_do : "; then " + Uncapitalised(finding.what_to_do);
  }
  verdict.why += ".";
  verdict.what_to_do += ".";
  return verdict;
}

// Claims no more agreement than was tested.
Verdict Pass(const std::string& untested, const std::string& noticed) {
  std::string why = untested.empty()
                        ? "Every sensor is known well enough and the edges agree with each other."
                        : "Every sensor is known well enough and each edge passes its own test against the "
                          "others; " +
                              untested + ".";
  if (!noticed.empty()) why += " " + noticed;
  return {VerdictLevel::kPass, why, "Nothing; calibrate again when it is due."};
}

std::vector<Finding> Collect(std::initializer_list<std::optional<Finding>> candidates) {
  std::vector<Finding> findings;
  for (const std::optional<Finding>& candidate : candidates)
    if (candidate) findings.push_back(*candidate);
  return findings;
}

// Suspects are found with edges taken as independent. Where captures are shared, they count only if the honest test of
// the residuals finds a contradiction too; they tell better than a residual at the plain optimum who is to blame.
std::vector<Finding> FindContradictions(const std::vector<Edge>& edges, const GraphSolution& solution,
                                        const Policy& policy, const SessionTimes& captured_at) {
  const auto contradiction = FindContradiction(edges, solution, policy);
  const bool shared = std::any_of(solution.residuals.begin(), solution.residuals.end(),
                                  [](const EdgeResidual& residual) { return residual.by_jackknife; });
  if (!contradiction && shared) return {};
  std::vector<Finding> suspects = Collect({FindTwoPoses(edges, solution, captured_at), FindSuspectEdges(edges, solution)});
  if (suspects.empty() && contradiction) suspects.push_back(*contradiction);
  return suspects;
}

// Edges that do not agree, and loops of them that do not close.
std::vector<Finding> FindAccusations(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy,
                                     const SessionTimes& captured_at) {
  std::vector<Finding> contradictions = FindContradictions(edges, solution, policy, captured_at);
  return contradictions.empty() ? Collect({FindOpenLoops(edges, solution, policy)}) : contradictions;
}

// Of loops that do not close, and of edges and sensors that others contradict.
std::set<SensorId> AccusedSensors(const std::vector<Edge>& edges, const GraphSolution& solution) {
  std::set<SensorId> accused;
  for (const CycleResidual& loop : solution.cycles.worst)
    if (loop.fails()) accused.insert(loop.sensors.begin(), loop.sensors.end());
  for (const TwoPoses& two : solution.suspects.two_poses) accused.insert(two.sensor);
  for (const SuspectEdge& suspect : solution.suspects.edges)
    for (const Edge& edge : edges)
      if (edge.id == suspect.edge) accused.insert({edge.frame_a, edge.frame_b});
  return accused;
}

}  // namespace

Verdict Assess(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy,
               const SessionTimes& captured_at, const std::vector<SessionEstimate>& estimates) {
  if (const auto none = FindNoEdges(edges)) return VerdictFrom(VerdictLevel::kUnknown, {*none});
  if (const auto moved = FindMovedWithin(estimates, captured_at)) return VerdictFrom(VerdictLevel::kFail, {*moved});
  // Residuals that are no optimum blame no edge.
  if (const auto unsettled = FindUnsettled(solution)) return VerdictFrom(VerdictLevel::kUnknown, {*unsettled});
  if (const auto moved = FindMovedBetween(solution, captured_at)) return VerdictFrom(VerdictLevel::kFail, {*moved});
  const GraphSolution judged = WithoutRefinedPairs(edges, solution, policy, estimates);
  if (auto accusations = FindAccusations(edges, judged, policy, captured_at); !accusations.empty()) {
    if (auto lens = FindLensBehind(estimates, AccusedSensors(edges, judged))) accusations.push_back(std::move(*lens));
    return VerdictFrom(VerdictLevel::kFail, accusations);
  }
  const bool pairs_disagree = !FindAccusations(edges, solution, policy, captured_at).empty();
  if (const auto unknown = Collect({FindUnknownSensors(edges, solution)}); !unknown.empty())
    return VerdictFrom(VerdictLevel::kUnknown, unknown);
  const auto warnings =
      Collect({FindMovedBoards(estimates, captured_at), FindLensMisfits(estimates, pairs_disagree),
               FindFailedEdges(edges), FindPastPairs(edges), FindUncertainSensors(solution, policy),
               FindUncheckedSensors(edges, solution), FindUncheckedEdges(edges, solution),
               FindUntestable(edges, solution, policy),
               FindUnrefined(estimates, captured_at), FindUnseenMoves(estimates, policy, captured_at)});
  if (!warnings.empty()) return VerdictFrom(VerdictLevel::kWarn, warnings);
  return Pass(UntestedLoops(edges, solution), SmallestMoveNoticed(estimates, solution));
}

}  // namespace rigcal::fleet
