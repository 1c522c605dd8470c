#include "server/fleet/assess.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <utility>

#include "server/fleet/boards/scale_taken.h"
#include "server/fleet/causes/cause_findings.h"
#include "server/fleet/findings/effect.h"
#include "server/fleet/findings/not_needed.h"
#include "server/fleet/wording.h"
#include "server/model/edges/past.h"

namespace rigcal::fleet {
namespace {

std::set<std::string> NamesOf(const std::vector<Edge>& edges, const GraphSolution& solution,
                              const std::vector<RootCause>& causes) {
  std::set<std::string> names;
  for (const Edge& edge : edges) names.insert({edge.frame_a.str(), edge.frame_b.str()});
  for (const SensorPose& pose : solution.poses) names.insert(pose.sensor.str());
  for (const RootCause& cause : causes)
    for (const SensorId& sensor : cause.sensors) names.insert(sensor.str());
  return names;
}

// A sensor's name stays as it is written.
std::string Capitalised(std::string text, const std::set<std::string>& names) {
  if (text.empty() || names.contains(text.substr(0, text.find_first_of(" ,")))) return text;
  text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  return text;
}

// Of all of them, each once.
std::vector<SensorId> AccusedBy(const std::vector<Finding>& findings) {
  std::vector<SensorId> accused;
  for (const Finding& finding : findings)
    for (const SensorId& sensor : finding.accused)
      if (std::find(accused.begin(), accused.end(), sensor) == accused.end()) accused.push_back(sensor);
  return accused;
}

std::string Uncapitalised(std::string text) {
  if (!text.empty()) text.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(text.front())));
  return text;
}

// A single one is the verdict's own sentence.
std::vector<VerdictReason> ReasonsOf(const std::vector<Finding>& findings, const std::set<std::string>& names) {
  std::vector<VerdictReason> reasons;
  if (findings.size() < 2) return reasons;
  for (const Finding& finding : findings)
    reasons.push_back({Capitalised(finding.why, names) + ".",
                       finding.what_to_do.empty() ? "" : Capitalised(finding.what_to_do, names) + "."});
  return reasons;
}

// Whoever takes the most captures that any of them asks for does what all ask for, but that of places that one sensor
// sees enough must be each pair's: said once, by the first.
void AskForCapturesOnce(std::vector<Finding>& findings) {
  const auto fewer = [](const Finding& x, const Finding& y) { return x.captures < y.captures; };
  const auto most = std::max_element(findings.begin(), findings.end(), fewer);
  if (most == findings.end() || most->captures == 0) return;
  std::string asked = std::move(most->what_to_do);
  for (const Finding& finding : findings)
    if (finding.captures_are_of_pairs && !most->captures_are_of_pairs)
      asked += ", " + std::to_string(finding.captures) + " or more of them of each pair";
  for (Finding& finding : findings)
    if (finding.captures > 0) finding.what_to_do = std::exchange(asked, "");
}

// One sentence each, however many findings; a page is about the first.
Judgement JudgementFrom(VerdictLevel level, std::vector<Finding> findings, const std::set<std::string>& names) {
  AskForCapturesOnce(findings);
  Judgement judgement;
  judgement.basis = {
      level == VerdictLevel::kFail ? AccusedBy(findings) : findings.front().accused, {}, findings.front().figure};
  Verdict& verdict = judgement.verdict;
  verdict.level = level;
  for (const Finding& finding : findings) {
    const bool first = verdict.why.empty();
    verdict.why += first ? Capitalised(finding.why, names) : "; also, " + finding.why;
    if (!finding.what_to_do.empty())
      verdict.what_to_do += first ? finding.what_to_do : "; then " + Uncapitalised(finding.what_to_do);
  }
  verdict.why += ".";
  verdict.what_to_do += ".";
  judgement.basis.reasons = ReasonsOf(findings, names);
  return judgement;
}

constexpr const char* kMeasureTheBoard =
    "Hold a caliper to the board once, and give its sigma or its serial number in session.yaml";

