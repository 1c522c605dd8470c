#include <algorithm>
#include <set>

#include "server/model/edges/merged_edge.h"
#include "server/model/edges/past.h"
#include "server/report/certificate/parts.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kToldSessionsMax = 4, kToldBoardsMax = 12;

bool Counts(const Edge& edge) { return edge.state == EdgeState::kGood && !IsPast(edge); }

// "site: hall 3, temperature: 21"
std::string ConditionsOf(const SessionFacts& session) {
  std::string text;
  for (const auto& [name, value] : session.conditions) text += (text.empty() ? "" : ", ") + name + ": " + value;
  return text.empty() ? "none told" : text;
}

std::string SessionText(const SessionFacts& session) {
  return "Session " + ShortDigest(session.id.str()) + ": captured " + TimeText(session.captured_at) +
         (session.operator_name.empty() ? ", operator not told" : " by " + session.operator_name) +
         "; conditions: " + ConditionsOf(session) + ".";
}

void AddSessions(const std::vector<const SessionFacts*>& sessions, std::vector<std::string>& text) {
  for (std::size_t i = 0; i < std::min(sessions.size(), kToldSessionsMax); ++i)
    text.push_back(SessionText(*sessions[i]));
  if (sessions.size() > kToldSessionsMax)
    text.push_back("And " +
                   Count(sessions.size() - kToldSessionsMax, "older session that counts", "older sessions that count") +
                   ".");
}

using BoardTexts = std::vector<std::string>;

bool IsAmong(const std::string& board, const BoardTexts& boards) {
  return std::find(boards.begin(), boards.end(), board) != boards.end();
}

// Each board of `list` once, but for those in `told`; those of the newest session first.
BoardTexts BoardsIn(const std::vector<const SessionFacts*>& sessions, BoardTexts SessionFacts::*list,
                    const BoardTexts& told = {}) {
  BoardTexts boards;
  for (const SessionFacts* session : sessions)
    for (const std::string& board : session->*list)
      if (!IsAmong(board, boards) && !IsAmong(board, told)) boards.push_back(board);
  return boards;
}

// With what is said of each. One that no sensor saw is no reference of this calibration.
void AddBoards(const std::vector<const SessionFacts*>& sessions, std::vector<std::string>& text) {
  BoardTexts boards = BoardsIn(sessions, &SessionFacts::boards);
  for (const std::string& board : BoardsIn(sessions, &SessionFacts::boards_perhaps_seen, boards))
    boards.push_back(board + " (it is not known whether a sensor saw it)");
  for (std::size_t i = 0; i < std::min(boards.size(), kToldBoardsMax); ++i) text.push_back("Board " + boards[i] + ".");
  if (boards.size() > kToldBoardsMax)
    text.push_back("And " + Count(boards.size() - kToldBoardsMax, "board more", "boards more") + ".");
  if (boards.empty() && !BoardsIn(sessions, &SessionFacts::boards_unseen).empty())
    text.push_back("No board: no sensor saw one.");
}

// What is of no session, or of sessions that are kept as their sum alone.
void AddOthers(const ReportInput& input, std::vector<std::string>& text) {
  std::size_t pushed = 0;
  bool merged = false;
  for (const Edge& edge : input.revision.edges) {
    if (!Counts(edge)) continue;
    pushed += edge.session.empty() ? 1 : 0;
    merged |= IsMergedOfSessions(edge);
  }
  if (merged) text.push_back("And what sessions before these said of each pair.");
  if (pushed > 0) text.push_back(Count(pushed, "edge was", "edges were") + " pushed as finished results.");
}

}  // namespace

std::vector<const SessionFacts*> SessionsThatCount(const ReportInput& input) {
  std::set<SessionId> ids;
  for (const Edge& edge : input.revision.edges)
    if (Counts(edge)) ids.insert(edge.session);
  std::vector<const SessionFacts*> sessions;
  for (const SessionFacts& facts : input.sessions)
    if (ids.contains(facts.id)) sessions.push_back(&facts);
  std::sort(sessions.begin(), sessions.end(), [](const SessionFacts* x, const SessionFacts* y) {
    return x->captured_at != y->captured_at ? x->captured_at > y->captured_at : x->id < y->id;
  });
  return sessions;
}

CertificatePart MeasuredWithPart(const ReportInput& input, const std::string& cause) {
  CertificatePart part{"Measured with"};
  const std::vector<const SessionFacts*> sessions = SessionsThatCount(input);
  AddSessions(sessions, part.text);
  AddOthers(input, part.text);
  if (part.text.empty()) part.text.push_back("Nothing that counts.");
  AddBoards(sessions, part.text);
  part.text.push_back("Software: rigcald " + input.software_version + (cause.empty() ? "" : "; " + cause) + ".");
  part.text.push_back("Document: revision.json, sha256 " + input.digest.str() + ".");
  return part;
}

}  // namespace rigcal::report
