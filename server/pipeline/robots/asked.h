// READ: what a request asks for: the ids that its parameters name, which page of a list, what an order is about, and
// who gives it.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "server/base/ids.h"
#include "server/formats/answers/parameters.h"
#include "server/model/approval/standing.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// Of a page's address: its query string.
[[nodiscard]] Result<formats::Parameters> ParametersAsked(const std::string& query);

// kInvalidInput where the parameter is missing or no id.
template <typename IdType>
[[nodiscard]] Result<IdType> RequiredId(const formats::Parameters& parameters, const std::string& name) {
  const auto text = parameters.Text(name);
  if (!text)
    return Fail(ErrorCode::kInvalidInput, "the parameter '" + name + "' is missing",
                "See docs/api.md for the verb's parameters.");
  return IdType::Parse(*text);
}
// Empty where the parameter is not there.
template <typename IdType>
[[nodiscard]] Result<IdType> OptionalId(const formats::Parameters& parameters, const std::string& name) {
  return parameters.Text(name) ? RequiredId<IdType>(parameters, name) : IdType();
}
// For a robot that the store does not know: UnknownRobot.
[[nodiscard]] Result<RobotId> KnownRobot(storage::Store& store, const formats::Parameters& parameters);

// Rows of a page, `limit`; with `before` alone as many as there may be. 0: the whole list is asked for.
[[nodiscard]] Result<std::int64_t> PageRows(const formats::Parameters& parameters);

// `before` as the number of a revision; 0 where it is not there.
[[nodiscard]] Result<int> RevisionBefore(const formats::Parameters& parameters);

// Of rows of which one more than the page holds was loaded, that one goes: whether another page follows.
template <typename Row>
[[nodiscard]] bool CutToPage(std::int64_t page_rows, std::vector<Row>& rows) {
  if (page_rows == 0 || static_cast<std::int64_t>(rows.size()) <= page_rows) return false;
  rows.erase(rows.begin() + page_rows, rows.end());
  return true;
}

// One thing that an order is about.
struct SensorOfRobot {
  RobotId robot;
  SensorId sensor;
};
using Subject = std::variant<EdgeId, SessionId, SensorOfRobot>;

// Who decides, in the parameter `who`: kInvalidInput also of a name that is no person's (CheckPerson).
[[nodiscard]] Result<std::string> RequiredWho(const formats::Parameters& parameters, const std::string& cure);
// kInvalidInput, with `cure`, where the parameter is missing or blank.
[[nodiscard]] Result<std::string> RequiredText(const formats::Parameters& parameters, const std::string& name,
                                               const std::string& cure);

// Who says it and why, both required; `who_cure`, `reason_cure`: what to do where one is missing.
[[nodiscard]] Result<Word> RequiredWord(const formats::Parameters& parameters, Stamp now, const std::string& who_cure,
                                        const std::string& reason_cure);

// `edge` or `session`: an id or its first 8 digits or more, of `robot` if that is there. `sensor`: of `robot`. `thing`:
// any of these, whichever there is; a sensor of that very name comes first. kNotFound, kConflict (several begin so),
// kInvalidInput name what is wrong.
[[nodiscard]] Result<Subject> FindSubject(storage::Store& store, const formats::Parameters& parameters);

}  // namespace rigcal::pipeline