// Claims no more agreement than was tested. `remarks`: what is told though it decides nothing, first, as it is news.
// Last, what enters no pose (`by_pairs`), and what all of it rests on (`assumed`).
Verdict Pass(const std::string& untested, const std::string& remarks, const std::string& noticed,
             const std::string& by_pairs, const std::string& assumed) {
  std::string why = remarks + "Every sensor is known well enough";
  if (remarks.empty() && by_pairs.empty())
    why += untested.empty() ? " and the edges agree with each other"
                            : " and each edge passes its own test against the others; " + untested;
  why += ".";
  if (!noticed.empty()) why += " " + noticed;
  for (const std::string& last : {by_pairs, assumed})
    if (!last.empty()) why += " " + last + ".";
  if (assumed.empty()) return {VerdictLevel::kPass, why, "Nothing; calibrate again when it is due."};
  return {VerdictLevel::kPass, why, std::string(kMeasureTheBoard) + "; nothing else until it is due."};
}

// After what else is to be done.
std::string UntilItIsDue(const std::string& assumed) {
  if (assumed.empty()) return "calibrate again when it is due.";
  return Uncapitalised(kMeasureTheBoard) + "; nothing else until it is due.";
}

void AddRemarks(const std::string& remarks, const std::string& action, Judgement& judgement) {
  Verdict& verdict = judgement.verdict;
  std::vector<VerdictReason>& reasons = judgement.basis.reasons;
  if (reasons.empty()) reasons.push_back({verdict.why, verdict.what_to_do});
  reasons.push_back({remarks, action});
  verdict.why += " " + remarks;
}

// A sentence each, with a blank behind it.
std::string Remarks(std::initializer_list<std::string> texts, const std::set<std::string>& names) {
  std::string remarks;
  for (const std::string& text : texts)
    if (!text.empty()) remarks += Capitalised(text, names) + ". ";
  return remarks;
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
  const auto contradiction = MostContradicting(edges, solution, policy);
  const bool shared = std::any_of(solution.residuals.begin(), solution.residuals.end(),
                                  [](const EdgeResidual& residual) { return residual.by_jackknife; });
  if (!contradiction && shared) return {};
  std::vector<Finding> suspects =
      Collect({FindTwoPoses(edges, solution, policy, captured_at), FindSuspectEdges(edges, solution, policy)});
  if (suspects.empty() && contradiction)
    suspects.push_back(DoNotFit(*contradiction->edge, contradiction->e, edges, policy));
  return suspects;
}

Judgement Doubting(Judgement judgement, const std::vector<SensorId>& sensors) {
  judgement.verdict.unverified = ListAll(sensors);
  judgement.basis.doubted = sensors;
  return judgement;
}

// Sensors that have a pose which is not to be relied on all the same.
struct Doubt {
  std::vector<Finding> findings;
  std::set<SensorId> sensors;
};

// The findings are those of the first reason; the sensors those of all.
Doubt FindDoubt(const std::vector<Edge>& edges, const GraphSolution& solution, const std::vector<RootCause>& causes,
                const LateDoubts& late) {
  const std::set<SensorId> by_cause = DoubtedBy(causes);
  const std::vector<SensorId> few = SensorsOfFewCaptures(edges, solution);
  Doubt doubt{late.findings, {late.sensors.begin(), late.sensors.end()}};
  doubt.sensors.insert(by_cause.begin(), by_cause.end());
  doubt.sensors.insert(few.begin(), few.end());
  if (doubt.findings.empty() && !by_cause.empty()) doubt.findings = FindDoubted(causes);
  if (doubt.findings.empty() && !few.empty()) doubt.findings = {FewCapturesBehind(few, edges)};
  return doubt;
}

