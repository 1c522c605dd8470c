#include "server/model/drive_rule.h"

#include <algorithm>
#include <cctype>

namespace rigcal {
namespace {

// The first thing to do, as the end of a sentence.
std::string FirstAction(const std::string& what_to_do) {
  std::string action = what_to_do.substr(0, std::min(what_to_do.find("; then "), what_to_do.find(". ")));
  if (!action.empty() && action.back() == '.') action.pop_back();
  if (!action.empty()) action.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(action.front())));
  return action;
}

std::string OverdueRule(const std::optional<Stamp>& due) {
  return due ? "Not verified: do not rely on it, overdue since " + DayText(*due) + "; capture again"
             : "Not verified: do not rely on it, nothing that it counts has a date; capture again";
}

std::string UnverifiedRule(const Verdict& verdict) {
  return "Not verified: do not rely on " + (verdict.unverified.empty() ? "this calibration" : verdict.unverified);
}

std::string WarnRule(const Verdict& verdict, Stamp due) {
  const std::string action = FirstAction(verdict.what_to_do);
  return action.empty() ? "OK to drive until " + DayText(due) : "OK to drive; " + action + " by " + DayText(due);
}

}  // namespace

DriveRule DriveRuleOf(const Verdict& verdict, const std::optional<Stamp>& due, Stamp now) {
  if (verdict.level == VerdictLevel::kFail) return {verdict.level, "Do not drive"};
  if (verdict.level == VerdictLevel::kUnknown) return {verdict.level, UnverifiedRule(verdict)};
  if (!due || *due < now) return {VerdictLevel::kWarn, OverdueRule(due)};
  if (verdict.level == VerdictLevel::kWarn) return {verdict.level, WarnRule(verdict, *due), due};
  return {verdict.level, "OK to drive until " + DayText(*due), due};
}

DriveRule DriveRuleOf(const Verdict& verdict, const Validity& validity) {
  const std::optional<Stamp> due = ValidUntil(validity);
  const std::int64_t due_ns = due ? due->ns : 0;
  return DriveRuleOf(verdict, due, Stamp{validity.overdue ? due_ns + 1 : due_ns});
}

}  // namespace rigcal
