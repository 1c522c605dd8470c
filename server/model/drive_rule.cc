#include "server/model/drive_rule.h"

#include <algorithm>
#include <cctype>
#include <cstring>

namespace rigcal {
namespace {

// Where what is to be done first ends; a command between backticks is no place to end.
std::size_t EndOfFirst(const std::string& what_to_do) {
  bool quoted = false;
  for (std::size_t i = 0; i < what_to_do.size(); ++i) {
    quoted ^= what_to_do[i] == '`';
    for (const char* mark : {"; ", ". ", ": ", ", then `"})
      if (!quoted && what_to_do.compare(i, std::strlen(mark), mark) == 0) return i;
  }
  return what_to_do.size();
}

// The first thing to do, as the end of a sentence; what explains it is told by the verdict.
std::string FirstAction(const std::string& what_to_do) {
  std::string action = what_to_do.substr(0, EndOfFirst(what_to_do));
  if (action.find('?') != std::string::npos) action = "answer what the verdict asks";
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
  if (validity.superseded_by)
    return {VerdictLevel::kUnknown, "Superseded by revision " + std::to_string(*validity.superseded_by) +
                                        ": what this one says of driving is past"};
  const std::optional<Stamp> due = ValidUntil(validity);
  const std::int64_t due_ns = due ? due->ns : 0;
  return DriveRuleOf(verdict, due, Stamp{validity.overdue ? due_ns + 1 : due_ns});
}

}  // namespace rigcal