// Names the sensors that have no pose, where others have one beside the reference, and those whose pose is in doubt.
Judgement NotVerified(Judgement judgement, const std::vector<Edge>& edges, const GraphSolution& solution,
                      const Policy& policy, const Doubt& doubt) {
  std::set<SensorId> known, unknown;
  for (const SensorPose& pose : solution.poses) (pose.known ? known : unknown).insert(pose.sensor);
  for (const Edge& edge : edges)
    for (const SensorId& sensor : {edge.frame_a, edge.frame_b})
      if (!known.contains(sensor) && !AsksForNoSensor(edge)) unknown.insert(sensor);
  unknown.insert(doubt.sensors.begin(), doubt.sensors.end());
  for (const SensorId& sensor : UncertainSensors(solution, policy)) unknown.insert(sensor);
  return known.size() > 1 ? Doubting(std::move(judgement), {unknown.begin(), unknown.end()}) : judgement;
}

// Edges that do not agree, and loops of them that do not close.
std::vector<Finding> FindAccusations(const std::vector<Edge>& edges, const GraphSolution& solution,
                                     const Policy& policy, const SessionTimes& captured_at) {
  std::vector<Finding> contradictions = FindContradictions(edges, solution, policy, captured_at);
  return contradictions.empty() ? Collect({FindOpenLoops(edges, solution, policy)}) : contradictions;
}

// Of loops that do not close, and of edges and sensors that others contradict.
std::set<SensorId> AccusedSensors(const std::vector<Edge>& edges, const GraphSolution& solution) {
  std::set<SensorId> accused;
  for (const CycleResidual* loop : solution.cycles.Loops())
    if (loop->fails()) accused.insert(loop->sensors.begin(), loop->sensors.end());
  for (const TwoPoses& two : solution.suspects.two_poses) accused.insert(two.sensor);
  for (const SuspectEdge& suspect : solution.suspects.edges)
    for (const Edge& edge : edges)
      if (edge.id == suspect.edge) accused.insert({edge.frame_a, edge.frame_b});
  return accused;
}

// What may be behind accusations stands before and after them.
std::vector<Finding> FindFailing(const std::vector<Edge>& edges, const GraphSolution& judged, const Policy& policy,
                                 const SessionTimes& captured_at, const std::vector<SessionEstimate>& estimates,
                                 const SessionHeaders& headers, const std::vector<RootCause>& causes) {
  const std::vector<Finding> accusations = FindAccusations(edges, judged, policy, captured_at);
  if (accusations.empty()) return FindMisplaced(causes, {});
  const std::set<SensorId> accused = AccusedSensors(edges, judged);
  std::set<SensorId> around = accused;
  if (const auto worst = MostContradicting(edges, judged, policy))
    around.insert({worst->edge->frame_a, worst->edge->frame_b});
  std::vector<Finding> failing = FindMisplaced(causes, around);
  if (auto off = FindOffNominal(edges, judged, headers, causes, around)) failing.push_back(std::move(*off));
  failing.insert(failing.end(), accusations.begin(), accusations.end());
  if (auto lens = FindLensBehind(estimates, accused)) failing.push_back(std::move(*lens));
  return failing;
}

std::vector<Finding> FindWarnings(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy,
                                  const SessionTimes& captured_at, const std::vector<SessionEstimate>& estimates,
                                  const std::vector<RootCause>& causes, bool pairs_disagree) {
  std::vector<Finding> warnings = FindingsOf(causes, [](const RootCause&) { return true; });
  for (Finding& other : Collect({FindApart(solution, policy, captured_at), FindMovedBoards(estimates, captured_at),
                                 FindLensMisfits(estimates, pairs_disagree),
                                 FindFailedEdges(UnexplainedFailures(edges, captured_at, causes)), FindPastPairs(edges),
                                 FindUncertainSensors(solution, policy), FindFewCaptures(edges, policy),
                                 FindUncheckedEdges(edges, solution, policy), FindUntestable(edges, solution, policy),
                                 FindUnrefined(estimates, captured_at), FindUnseenMoves(estimates, policy, captured_at),
                                 FindUncheckedSensors(edges, solution)}))
    warnings.push_back(std::move(other));
  return warnings;
}

