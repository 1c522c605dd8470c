#include "server/report/pages/fleet_row.h"

#include "server/report/drawings/calibration_strip.h"
#include "server/report/frame/banner.h"
#include "server/report/text/age.h"
#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

void FillWorst(Dictionary& row, const std::optional<WorstEdge>& worst) {
  if (!worst) return row.ShowSection("NO_WORST");
  Dictionary* one = row.AddSectionDictionary("WORST");
  one->SetValue("FROM", worst->frame_a.str());
  one->SetValue("TO", worst->frame_b.str());
  one->SetValue("SIGMAS", SigmasText(worst->in_sigmas));
  one->SetValue("LEVEL", SigmasClass(worst->in_sigmas));
}

// It may drive and is within its tolerances, with something to mend by a day.
bool IsToMend(StatusWord word, const Verdict& verdict) {
  return word == StatusWord::kOk && verdict.level == VerdictLevel::kWarn;
}

// Red is what must not drive: of a robot that may, the status asks for work.
const char* LevelOfStatus(StatusWord word, const Verdict& verdict) {
  if (word == StatusWord::kOk) return IsToMend(word, verdict) ? "warn" : "pass";
  if (word == StatusWord::kUnknown) return "unknown";
  return word == StatusWord::kFailed || !IsUsable(verdict) ? "fail" : "warn";
}

// Of what the verdict says by itself there is the word alone.
void FillStatus(Dictionary& row, const RobotSummary& robot, Stamp now) {
  const CalibrationStatus status = StatusAt(robot, now);
  row.SetValue("STATUS", IsToMend(status.word, robot.verdict) ? "to mend" : NameOf(status.word));
  row.SetValue("STATUS_LEVEL", LevelOfStatus(status.word, robot.verdict));
  const bool found = status.word == StatusWord::kDrifted || status.word == StatusWord::kOutOfTolerance;
  if (found) ShowValue(row, "STATUS_WHY", "TEXT", status.why);
  // What waits for a word is said with the verdict, what it runs beside it.
  if (found || status.word == StatusWord::kNotApplied) ShowValue(row, "STATUS_DO", "TEXT", status.next_step);
}

// A name that leads to the robots that share it.
void FillShared(Dictionary& row, const char* section, const std::string& name) {
  if (name.empty()) return;
  Dictionary* one = row.AddSectionDictionary(section);
  one->SetValue("TEXT", name);
  one->SetValue("KEY", InAddress(name));
}

// What it is, and where it stands.
void FillPlaces(Dictionary& row, const RobotSummary& robot) {
  if (!robot.rig_model.empty() || !robot.site.empty())
    ShowValue(row, "PLACED", "LABEL", robot.rig_model.empty() ? "Site" : "Rig model");
  FillShared(row, "MODEL", robot.rig_model);
  FillShared(row, "SITE", robot.site);
}

void FillDue(Dictionary& row, const RobotSummary& robot) {
  const std::optional<Stamp> due = IsNever(robot) ? std::nullopt : DueAt(robot.validity, robot.drift_due);
  if (!due) return;
  ShowValue(row, "DUE", "DAY", DayText(*due));
  const std::optional<Stamp> by_age = ValidUntil(robot.validity);
  if (*due != *by_age)
    ShowValue(row, "DRIFT", "TEXT", "by drift of " + robot.drift_due->sensor.str() + "; by age " + DayText(*by_age));
}

// Its newest revision, and how much it holds.
void FillRevision(Dictionary& row, const RobotSummary& robot) {
  row.SetValue("SESSIONS", Count(static_cast<std::size_t>(robot.sessions), "session", "sessions"));
  row.SetValue("EDGES", Count(static_cast<std::size_t>(robot.edges), "edge", "edges"));
  if (robot.revision == 0) return row.ShowSection("NO_REVISION");
  Dictionary* revision = row.AddSectionDictionary("REVISION");
  revision->SetValue("NUMBER", std::to_string(robot.revision));
  revision->SetValue("ROBOT", robot.robot.str());
}

// Whether it may drive, why, and what is to be done.
void FillRule(Dictionary& row, const RobotSummary& robot) {
  FillOverdue(row, robot.verdict, robot.validity, robot.runs);
  FillDrive(row, robot.verdict, robot.validity, robot.runs);
  FillBadge(row, robot.verdict.level);
  row.SetValue("WHY", robot.verdict.why);
  const bool asks = robot.verdict.level != VerdictLevel::kPass || robot.state == RevisionState::kCandidate;
  if (const std::string action = WhatToDo(robot.robot, robot.revision, robot.state, robot.verdict);
      asks && !action.empty())
    ShowValue(row, "DO", "WHAT_TO_DO", action);
  if (robot.revision > 0 && !IsUsable(robot.verdict))
    ShowValue(row, "KEEP", "TEXT", KeepText(robot.verdict.level, robot.validity.usable));
  if (robot.runs && !robot.runs->trouble.empty()) ShowValue(row, "RUNS", "TEXT", robot.runs->trouble);
  if (robot.jobs_waiting > 0)
    ShowValue(row, "WORKING", "TEXT",
              Count(static_cast<std::size_t>(robot.jobs_waiting), "pair", "pairs") + " being calibrated");
}

}  // namespace

void FillFleetRow(Dictionary& row, const RobotSummary& robot, Stamp now, bool has_places) {
  row.SetValue("ROBOT", robot.robot.str());
  FillRule(row, robot);
  FillStatus(row, robot, now);
  if (has_places) FillPlaces(*row.AddSectionDictionary("PLACES"), robot);
  if (!robot.operator_name.empty()) ShowValue(row, "OPERATOR", "TEXT", robot.operator_name);
  row.SetValue("AGE", IsNever(robot) ? "never" : AgeOf(*robot.validity.calibrated_at, now));
  FillDue(row, robot);
  row.SetValue("LAST", robot.last_session_at ? AgeOf(*robot.last_session_at, now) : "none");
  FillWorst(row, robot.worst);
  FillCalibrationStrip(row, robot, now);
  FillRevision(row, robot);
}

}  // namespace rigcal::report
