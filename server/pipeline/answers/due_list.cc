#include "server/pipeline/answers/due_list.h"

#include <algorithm>

#include "server/base/text.h"
#include "server/formats/alerts/calendar.h"
#include "server/formats/alerts/webhook_answers.h"
#include "server/pipeline/robots/summaries.h"
#include "storage/fleet/fleet_list.h"

namespace rigcal::pipeline {
namespace {

std::string DescriptionOf(const RobotSummary& robot, const std::string& http_address, Stamp now) {
  const CalibrationStatus status = StatusAt(robot, now);
  std::string text = DueText(robot.validity, robot.drift_due) + "\n" + NameOf(status.word) + ": " + status.why + "\n" +
                     status.next_step;
  if (!http_address.empty()) text += "\n" + http_address + "/robots/" + robot.robot.str() + "/";
  return text;
}

// It was found out when its calibration was measured: the same data are the same entry, whenever it is asked for.
formats::CalendarEntry EntryOf(const RobotSummary& robot, Stamp due, const std::string& http_address) {
  const bool by_drift = robot.drift_due && robot.drift_due->at == due;
  formats::CalendarEntry entry;
  entry.uid = robot.robot.str() + ".calibration@rigcal";
  entry.day = due;
  entry.known_at = *robot.validity.calibrated_at;
  entry.sequence = robot.revision;
  entry.summary =
      "Calibrate " + robot.robot.str() + (by_drift ? " (drift of " + robot.drift_due->sensor.str() + ")" : "");
  entry.description = DescriptionOf(robot, http_address, due);
  entry.location = robot.site;
  return entry;
}

// An empty calendar would say for ever that nothing is due there.
Error NobodyAt(const std::string& site) {
  return {ErrorCode::kNotFound, "no robot is at the site " + Quoted(site),
          "Write it as session.yaml does, under conditions; `rigcal due --json` has the site of each robot."};
}

}  // namespace

Result<DueCalendar> MakeDueCalendar(const AnswerContext& context, const formats::Parameters& parameters) {
  FleetQuery asked;
  asked.sort = "robot";
  asked.site = parameters.Text("site").value_or("");
  static_cast<void>(FreshenSummaries(context.store, context.clock));  // what could not be kept is there soon
  DueCalendar calendar;
  std::vector<formats::CalendarEntry> entries;
  const auto add = [&](const RobotSummary& robot) {
    const std::optional<Stamp> due = DueAt(robot.validity, robot.drift_due);
    due ? entries.push_back(EntryOf(robot, *due, context.http_address)) : void(++calendar.without_date);
  };
  RIGCAL_TRY(context.store.Read([&] { return storage::ForEachRobot(context.store, asked, context.clock.Now(), add); }));
  if (!asked.site.empty() && entries.empty() && calendar.without_date == 0) return Fail(NobodyAt(asked.site));
  const std::string name = asked.site.empty() ? "Calibrations due" : "Calibrations due: " + asked.site;
  calendar.text = formats::WriteCalendar(name, entries);
  return calendar;
}

Result<std::string> TellDueCalendar(const AnswerContext& context, const formats::Parameters& parameters) {
  RIGCAL_ASSIGN(const DueCalendar calendar, MakeDueCalendar(context, parameters));
  return formats::WriteDueCalendar(calendar.text, calendar.without_date);
}

}  // namespace rigcal::pipeline