// A weak edge that others disagree with is told once, with whom it would check.
std::vector<Finding> FindDisagreementsAndGaps(const std::vector<Edge>& edges, const GraphSolution& solution,
                                              const GraphSolution& judged, const Policy& policy,
                                              const OtherPaths& others) {
  std::vector<Finding> findings = FindLargeDisagreements(edges, judged, policy);
  for (Finding& gap : FindHardlyChecked(edges, solution, policy, others))
    if (std::none_of(findings.begin(), findings.end(),
                     [&](const Finding& told) { return told.what_to_do == gap.what_to_do; }))
      findings.push_back(std::move(gap));
  return findings;
}

// On a board of another size than given, sensors that sat still seem to have moved: who did is asked when that is
// mended.
std::vector<Finding> MendedBefore(const Finding& moved, const std::vector<RootCause>& causes) {
  std::vector<Finding> sizes = FindingsOf(
      causes, [](const RootCause& cause) { return cause.kind == CauseKind::kBoardSize && !cause.edges.empty(); });
  if (sizes.empty()) return {moved};
  sizes.push_back(
      {"sensors seem to have moved during the session, as a wrong size can make it look: that is told once it is right",
       ""});
  return sizes;
}

// Names who is known too little. Who is doubted because others are not to be relied on (FindRootCauses) is not to be
// relied on either.
void NameUncertain(const GraphSolution& solution, const Policy& policy, const Doubt& doubt, Judgement& judgement) {
  std::string& unverified = judgement.verdict.unverified = UncertainText(solution, policy);
  judgement.basis.doubted = UncertainSensors(solution, policy);
  if (!unverified.empty()) {
    std::set<SensorId> others = doubt.sensors;
    for (const SensorId& sensor : judgement.basis.doubted) others.erase(sensor);
    if (!others.empty()) unverified += ", " + ListAll({others.begin(), others.end()});
    judgement.basis.doubted.insert(judgement.basis.doubted.end(), others.begin(), others.end());
  }
  if (const auto uncertain = FindUncertainSensors(solution, policy)) {
    judgement.basis.decided_by = uncertain->figure;
    judgement.basis.culprits.clear();
  }
}

