#include <algorithm>
#include <map>

#include "server/model/edges/merged_edge.h"
#include "server/report/boards/board_remarks.h"
#include "server/report/edges/tables.h"
#include "server/report/text/text.h"

namespace rigcal::report {

namespace {

// All that the session lists; no sensor saw some of them.
void FillBoards(Dictionary& shown, const SessionFacts& facts) {
  if (facts.boards.empty() && facts.boards_perhaps_seen.empty() && facts.boards_unseen.empty()) return;
  Dictionary* boards = shown.AddSectionDictionary("BOARDS");
  const auto add = [&](const std::vector<std::string>& list, const std::string& note) {
    for (const std::string& board : list) ShowValue(*boards, "BOARD", "NAME", board + note);
  };
  add(facts.boards, "");
  add(facts.boards_perhaps_seen, " (it is not known whether a sensor saw it)");
  add(facts.boards_unseen, " (no sensor saw it)");
}

void FillFacts(Dictionary& row, const ReportInput& input, const SessionId& session) {
  for (const SessionFacts& facts : input.sessions) {
    if (facts.id != session) continue;
    Dictionary* shown = row.AddSectionDictionary("FACTS");
    shown->SetValue("CAPTURED", TimeText(facts.captured_at));
    shown->SetValue("FILES", Count(facts.files, "file", "files"));
    if (!facts.operator_name.empty()) ShowValue(*shown, "OPERATOR", "NAME", facts.operator_name);
    if (!facts.rig_model.empty()) ShowValue(*shown, "RIG", "NAME", facts.rig_model);
    FillBoardRemarks(*shown, facts.board_remarks);
    return FillBoards(*shown, facts);
  }
  row.ShowSection("NO_FACTS");
}

}  // namespace

void FillProvenance(Dictionary& page, const ReportInput& input) {
  constexpr std::size_t kSessionsMax = 100;
  std::map<SessionId, std::size_t> sessions;
  for (const Edge& edge : input.revision.edges)
    if (!IsMergedOfSessions(edge)) ++sessions[edge.session];
  page.SetValue("SOFTWARE", input.software_version);
  page.SetValue("DIGEST", input.digest.str());
  if (const auto pushed = sessions.find(SessionId()); pushed != sessions.end()) {
    ShowValue(page, "PUSHED", "COUNT", Count(pushed->second, "edge", "edges"));
    sessions.erase(pushed);
  }
  int earlier = 0;  // of the pair that most of them saw
  for (const Edge& edge : input.revision.edges)
    if (IsMergedOfSessions(edge)) earlier = std::max(earlier, static_cast<int>(edge.figures.at(kMergedSessions)));
  if (earlier > 0) ShowValue(page, "EARLIER", "COUNT", Count(static_cast<std::size_t>(earlier), "session", "sessions"));
  std::size_t shown = 0;
  for (const auto& [session, count] : sessions) {
    if (shown++ == kSessionsMax) break;
    Dictionary* row = page.AddSectionDictionary("SESSION");
    row->SetValue("ID", session.str());
    row->SetValue("EDGES", Count(count, "edge", "edges"));
    FillFacts(*row, input, session);
  }
  if (sessions.size() > kSessionsMax)
    ShowValue(page, "MORE_SESSIONS", "COUNT", std::to_string(sessions.size() - kSessionsMax));
}

}  // namespace rigcal::report
