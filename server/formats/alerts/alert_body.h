// The body of an alert, as a receiver gets it (docs/alerts.md):
// {"at", "data": {...}, "format": 1, "id", "kind", "robot"}.
#pragma once

#include <functional>
#include <string>

#include "server/formats/json/json_writer.h"
#include "server/model/approval/decision.h"
#include "server/model/robots/alert.h"
#include "server/model/robots/robot_status.h"

namespace rigcal::formats {

// What happened, before it has a number and an id.
struct AlertDraft {
  RobotId robot;
  std::string kind, subject;
  Stamp at;
  std::function<void(JsonWriter&)> data;  // the members of "data"
};
// `before`: its status until now.
[[nodiscard]] AlertDraft StatusAlert(const RobotId& robot, int revision, StatusWord before,
                                     const CalibrationStatus& status, Stamp at);
// Of a decision that was made just now; `decision.how` is the kind.
[[nodiscard]] AlertDraft DecisionAlert(const RobotId& robot, const Decision& decision);
// Of a session of which no pair of sensors was calibrated.
[[nodiscard]] AlertDraft SessionFailedAlert(const RobotId& robot, const SessionId& session,
                                            const std::optional<Stamp>& captured_at, int revision,
                                            const Verdict& verdict, Stamp at);

// The id follows from what happened and its number; the same draft and number give the same bytes.
[[nodiscard]] Alert AlertOf(const AlertDraft& draft, std::int64_t number);

}  // namespace rigcal::formats
