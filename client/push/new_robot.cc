#include "client/push/new_robot.h"

#include <algorithm>

#include "client/text/table.h"
#include "server/base/limits.h"

namespace rigcal::client {
namespace {

constexpr std::size_t kShortId = 16;
constexpr std::int64_t kFilesAlikeMin = 3;  // a picture with the cap on the lens, or two, may be another's

// Of pictures and clouds, spread over the session. A table of poses may be the same for robots that are driven alike.
std::string DigestsOf(const std::vector<Payload>& payloads) {
  std::vector<std::string> all;
  for (const Payload& payload : payloads)
    if (!payload.path.ends_with(".csv") && payload.size_bytes > 0) all.push_back(payload.digest.str());
  const std::size_t asked = std::min(all.size(), limits::kDigestsAskedMax);
  std::string digests;
  for (std::size_t i = 0; i < asked; ++i) digests += (i == 0 ? "" : " ") + all[i * all.size() / asked];
  return digests;
}

}  // namespace

std::string SlipOf(Connection& connection, const RobotId& robot, std::chrono::milliseconds timeout) {
  const auto told = connection.AskDocument("known_robot", JsonObject({{"robot", robot.str()}}), timeout);
  if (!told || (*told)["known"].Flag(true) || (*told)["slip_of"].size() == 0) return "";
  return Plain((*told)["slip_of"][0].Text());
}

Status CheckNewRobot(Connection& connection, const RobotId& robot, std::chrono::milliseconds timeout) {
  const std::string known = SlipOf(connection, robot, timeout);
  if (known.empty()) return {};
  return Fail(
      ErrorCode::kConflict,
      "robot '" + robot.str() + "' is new, and " + known + " is known: push with --new-robot if it is another robot",
      "Else correct the name; nothing was sent");
}

Status CheckWhoseFiles(Connection& connection, const RobotId& robot, const std::vector<Payload>& payloads,
                       std::chrono::milliseconds timeout) {
  const std::string digests = DigestsOf(payloads);
  if (digests.empty()) return {};
  const std::string question = JsonObject({{"digests", digests}, {"robot", robot.str()}});
  const auto told = connection.AskDocument("known_files", question, timeout);
  if (!told) return {};
  const std::int64_t asked = (*told)["asked"].Integer().value_or(0), files = (*told)["files"].Integer().value_or(0);
  if (files < kFilesAlikeMin || 2 * files < asked) return {};
  const std::string another = Plain((*told)["robot"].Text("?"));
  return Fail(ErrorCode::kConflict,
              std::to_string(files) + " of " + std::to_string(asked) +
                  " files looked at are the same as in the session of robot " + another + " of " +
                  DayOf((*told)["captured_at"]) + " (" + Plain((*told)["session"].Text("?")).substr(0, kShortId) +
                  "), not of '" + robot.str() + "'",
              "Correct `robot:` in session.yaml, or push with --new-robot if they are of this robot; nothing was sent");
}

}  // namespace rigcal::client
