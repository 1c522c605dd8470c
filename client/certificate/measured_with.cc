#include <algorithm>
#include <vector>

#include "client/certificate/lines.h"
#include "client/text/table.h"

namespace rigcal::client {
namespace {

constexpr std::size_t kSessionsMax = 4, kBoardsMax = 5;

// "site: hall 3, temperature_deg_c: 21"
std::string ConditionsOf(const Document& manifest) {
  const Document conditions = manifest["conditions"];
  std::string text;
  for (const std::string& name : conditions.Keys())
    text += (text.empty() ? "" : ", ") + name + ": " + conditions[name].Text();
  return text;
}

std::string SessionText(const Document& session) {
  const Document manifest = session["manifest"];
  const std::string who = manifest["operator"].Text(), conditions = ConditionsOf(manifest);
  return "Session " + session["session"]["session"].Text().substr(0, 16) + ", captured " +
         manifest["captured_at"].Text("-") + (who.empty() ? "" : " by " + who) +
         (conditions.empty() ? "; conditions: none told" : "; " + conditions);
}

std::string BoardOf(const Document& target) {
  const Document counts = target[target.Has("tags") ? "tags" : "inner_corners"];
  const std::string serial = target["serial"].Text();
  return target["id"].Text("?") + ": " + target["type"].Text("?") + " " + Fixed(counts[0].Number(), 0) + " x " +
         Fixed(counts[1].Number(), 0) + ", " + Scaled(target["square_size_m"].Number(), 1e3, 2) + " mm, " +
         (serial.empty() ? "no serial" : "serial " + serial);
}

// What the registry says against it, by code.
std::string RemarksOf(const Document& session, const Document& target) {
  std::string text;
  for (const Document& remark : session["board_remarks"].Items())
    if (remark["target"].Text() == target["id"].Text() && remark["code"].Text() != "no_serial")
      text += " (" + remark["what"].Text() + ")";
  return text;
}

std::vector<std::string> BoardsOf(const std::vector<Document>& sessions) {
  std::vector<std::string> boards;
  for (const Document& session : sessions)
    for (const Document& target : session["manifest"]["targets"].Items()) {
      std::string board = BoardOf(target) + RemarksOf(session, target);
      if (std::find(boards.begin(), boards.end(), board) == boards.end()) boards.push_back(std::move(board));
    }
  return boards;
}

}  // namespace

void AddMeasuredWith(const CertificateDocuments& documents, std::vector<CertificateLine>& lines) {
  lines.push_back({"Measured with", LineStyle::kHeading});
  const std::vector<Document>& sessions = documents.sessions;
  if (sessions.empty()) AddText("No session counts: poses are of finished results that were pushed.", 1, lines);
  for (std::size_t i = 0; i < std::min(sessions.size(), kSessionsMax); ++i) AddText(SessionText(sessions[i]), 2, lines);
  if (sessions.size() > kSessionsMax)
    AddText("Older sessions that count, too: " + std::to_string(sessions.size() - kSessionsMax) + ".", 1, lines);
  const std::vector<std::string> boards = BoardsOf(sessions);
  for (std::size_t i = 0; i < std::min(boards.size(), kBoardsMax); ++i) AddText("Board " + boards[i], 2, lines);
  if (boards.size() > kBoardsMax) AddText("More boards: " + std::to_string(boards.size() - kBoardsMax) + ".", 1, lines);
}

}  // namespace rigcal::client
