#include "server/report/frame/banner.h"

#include "server/model/robots/drive_rule.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

// Shapes differ as well as colours: a tick, a triangle, a cross, a question mark.
const char* IconOf(VerdictLevel level) {
  switch (level) {
    case VerdictLevel::kPass:
      return "M4 12.5l5.5 5.5L20 6.5";
    case VerdictLevel::kWarn:
      return "M12 3.5L22 20.5H2ZM12 10v4.5M12 17.4v.1";
    case VerdictLevel::kFail:
      return "M5.5 5.5l13 13M18.5 5.5l-13 13";
    case VerdictLevel::kUnknown:
      break;
  }
  return "M8 8.5a4 4 0 1 1 6 3.5c-1.4.8-2 1.6-2 3M12 18.9v.1";
}

}  // namespace

void FillBadge(Dictionary& row, VerdictLevel level) {
  row.SetValue("LEVEL", NameOf(level));
  row.SetValue("WORD", VerdictWord(level));
}

namespace {

// What is said of it once it is overdue: what else it is changes no rule.
std::string LateText(const Verdict& verdict, Validity validity, const std::optional<Runs>& runs) {
  if (!IsUsable(verdict)) return OverdueText(ValidUntil(validity));
  validity.overdue = true;
  return DriveRuleOf(verdict, validity, runs).rule + ".";
}

void FillReason(Dictionary& banner, const std::string& why, const std::string& what_to_do) {
  banner.SetValue("WHY", why);
  if (!what_to_do.empty()) ShowValue(banner, "DO", "WHAT_TO_DO", what_to_do);
}

void FillReasons(Dictionary& banner, const std::vector<VerdictReason>& reasons) {
  FillReason(banner, reasons.front().why, reasons.front().what_to_do);
  Dictionary* more = banner.AddSectionDictionary("MORE");
  more->SetValue("COUNT", Count(reasons.size() - 1, "more finding", "more findings"));
  for (std::size_t k = 1; k < reasons.size(); ++k) {
    Dictionary* reason = more->AddSectionDictionary("REASON");
    reason->SetValue("WHY", reasons[k].why);
    if (!reasons[k].what_to_do.empty()) ShowValue(*reason, "ITS_ACTION", "TEXT", reasons[k].what_to_do);  // not DO's
  }
}

}  // namespace

void FillOverdue(Dictionary& row, const Verdict& verdict, const Validity& validity, const std::optional<Runs>& runs) {
  const auto valid_until = ValidUntil(validity);
  if (!validity.overdue && !valid_until) return;
  Dictionary* late = row.AddSectionDictionary(validity.overdue ? "OVERDUE" : "LATER");
  if (!validity.overdue) late->SetValue("UNTIL", ToIso(*valid_until));
  late->SetValue("TEXT", LateText(verdict, validity, runs));
  late->SetValue("BADGE", valid_until ? "overdue" : "not calibrated");
  late->SetValue("LATE_WORD", valid_until ? "Overdue" : "Not calibrated");
  if (IsUsable(verdict)) late->ShowSection("WAS");
}

void FillDrive(Dictionary& row, const Verdict& verdict, const Validity& validity, const std::optional<Runs>& runs) {
  if (validity.overdue && IsUsable(verdict)) return;
  const DriveRule drive = DriveRuleOf(verdict, validity, runs);
  Dictionary* section = row.AddSectionDictionary("DRIVE");
  section->SetValue("TEXT", drive.rule + ".");
  if (drive.until) section->ShowSection("ENDS");
}

void FillBanner(Dictionary& page, const Verdict& verdict, const Validity& validity, bool has_revision,
                const std::optional<Runs>& runs, const VerdictBasis& basis) {
  Dictionary* banner = page.AddIncludeDictionary("BANNER");
  banner->SetFilename("banner.tpl");
  FillBadge(*banner, verdict.level);
  banner->SetValue("ICON", IconOf(verdict.level));
  if (basis.reasons.size() > 1)
    FillReasons(*banner, basis.reasons);
  else
    FillReason(*banner, verdict.why.empty() ? "There is no verdict yet." : verdict.why, verdict.what_to_do);
  FillDrive(*banner, verdict, validity, runs);
  if (!has_revision) return;
  FillOverdue(*banner, verdict, validity, runs);
  if (!IsUsable(verdict)) ShowValue(*banner, "KEEP", "TEXT", KeepText(verdict.level, validity.usable));
}

}  // namespace rigcal::report
