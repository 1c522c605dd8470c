#include "server/model/robots/robot_status.h"

#include <algorithm>

#include "server/model/approval/decision.h"
#include "server/model/robots/drive_rule.h"
#include "server/model/robots/robot_summary.h"

namespace rigcal {
namespace {

constexpr std::array<const char*, kStatusWords.size()> kStatusNames = {
    "ok", "due", "overdue", "not-applied", "to-approve", "drifted", "out-of-tolerance", "failed", "unknown"};
constexpr const char* kNothingToDo = "Nothing is to be done.";

std::string DriftWords(const DriftDue& due) { return DayText(due.at) + " by drift of " + due.sensor.str(); }

// What was never calibrated is not late: there was no date.
CalibrationStatus OverdueStatus(const Validity& validity) {
  const char* step = "Capture a session and push it.";
  const std::optional<Stamp> until = ValidUntil(validity);
  if (!until) return {StatusWord::kUnknown, "Nothing of it is calibrated.", step};
  return {StatusWord::kOverdue, "It was to be calibrated again by " + DayText(*until) + ".", step};
}

// Not of a date that is further away.
std::optional<CalibrationStatus> DueStatus(const Validity& validity, const std::optional<DriftDue>& drift_due,
                                           Stamp now) {
  const std::optional<Stamp> due = DueAt(validity, drift_due);
  if (!due || due->ns - now.ns > kDueSoon_ns) return std::nullopt;
  return CalibrationStatus{StatusWord::kDue, "It is " + DueText(validity, drift_due) + ".",
                           "Capture a session and push it before it is relied on after " + DayText(*due) + "."};
}

CalibrationStatus OkStatus(const Validity& validity, const std::optional<DriftDue>& drift_due) {
  const std::string due = DueText(validity, drift_due);
  return {StatusWord::kOk, due.empty() ? "It is within its tolerances." : "It is within its tolerances; " + due + ".",
          kNothingToDo};
}

// A revision that nobody decided about; or any that may be used, where none is.
bool AwaitsWord(const RobotSummary& robot) {
  return robot.state == RevisionState::kCandidate || !robot.validity.usable;
}

std::string ApproveStep(const RobotSummary& robot) {
  if (robot.state == RevisionState::kCandidate)
    return WhatToDo(robot.robot, robot.revision, robot.state, {VerdictLevel::kPass, "", ""});
  return "Capture a session and push it, or approve a revision that is right: `rigcal history " + robot.robot.str() +
         "` lists them.";
}

std::string ApplyStep(const RobotSummary& robot) {
  const auto& in_use = robot.validity.usable;
  if (!in_use) return ApproveStep(robot);
  const std::string apply =
      "See to it that `rigcal agent` runs on the robot: it applies revision " + std::to_string(in_use->number) + ".";
  return robot.state == RevisionState::kCandidate ? apply + " Then: " + ApproveStep(robot) : apply;
}

// What is to be done so that the robot has what it is to have, as its drive rule says; nothing: that it has.
std::optional<CalibrationStatus> RolloutOf(const RobotSummary& robot) {
  const DriveRule drive = DriveRuleOf(robot.verdict, robot.validity, robot.runs);
  if (drive.kind == DriveKind::kNotApplied)
    return CalibrationStatus{StatusWord::kNotApplied, robot.runs->trouble, ApplyStep(robot)};
  if (drive.kind != DriveKind::kToApprove || !AwaitsWord(robot)) return std::nullopt;
  return CalibrationStatus{StatusWord::kToApprove, drive.rule + ".", ApproveStep(robot)};
}

// Whether that is what is told of a robot which is `word` by itself.
bool GoesBefore(StatusWord rollout, StatusWord word) {
  return word == StatusWord::kOk || word == StatusWord::kDue ||
         (word == StatusWord::kDrifted && rollout == StatusWord::kNotApplied);
}

// What was found is looked after before anybody approves it; a candidate may make the visit needless.
std::string StepsOf(const CalibrationStatus& status, const CalibrationStatus& rollout, RevisionState state) {
  if (status.next_step.empty() || status.next_step == kNothingToDo) return rollout.next_step;
  if (status.word == StatusWord::kDrifted || status.word == StatusWord::kOutOfTolerance)
    return status.next_step + " Then: " + rollout.next_step;
  const bool asks_for_visit = status.word == StatusWord::kOverdue || status.word == StatusWord::kDue;
  const bool is_either = asks_for_visit && state == RevisionState::kCandidate;
  return rollout.next_step + (is_either ? " Else: " : " ") + status.next_step;
}

}  // namespace

std::string NameOf(StatusWord word) { return kStatusNames[static_cast<std::size_t>(word)]; }

StatusWord StatusWordOf(const std::string& name) {
  const auto* const found = std::find(kStatusNames.begin(), kStatusNames.end(), name);
  return found == kStatusNames.end() ? StatusWord::kUnknown
                                     : kStatusWords[static_cast<std::size_t>(found - kStatusNames.begin())];
}

std::string NameOf(DriftLaw law) { return law == DriftLaw::kLinear ? "linear" : "random_walk"; }

DriftLaw DriftLawOf(const std::string& name) { return name == "linear" ? DriftLaw::kLinear : DriftLaw::kRandomWalk; }

CalibrationStatus FoundOf(const StatusFacts& facts) {
  const CalibrationStatus* worst = nullptr;
  for (const SensorStatus& sensor : facts.sensors) {
    const StatusWord word = sensor.status.word;
    if (word != StatusWord::kDrifted && word != StatusWord::kOutOfTolerance) continue;
    if (worst == nullptr || worst->word < word) worst = &sensor.status;
  }
  return worst == nullptr ? CalibrationStatus{} : *worst;
}

std::optional<DriftDue> DriftDueOf(const StatusFacts& facts) {
  std::optional<DriftDue> first;
  for (const SensorStatus& sensor : facts.sensors)
    if (sensor.due && (!first || sensor.due->at < first->at)) first = sensor.due;
  return first;
}

CalibrationStatus StatusAt(const StatusBasis& basis, Stamp now) {
  const Verdict& verdict = basis.verdict;
  const CalibrationStatus unknown = {StatusWord::kUnknown, verdict.why, verdict.what_to_do};
  if (basis.revision == 0) return unknown;
  if (verdict.level == VerdictLevel::kFail) return {StatusWord::kFailed, verdict.why, verdict.what_to_do};
  if (basis.found.word == StatusWord::kOutOfTolerance) return basis.found;
  if (verdict.level == VerdictLevel::kUnknown) return unknown;
  if (IsOverdue(basis.validity.calibrated_at, basis.validity.max_age_ns, now)) return OverdueStatus(basis.validity);
  if (basis.found.word == StatusWord::kDrifted) return basis.found;
  CalibrationStatus ok = OkStatus(basis.validity, basis.drift_due);
  if (verdict.level == VerdictLevel::kWarn) ok.next_step = verdict.what_to_do;
  return DueStatus(basis.validity, basis.drift_due, now).value_or(ok);
}

CalibrationStatus StatusAt(const RobotSummary& robot, Stamp now) {
  CalibrationStatus status =
      StatusAt({robot.revision, robot.verdict, robot.validity, robot.found, robot.drift_due}, now);
  const std::optional<CalibrationStatus> rollout = robot.revision > 0 ? RolloutOf(robot) : std::nullopt;
  if (!rollout) return status;
  status.next_step = StepsOf(status, *rollout, robot.state);
  if (!GoesBefore(rollout->word, status.word)) return status;
  const bool says_more = status.word != StatusWord::kOk;
  return {rollout->word, says_more ? rollout->why + " " + status.why : rollout->why, status.next_step};
}

CalibrationStatus StatusAt(const SensorStatus& sensor, const Validity& validity, Stamp now) {
  const StatusWord word = sensor.status.word;
  if (word != StatusWord::kOk && word != StatusWord::kDrifted) return sensor.status;
  if (IsOverdue(validity.calibrated_at, validity.max_age_ns, now)) return OverdueStatus(validity);
  if (word == StatusWord::kDrifted) return sensor.status;
  return DueStatus(validity, sensor.due, now).value_or(OkStatus(validity, sensor.due));
}

std::optional<Stamp> DueAt(const Validity& validity, const std::optional<DriftDue>& drift_due) {
  const std::optional<Stamp> by_age = ValidUntil(validity);
  return by_age && drift_due ? std::min(*by_age, drift_due->at) : by_age;
}

std::string DueText(const Validity& validity, const std::optional<DriftDue>& drift_due) {
  const std::optional<Stamp> by_age = ValidUntil(validity);
  if (!by_age) return "";
  const std::string by_age_text = "due " + DayText(*by_age) + " by age";
  return drift_due && drift_due->at < *by_age ? by_age_text + "; " + DriftWords(*drift_due) : by_age_text;
}

}  // namespace rigcal
