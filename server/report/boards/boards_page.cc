#include "server/report/boards/boards_page.h"

#include <set>

#include "server/model/approval/validity.h"
#include "server/report/boards/board_remarks.h"
#include "server/report/frame/page.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

void FillNextCheck(Dictionary& row, const formats::BoardRow& board) {
  if (!board.measure.next_check_at) return row.ShowSection("NO_NEXT");
  Dictionary* next = row.AddSectionDictionary("NEXT");
  next->SetValue("DAY", DayText(*board.measure.next_check_at));
  if (board.check_due) ShowValue(*next, "DUE", "COMMAND", MeasureCommand(board.measure.serial));
}

std::string SessionsText(std::int64_t sessions) {
  return Count(static_cast<std::size_t>(sessions), "session", "sessions");
}

void FillBoard(Dictionary& row, const formats::BoardRow& board) {
  const BoardMeasure& measure = board.measure;
  row.SetValue("SERIAL", measure.serial);
  row.SetValue("PATTERN", TextOf(measure.pattern));
  row.SetValue("SIZE", TextOf(SizeOf(measure)));
  if (measure.sigma_is_assumed) row.ShowSection("ASSUMED");
  row.SetValue("FLATNESS", measure.flatness_m ? BoardMm(*measure.flatness_m) : "not measured");
  row.SetValue("CHECKED", DayText(measure.word.at));
  row.SetValue("WHO", measure.word.who);
  FillNextCheck(row, board);
  row.SetValue("SESSIONS", SessionsText(board.sessions));
}

void FillUnregistered(Dictionary& row, const formats::UnregisteredBoard& board) {
  row.SetValue("SERIAL", board.serial);
  row.SetValue("PATTERN", TextOf(board.pattern));
  row.SetValue("SESSIONS", SessionsText(board.sessions));
  row.SetValue("COMMAND", MeasureCommand(board.serial, &board.pattern));
}

}  // namespace

Result<std::string> RenderBoards(const formats::BoardsAnswer& answer) {
  Dictionary page("boards");
  FillHead(page, "Boards", "../");
  std::size_t due = 0;
  for (const formats::BoardRow& board : answer.boards) due += board.check_due ? 1 : 0;
  if (!answer.boards.empty()) {
    Dictionary* list = page.AddSectionDictionary("LIST");
    list->SetValue("COUNT", Count(answer.boards.size(), "board", "boards"));
    if (due > 0) ShowValue(*list, "DUE_COUNT", "COUNT", std::to_string(due));
    for (const formats::BoardRow& board : answer.boards) FillBoard(*list->AddSectionDictionary("BOARD"), board);
    if (!answer.next.empty()) list->ShowSection("CUT");
  }
  if (!answer.unregistered.empty()) {
    Dictionary* list = page.AddSectionDictionary("UNREGISTERED");
    for (const formats::UnregisteredBoard& board : answer.unregistered)
      FillUnregistered(*list->AddSectionDictionary("BOARD"), board);
  }
  if (answer.boards.empty() && answer.unregistered.empty()) page.ShowSection("EMPTY");
  return Expand("boards.tpl", page);
}

namespace {

// Boards without a serial are one line: the same is done about all.
BoardRemark WithoutSerials(const std::set<std::string>& boards) {
  std::string names;
  std::size_t left = boards.size();
  for (const std::string& board : boards) names += (names.empty() ? "" : left == 1 ? " and " : ", ") + board, --left;
  BoardRemark remark;
  remark.what = "boards " + names + " have no serial: nobody can tell which they were, or what was measured of them";
  remark.cure = "Write `serial: ...` into each target in session.yaml, as it stands on the board.";
  return remark;
}

std::vector<BoardRemark> Gathered(const std::vector<BoardRemark>& remarks) {
  std::set<std::string> without_serial;
  for (const BoardRemark& remark : remarks)
    if (remark.code == "no_serial") without_serial.insert(remark.target.str());
  if (without_serial.size() < 2) return remarks;
  std::vector<BoardRemark> gathered = remarks;
  std::erase_if(gathered, [](const BoardRemark& remark) { return remark.code == "no_serial"; });
  gathered.push_back(WithoutSerials(without_serial));
  return gathered;
}

}  // namespace

void FillBoardRemarks(Dictionary& parent, const std::vector<BoardRemark>& remarks) {
  std::set<std::string> told;
  for (const BoardRemark& remark : Gathered(remarks)) {
    if (!told.insert(remark.what).second) continue;
    Dictionary* row = parent.AddSectionDictionary("BOARD_REMARK");
    row->SetValue("LEVEL", remark.is_warning ? "warn" : "unknown");
    row->SetValue("WORD", remark.is_warning ? "warn" : "board");
    row->SetValue("WHY", remark.what);
    row->SetValue("CURE", remark.cure);
  }
}

std::string StandardText(const SessionBoard& board, const BoardRegistry& registry,
                         const std::vector<BoardRemark>& remarks) {
  std::string text;
  if (const auto known = registry.find(board.serial); known != registry.end())
    text += ", measured " + TextOf(SizeOf(known->second)) + " on " + DayText(known->second.word.at);
  for (const BoardRemark& remark : remarks) {
    if (remark.session != board.session || remark.target != board.target) continue;
    if (remark.code == "unknown_serial") text += ", not in the registry";
    if (remark.code == "check_overdue") text += ", check overdue";
    if (remark.is_warning) text += ", contradicts the registry";
  }
  return text;
}

}  // namespace rigcal::report