// `not_needed`: what `solution` was not measured in, and is taken as known.
Judgement JudgeMeasured(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy,
                        const SessionTimes& captured_at, const std::vector<SessionEstimate>& estimates,
                        const SessionHeaders& headers, const KnownBetween& between,
                        const std::vector<RootCause>& causes, const std::string& not_needed) {
  const std::set<std::string> names = NamesOf(edges, solution, causes);
  const auto say = [&](VerdictLevel level, const std::vector<Finding>& findings) {
    return JudgementFrom(level, findings, names);
  };
  if (const auto moved = FindMovedWithin(estimates, policy, captured_at))
    return say(VerdictLevel::kFail, MendedBefore(*moved, causes));
  const auto moved_now = [&](const RootCause& cause) {
    return cause.kind == CauseKind::kMovedWithin && IsOfNewestVisit(cause, edges, captured_at);
  };
  if (const auto moved = FindingsOf(causes, moved_now); !moved.empty()) return say(VerdictLevel::kFail, moved);
  const auto lenses = FindWrongIntrinsics(estimates, policy);
  if (lenses && lenses->is_beyond) return say(VerdictLevel::kFail, {lenses->finding});
  if (const auto nothing = FindNothing(edges, captured_at, causes); !nothing.empty())
    return say(VerdictLevel::kUnknown, nothing);
  // Residuals that are no optimum blame no edge.
  if (const auto unsettled = FindUnsettled(solution)) return say(VerdictLevel::kUnknown, {*unsettled});
  if (const auto moved = FindMovedBetween(solution, policy, captured_at)) return say(VerdictLevel::kFail, {*moved});
  const GraphSolution judged = WithoutRefinedPairs(edges, solution, policy, estimates);
  if (const auto failing =
          FindFailing(edges, WithoutSmall(judged, policy), policy, captured_at, estimates, headers, causes);
      !failing.empty())
    return say(VerdictLevel::kFail, failing);
  const Doubt doubt = FindDoubt(edges, solution, causes, FindLateDoubts(estimates, captured_at));
  if (const auto unknown = FindUnknown(edges, solution, headers, causes); !unknown.empty())
    return NotVerified(say(VerdictLevel::kUnknown, unknown), edges, solution, policy, doubt);
  if (!doubt.findings.empty())
    return Doubting(say(VerdictLevel::kUnknown, doubt.findings), {doubt.sensors.begin(), doubt.sensors.end()});
  const bool pairs_disagree = !FindAccusations(edges, WithoutSmall(solution, policy), policy, captured_at).empty();
  auto warnings = FindWarnings(edges, solution, policy, captured_at, estimates, causes, pairs_disagree);
  if (lenses) warnings.insert(warnings.begin(), lenses->finding);
  for (Finding& doubtful : FindDisagreementsAndGaps(edges, solution, judged, policy, between.others))
    warnings.push_back(std::move(doubtful));
  if (auto uncertain = FindUncertainPairs(policy, between.pairs)) warnings.push_back(std::move(*uncertain));
  const auto held_back = FindHeldBack(solution, headers);
  const std::string apart = ApartRemark(solution, policy, captured_at);
  const bool may_agree = warnings.empty() && apart.empty();  // else it is not said, and what disagrees is told
  const std::string remarks = Remarks(
      {held_back ? held_back->why : "", apart, TakenOutRemark(estimates), SmallDisagreements(edges, judged, policy),
       SmallMoves(estimates, solution, policy, captured_at), not_needed},
      names);
  const std::string assumed = Capitalised(ScaleTakenAsExact(edges, headers), names);
  const std::string by_pairs =
      may_agree ? Capitalised(ExcusedDisagreement(edges, solution, policy, pairs_disagree), names) : "";
  Judgement judgement =
      warnings.empty()
          ? Judgement{Pass(UntestedLoops(edges, solution), remarks, SmallestMoveNoticed(estimates, solution), by_pairs,
                           assumed),
                      {}}
          : say(UncertainText(solution, policy).empty() ? VerdictLevel::kWarn : VerdictLevel::kUnknown, warnings);
  NameUncertain(solution, policy, doubt, judgement);
  if (const std::string told = remarks + (assumed.empty() ? "" : assumed + ". "); !warnings.empty() && !told.empty())
    AddRemarks(told.substr(0, told.size() - 1), assumed.empty() ? "" : std::string(kMeasureTheBoard) + ".", judgement);
  if (held_back && warnings.empty())
    judgement.verdict.what_to_do = held_back->what_to_do + "; " + UntilItIsDue(assumed);
  return judgement;
}

}  // namespace

Judgement Judge(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy,
                const SessionTimes& captured_at, const std::vector<SessionEstimate>& estimates,
                const SessionHeaders& headers, const KnownBetween& between, const ExpectedRig& expected,
                const std::set<SensorId>& retired) {
  const auto taken = TakenAsKnown(solution, policy);
  // What was not measured sits where the drawing said, or the start: no cause is read from it.
  const std::vector<RootCause> causes = FindRootCauses(edges, solution, headers, captured_at, expected, retired);
  const GraphSolution& judged = taken ? *taken : solution;
  Judgement judgement = JudgeMeasured(edges, judged, policy, captured_at, estimates, headers, between, causes,
                                      NotNeededRemark(solution, policy, headers));
  judgement.basis.hardly_checked = EdgesHardlyChecked(edges, judged, policy, between.others);
  return judgement;
}

Verdict Assess(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy,
               const SessionTimes& captured_at, const std::vector<SessionEstimate>& estimates,
               const SessionHeaders& headers, const KnownBetween& between, const ExpectedRig& expected,
               const std::set<SensorId>& retired) {
  return Judge(edges, solution, policy, captured_at, estimates, headers, between, expected, retired).verdict;
}

}  // namespace rigcal::fleet
