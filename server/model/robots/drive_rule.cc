#include "server/model/robots/drive_rule.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <initializer_list>
#include <utility>

namespace rigcal {
namespace {

// Where one of these stands first; what is between backticks is a command. npos: nowhere.
std::size_t FindPlain(const std::string& text, std::initializer_list<const char*> marks) {
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    quoted ^= text[i] == '`';
    for (const char* mark : marks)
      if (!quoted && text.compare(i, std::strlen(mark), mark) == 0) return i;
  }
  return std::string::npos;
}

// The first thing to do, as the end of a sentence. It ends where its sentence, or this step of it, does; what is cut
// in between may say the contrary.
std::string FirstAction(const std::string& what_to_do) {
  std::string action = what_to_do.substr(0, FindPlain(what_to_do, {"; then ", ". ", ", then `"}));
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

std::string UnapprovedRule(const std::optional<UsableRevision>& in_use) {
  if (!in_use) return "Not approved: do not rely on it before somebody approves it";
  const std::optional<Stamp> until = ValidUntil(*in_use);
  return "Not approved: robots have " + MeasuredText(*in_use) + (until ? ", valid until " + DayText(*until) : "");
}

std::string NotAppliedRule(const Runs& runs, const std::optional<UsableRevision>& in_use) {
  if (!in_use) return "Do not rely on it: the robot runs " + runs.what + ", and no calibration of it is in use";
  return "Not applied: the robot runs " + runs.what + "; revision " + std::to_string(in_use->number) + " is in use";
}

std::string WarnRule(const Verdict& verdict, Stamp due) {
  const std::string action = FirstAction(verdict.what_to_do);
  if (action.empty()) return "OK to drive until " + DayText(due);
  const bool has_parts = FindPlain(action, {", ", "; ", ": "}) != std::string::npos;  // the day is of all of them
  return "OK to drive; " + action + (has_parts ? ", by " : " by ") + DayText(due);
}

DriveRule NotKnown(DriveKind kind, std::string rule) { return {kind, VerdictLevel::kUnknown, std::move(rule)}; }

struct DriveWords {
  DriveKind kind;
  const char *name, *words;
};
constexpr std::array<DriveWords, kDriveKinds.size()> kDriveWords = {
    {{DriveKind::kDoNotDrive, "do_not_drive", "do not drive"},
     {DriveKind::kNotVerified, "not_verified", "not verified"},
     {DriveKind::kNotApplied, "not_applied", "not applied"},
     {DriveKind::kToApprove, "to_approve", "to be approved"},
     {DriveKind::kSuperseded, "superseded", "superseded"},
     {DriveKind::kOkWithAction, "ok_with_action", "warn"},
     {DriveKind::kOk, "ok", "OK to drive"}}};

const DriveWords& DriveWordsOf(DriveKind kind) { return kDriveWords[static_cast<std::size_t>(kind)]; }

}  // namespace

std::string NameOf(DriveKind kind) { return DriveWordsOf(kind).name; }

std::string WordsFor(DriveKind kind) { return DriveWordsOf(kind).words; }

std::optional<DriveKind> DriveKindOf(const std::string& name) {
  for (const DriveWords& one : kDriveWords)
    if (name == one.name) return one.kind;
  return std::nullopt;
}

DriveRule DriveRuleOf(const Verdict& verdict, const std::optional<Stamp>& due, Stamp now) {
  if (verdict.level == VerdictLevel::kFail) return {DriveKind::kDoNotDrive, verdict.level, "Do not drive"};
  if (verdict.level == VerdictLevel::kUnknown) return NotKnown(DriveKind::kNotVerified, UnverifiedRule(verdict));
  if (!due || *due < now) return NotKnown(DriveKind::kNotVerified, OverdueRule(due));
  if (verdict.level == VerdictLevel::kWarn)
    return {DriveKind::kOkWithAction, verdict.level, WarnRule(verdict, *due), due};
  return {DriveKind::kOk, verdict.level, "OK to drive until " + DayText(*due), due};
}

DriveRule DriveRuleOf(const Verdict& verdict, const Validity& validity, const std::optional<Runs>& runs) {
  if (validity.superseded_by)
    return NotKnown(DriveKind::kSuperseded, "Superseded by revision " + std::to_string(*validity.superseded_by) +
                                                ": what this one says of driving is past");
  if (runs && !runs->trouble.empty() && verdict.level != VerdictLevel::kFail)
    return NotKnown(DriveKind::kNotApplied, NotAppliedRule(*runs, validity.usable));
  if (!validity.approved) return NotKnown(DriveKind::kToApprove, UnapprovedRule(validity.usable));
  const std::optional<Stamp> due = ValidUntil(validity);
  const std::int64_t due_ns = due ? due->ns : 0;
  return DriveRuleOf(verdict, due, Stamp{validity.overdue ? due_ns + 1 : due_ns});
}

}  // namespace rigcal
