// READ: what the store says of each robot, as answers and pages show it.
#pragma once

#include <vector>

#include "server/base/stamp.h"
#include "server/formats/answers.h"
#include "storage/sessions.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// All robots, or only `robot` if it is not empty (kNotFound if there is none).
[[nodiscard]] Result<std::vector<storage::RobotRow>> LoadKnown(storage::Store& store, const RobotId& robot);
// Of the same, one row each, of its newest revision, sorted by id.
[[nodiscard]] Result<std::vector<formats::RobotAnswer>> LoadRobotRows(storage::Store& store, const RobotId& robot,
                                                                      Stamp now);
// Without their standing, as storage::LoadSessions lists them.
[[nodiscard]] Result<std::vector<formats::SessionAnswer>> LoadSessionRows(storage::Store& store, const RobotId& robot,
                                                                          const SessionId& before, std::int64_t limit);
// Those that are still arriving, or whose pairs are still being calibrated.
[[nodiscard]] Result<std::vector<formats::SessionAnswer>> LoadOpenSessionRows(storage::Store& store, const RobotId& robot);
// Which of `rows`, sessions of the robot or of several if it is empty, are current, and by which the others are superseded.
[[nodiscard]] Status AddStanding(storage::Store& store, const RobotId& robot,
                                 std::vector<formats::SessionAnswer>& rows);
// With its standing.
[[nodiscard]] Result<formats::SessionAnswer> LoadSessionRow(storage::Store& store, const SessionId& id);
// The newest revision, or `number`; kNotFound names the robot.
[[nodiscard]] Result<Revision> LoadRevisionOf(storage::Store& store, const RobotId& robot, std::int64_t number);

// The same without the document.
[[nodiscard]] Result<Revision> LoadRevisionSummaryOf(storage::Store& store, const RobotId& robot, std::int64_t number);

}  // namespace rigcal::pipeline
