#include "server/report/certificate/content.h"

#include <algorithm>

#include "server/model/robots/drive_rule.h"
#include "server/report/certificate/parts.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kVerdictBytesMax = 450, kCureBytesMax = 220, kReasonBytesMax = 200;

// Whole sentences as far as they fit; what is cut off is said.
std::string FirstSentences(const std::string& text, std::size_t bytes_max) {
  if (text.size() <= bytes_max) return text;
  std::size_t end = text.rfind(". ", bytes_max - 1);
  end = end == std::string::npos ? text.rfind(' ', bytes_max - 1) : end + 1;
  return (end == std::string::npos ? std::string() : text.substr(0, end)) + " [...] The report has the rest.";
}

Verdict ShortVerdict(const formats::RevisionInput& revision) {
  Verdict verdict = revision.verdict;
  if (const std::vector<VerdictReason>& reasons = revision.basis.reasons; reasons.size() > 1) {
    verdict.why = reasons.front().why + " (" + Count(reasons.size() - 1, "more finding is", "more findings are") +
                  " in the report.)";
    verdict.what_to_do = reasons.front().what_to_do;
  }
  verdict.why = FirstSentences(verdict.why, kVerdictBytesMax);
  verdict.what_to_do = FirstSentences(verdict.what_to_do, kCureBytesMax);
  return verdict;
}

// A sheet with a place to sign reads as a permit.
void TakeTitle(const Verdict& verdict, const CertificateStanding& standing, Certificate& certificate) {
  const RevisionState state = standing.approval ? standing.approval->state : RevisionState::kCandidate;
  const bool usable = IsUsable(verdict);
  const VerdictLevel now = DriveRuleOf(verdict, standing.validity, standing.runs).level;  // overdue and past: not known
  certificate.to_sign =
      usable && state == RevisionState::kApproved && (now == VerdictLevel::kPass || now == VerdictLevel::kWarn);
  if (certificate.to_sign)
    certificate.title = "Calibration certificate";
  else
    certificate.title = usable && state == RevisionState::kSuperseded ? "Calibration record, superseded, no certificate"
                                                                      : "Calibration record, no certificate";
}

std::string StateWords(RevisionState state) {
  switch (state) {
    case RevisionState::kApproved:
      return "In use";
    case RevisionState::kCandidate:
      return "A candidate that nobody approved";
    case RevisionState::kUnusable:
      return "Not to be used, and nobody can approve it";
    case RevisionState::kTakenBack:
    case RevisionState::kSuperseded:
    case RevisionState::kRolledBack:
    case RevisionState::kRejected:
      break;
  }
  std::string words = WordFor(state);
  words.front() = static_cast<char>(words.front() - 'a' + 'A');
  return words;
}

// "In use: approved by Ada, 3 Nov 2026: checked against the wall."
std::string StateText(const std::optional<Approval>& approval) {
  if (!approval) return "Whether it is in use, the robot's page on the server says.";
  std::string text = StateWords(approval->state);
  if (!approval->decision) return text + ".";
  const Decision& decision = *approval->decision;
  text += ": " + (decision.how == "rolled_back" ? "rolled back to" : decision.how) + " by " + decision.word.who + ", " +
          DayText(decision.word.at);
  if (!decision.word.reason.empty()) text += ": " + FirstSentences(decision.word.reason, kReasonBytesMax);
  return text + ".";
}

}  // namespace

CertificateStanding StandingWhenDrawn(const ReportInput& input) { return {ValidityOf(input), input.approval}; }

Certificate CertificateOf(const ReportInput& input, const CertificateStanding& standing) {
  const formats::RevisionInput& revision = input.revision;
  Certificate certificate;
  certificate.robot = revision.robot;
  certificate.revision = input.number;
  const std::vector<const SessionFacts*> sessions = SessionsThatCount(input);
  const auto named =
      std::find_if(sessions.begin(), sessions.end(), [](const SessionFacts* one) { return !one->rig_model.empty(); });
  if (named != sessions.end()) certificate.rig_model = (*named)->rig_model;
  TakeTitle(revision.verdict, standing, certificate);
  certificate.measured = "Measured " + (input.calibrated_at ? TimeText(*input.calibrated_at) : "not known") +
                         ", solved " + TimeText(input.created_at) + ".";
  certificate.state = StateText(standing.approval);
  certificate.rule = DriveRuleOf(revision.verdict, standing.validity, standing.runs).rule + ".";
  certificate.verdict = ShortVerdict(revision);
  certificate.parts = {PosesPart(input), FoundPart(input),
                       MeasuredWithPart(input, standing.approval ? standing.approval->cause : "")};
  return certificate;
}

}  // namespace rigcal::report
