#include <algorithm>

#include "server/fleet/findings.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {

std::optional<Finding> FindMovedWithin(const std::vector<SessionEstimate>& estimates, const SessionTimes& captured_at) {
  const auto moved = std::find_if(estimates.begin(), estimates.end(), [](const auto& one) { return !one.moved.empty(); });
  if (moved == estimates.end()) return std::nullopt;
  Finding finding;
  std::vector<std::string> names;
  for (const SensorMovedWithin& one : moved->moved) {
    finding.why += (names.empty() ? "" : "; ") + one.sensor.str() + " was moved during the session of " +
                   NameOfSession(moved->session, captured_at) + ", between captures " + one.last_before.str() + " and " +
                   one.first_after.str() + ", by " + OffText(one.step);
    if (std::find(names.begin(), names.end(), one.sensor.str()) == names.end()) names.push_back(one.sensor.str());
  }
  std::string flags;
  for (const std::string& name : names) flags += (flags.empty() ? "" : ",") + name;
  finding.what_to_do =
      "Tighten the mount of " + List(names) + ", capture again, then `rigcal push FOLDER --remounted " + flags + "`";
  return finding;
}

std::optional<Finding> FindMovedBoards(const std::vector<SessionEstimate>& estimates, const SessionTimes& captured_at) {
  const auto newest = std::find_if(estimates.begin(), estimates.end(), [](const auto& one) { return one.why_not.empty(); });
  if (newest == estimates.end() || newest->boards_moved.empty()) return std::nullopt;
  Finding finding;
  for (const BoardMovedWithin& one : newest->boards_moved)
    finding.why += (finding.why.empty() ? "board " : "; board ") + one.board.str() + " was moved during the session of " +
                   NameOfSession(newest->session, captured_at) + ", between captures " + one.last_before.str() + " and " +
                   one.first_after.str() + ", by " + OffText(one.step);
  finding.what_to_do = "Fasten the board before the next session; poses of this one tell its two places apart, as far as "
                       "each was seen";
  return finding;
}

std::optional<Finding> FindMovedBetween(const GraphSolution& solution, const SessionTimes& captured_at) {
  const std::vector<SensorMovedBetween>& moved = solution.fused.moved;
  if (moved.empty()) return std::nullopt;
  Finding finding;
  std::vector<std::string> names;
  for (const SensorMovedBetween& one : moved) {
    finding.why += (names.empty() ? "" : "; ") + one.sensor.str() + " was moved between the sessions of " +
                   NameOfSession(one.last_before, captured_at) + " and " + NameOfSession(one.first_after, captured_at) +
                   ", by " + OffText(one.step);
    if (std::find(names.begin(), names.end(), one.sensor.str()) == names.end()) names.push_back(one.sensor.str());
  }
  std::string flags;
  for (const std::string& name : names) flags += (flags.empty() ? "" : ",") + name;
  const SensorMovedBetween& first = moved.front();
  finding.what_to_do = "Was " + List(names) + " moved after " + NameOfSession(first.last_before, captured_at) +
                       "? Yes: `rigcal push FOLDER --remounted " + flags + "` of the session of " +
                       NameOfSession(first.first_after, captured_at) + ". No: tighten the mount, capture again";
  return finding;
}

}  // namespace rigcal::fleet
