// READ: what the store says of a robot's sessions and revisions, as answers and pages show it.
#pragma once

#include <vector>

#include "server/base/stamp.h"
#include "server/formats/answers/answers.h"
#include "storage/sessions/sessions.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// Without their standing, as storage::LoadSessions lists them.
[[nodiscard]] Result<std::vector<formats::SessionAnswer>> LoadSessionRows(storage::Store& store, const RobotId& robot,
                                                                          const SessionId& before, std::int64_t limit);
// Those that are still arriving, or whose pairs are still being calibrated.
[[nodiscard]] Result<std::vector<formats::SessionAnswer>> LoadOpenSessionRows(storage::Store& store,
                                                                              const RobotId& robot);
// Which of `rows`, sessions of the robot or of several if it is empty, are current, and by which the others are
// superseded.
[[nodiscard]] Status AddStanding(storage::Store& store, const RobotId& robot,
                                 std::vector<formats::SessionAnswer>& rows);
// Of the sensors that a session of the robot lists, those that are retired.
[[nodiscard]] Result<std::vector<RetiredSensor>> LoadRetiredSensorsIn(storage::Store& store, const RobotId& robot,
                                                                      const Manifest& manifest);
// With its standing.
[[nodiscard]] Result<formats::SessionAnswer> LoadSessionRow(storage::Store& store, const SessionId& id);
// The newest revision, or `number`; kNotFound names the robot.
[[nodiscard]] Result<Revision> LoadRevisionOf(storage::Store& store, const RobotId& robot, std::int64_t number);

// The same without the document.
[[nodiscard]] Result<Revision> LoadRevisionSummaryOf(storage::Store& store, const RobotId& robot, std::int64_t number);

}  // namespace rigcal::pipeline
