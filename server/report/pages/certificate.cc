#include "server/report/pages/certificate.h"

#include <algorithm>
#include <set>

#include "server/model/edges/merged_edge.h"
#include "server/model/edges/past.h"
#include "server/report/frame/assets.h"
#include "server/report/frame/banner.h"
#include "server/report/pages/certified_sensors.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kCertifiedBoardsMax = 4, kCertifiedSessionsMax = 4;
constexpr std::size_t kVerdictBytesMax = 450, kCureBytesMax = 220;

// Sessions with an edge that counts, the newest first.
std::vector<const SessionFacts*> SessionsThatCount(const ReportInput& input) {
  std::set<SessionId> ids;
  for (const Edge& edge : input.revision.edges)
    if (edge.state == EdgeState::kGood && !IsPast(edge)) ids.insert(edge.session);
  std::vector<const SessionFacts*> sessions;
  for (const SessionFacts& facts : input.sessions)
    if (ids.contains(facts.id)) sessions.push_back(&facts);
  std::sort(sessions.begin(), sessions.end(), [](const SessionFacts* x, const SessionFacts* y) {
    return x->captured_at != y->captured_at ? x->captured_at > y->captured_at : x->id < y->id;
  });
  return sessions;
}

void FillCertifiedBoards(Dictionary& page, const std::vector<std::string>& boards) {
  if (boards.empty()) return;
  Dictionary* list = page.AddSectionDictionary("BOARDS");
  for (std::size_t i = 0; i < std::min(boards.size(), kCertifiedBoardsMax); ++i)
    ShowValue(*list, "BOARD", "NAME", boards[i]);
  if (boards.size() > kCertifiedBoardsMax)
    ShowValue(*list, "MORE_BOARDS", "COUNT", Count(boards.size() - kCertifiedBoardsMax, "board", "boards"));
}

void FillSessionsAndBoards(Dictionary& page, const std::vector<const SessionFacts*>& sessions) {
  std::vector<std::string> boards;
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    for (const std::string& board : sessions[i]->boards)
      if (std::find(boards.begin(), boards.end(), board) == boards.end()) boards.push_back(board);
    if (i >= kCertifiedSessionsMax) continue;
    Dictionary* row = page.AddSectionDictionary("SESSION");
    row->SetValue("CAPTURED", TimeText(sessions[i]->captured_at));
    row->SetValue("SHORT", ShortDigest(sessions[i]->id.str()));
    if (!sessions[i]->operator_name.empty()) ShowValue(*row, "OPERATOR", "NAME", sessions[i]->operator_name);
  }
  if (sessions.size() > kCertifiedSessionsMax)
    ShowValue(page, "MORE_SESSIONS", "COUNT",
              Count(sessions.size() - kCertifiedSessionsMax, "older session", "older sessions"));
  FillCertifiedBoards(page, boards);
}

void FillMeasuredWith(Dictionary& page, const ReportInput& input) {
  const std::vector<const SessionFacts*> sessions = SessionsThatCount(input);
  const auto named =
      std::find_if(sessions.begin(), sessions.end(), [](const SessionFacts* one) { return !one->rig_model.empty(); });
  if (named != sessions.end()) ShowValue(page, "RIG", "NAME", (*named)->rig_model);
  FillSessionsAndBoards(page, sessions);
  const auto counts = [](const Edge& edge) { return edge.state == EdgeState::kGood && !IsPast(edge); };
  std::size_t pushed = 0, merged = 0;
  for (const Edge& edge : input.revision.edges) {
    pushed += counts(edge) && edge.session.empty() ? 1 : 0;
    merged += counts(edge) && IsMergedOfSessions(edge) ? 1 : 0;
  }
  if (pushed > 0) ShowValue(page, "PUSHED", "COUNT", Count(pushed, "edge", "edges"));
  if (merged > 0) page.ShowSection("EARLIER");
  if (sessions.empty() && pushed == 0 && merged == 0) page.ShowSection("NOTHING");
}

// Whole sentences as far as they fit; what is cut off is said.
std::string FirstSentences(const std::string& text, std::size_t bytes_max) {
  if (text.size() <= bytes_max) return text;
  std::size_t end = text.rfind(". ", bytes_max - 1);
  end = end == std::string::npos ? text.rfind(' ', bytes_max - 1) : end + 1;
  return (end == std::string::npos ? std::string() : text.substr(0, end)) + " [...] The report has the rest.";
}

void FillCertificateHead(Dictionary& page, const ReportInput& input) {
  const std::string robot = input.revision.robot.str();
  FillHead(page, robot + ", revision " + std::to_string(input.number) + ": calibration certificate", "");
  page.SetValue("ROBOT", robot);
  page.SetValue("NUMBER", std::to_string(input.number));
  page.SetValue("TIME", TimeText(input.created_at));
  page.SetValue("CALIBRATED", input.calibrated_at ? TimeText(*input.calibrated_at) : "not known");
  page.SetValue("REFERENCE", input.revision.reference.str());
  page.SetValue("SOFTWARE", input.software_version);
  page.SetValue("DIGEST", input.digest.str());
  Verdict verdict = input.revision.verdict;
  if (const std::vector<VerdictReason>& reasons = input.revision.basis.reasons; reasons.size() > 1) {
    verdict.why = reasons.front().why + " (" + Count(reasons.size() - 1, "more finding is", "more findings are") +
                  " in the report.)";
    verdict.what_to_do = reasons.front().what_to_do;
  }
  verdict.why = FirstSentences(verdict.why, kVerdictBytesMax);
  verdict.what_to_do = FirstSentences(verdict.what_to_do, kCureBytesMax);
  FillBanner(page, verdict, ValidityOf(input));
  page.SetValue("KIND", IsUsable(verdict) ? "Calibration certificate" : "Calibration record, no certificate");
  if (IsUsable(verdict)) page.ShowSection("TO_SIGN");
  AddScript(page, AssetPath("tables.js"));
}

}  // namespace

Result<std::string> RenderCertificate(const ReportInput& input) {
  Dictionary page("certificate");
  FillCertificateHead(page, input);
  FillCertifiedSensors(page, input);
  FillMeasuredWith(page, input);
  return Expand("certificate.tpl", page);
}

}  // namespace rigcal::report
