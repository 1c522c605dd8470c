#include "server/report/pages/fleet_csv.h"

#include "server/report/edges/page_data.h"
#include "server/report/text/cause_words.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

std::string TimeField(const std::optional<Stamp>& at) { return "," + (at ? ToIso(*at) : std::string()); }

std::string WorstFields(const std::optional<WorstEdge>& worst) {
  if (!worst) return ",,,";
  return "," + CsvField(worst->frame_a.str()) + "," + CsvField(worst->frame_b.str()) + "," + Fixed(worst->in_sigmas, 3);
}

// Where its revision is in its life, which one it is to use, which one it says that it runs.
std::string LifeFields(const RobotSummary& robot) {
  const auto& usable = robot.validity.usable;
  const bool runs = robot.runs && robot.runs->revision > 0;
  return "," + (robot.revision > 0 ? NameOf(robot.state) : std::string()) + "," +
         (usable ? std::to_string(usable->number) : "") + "," + (runs ? std::to_string(robot.runs->revision) : "") +
         "," + CsvField(robot.runs ? robot.runs->trouble : "");
}

// Its status, by when it is due, and by what.
std::string StatusFields(const RobotSummary& robot, Stamp now) {
  const CalibrationStatus status = StatusAt(robot, now);
  const auto& drift = robot.drift_due;
  return "," + NameOf(status.word) + "," + CsvField(status.why) + "," + CsvField(status.next_step) +
         TimeField(DueAt(robot.validity, drift)) + TimeField(drift ? std::optional(drift->at) : std::nullopt) + "," +
         (drift ? CsvField(drift->sensor.str()) : "") + "," + CsvField(robot.site) + "," + CsvField(robot.rig_model) +
         "," + CsvField(robot.operator_name);
}

// What the page draws: "2026-01-31T12:00:00Z 0.420; ...", the oldest first.
std::string CalibrationsField(const std::vector<CalibrationPoint>& calibrations) {
  std::string text;
  for (const CalibrationPoint& point : calibrations)
    text += (text.empty() ? "" : "; ") + ToIso(point.calibrated_at) + " " +
            (point.worst_sigmas ? Fixed(*point.worst_sigmas, 3) : "-");
  return "," + CsvField(text);
}

std::string CausesField(const std::vector<std::string>& causes) {
  std::string text;
  for (const std::string& cause : causes) text += (text.empty() ? "" : "; ") + CauseText(cause);
  return "," + CsvField(text);
}

}  // namespace

std::string FleetCsvHeading() {
  return "robot,verdict,overdue,valid_until,calibrated_at,last_session_at,revision,sessions,edges,pairs_waiting,"
         "worst_frame_a,worst_frame_b,worst_sigmas,causes,why,what_to_do,state,in_use,runs,runs_trouble,status,status_"
         "why,next_step,due_at,drift_due_at,drift_sensor,site,"
         "rig_model,operator,calibrations\r\n";
}

std::string FleetCsvRow(const RobotSummary& robot, Stamp now) {
  const Validity& validity = robot.validity;
  return CsvField(robot.robot.str()) + "," + NameOf(robot.verdict.level) + "," + (validity.overdue ? "yes" : "no") +
         TimeField(ValidUntil(validity)) + TimeField(validity.calibrated_at) + TimeField(robot.last_session_at) + "," +
         (robot.revision > 0 ? std::to_string(robot.revision) : "") + "," + std::to_string(robot.sessions) + "," +
         std::to_string(robot.edges) + "," + std::to_string(robot.jobs_waiting) + WorstFields(robot.worst) +
         CausesField(robot.causes) + "," + CsvField(robot.verdict.why) + "," + CsvField(robot.verdict.what_to_do) +
         LifeFields(robot) + StatusFields(robot, now) + CalibrationsField(robot.calibrations) + "\r\n";
}

}  // namespace rigcal::report
