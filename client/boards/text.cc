#include "client/boards/text.h"

#include <algorithm>
#include <map>
#include <set>

#include "client/text/pose_text.h"
#include "client/text/table.h"
#include "client/verb.h"
#include "server/model/boards/measure.h"

namespace rigcal::client {
namespace {

std::string CountedText(std::int64_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

// "charuco of 11 x 8 squares, 30 mm"
std::string BoardWhatText(const Document& board) {
  return Plain(board["type"].Text("?")) + " of " + CountOf(board["cols"]) + " x " + CountOf(board["rows"]) + " " +
         Plain(board["counts"].Text()) + ", " + BoardMm(board["square_m"].Number().value_or(0));
}

std::string BoardSizeText(const Document& board) {
  const Document size = board["size"];
  return Scaled(size["x_m"].Number(), kMmPerM, 3) + " x " + Scaled(size["y_m"].Number(), kMmPerM, 3);
}

std::string BoardSigmaText(const Document& board) {
  const auto x = board["size"]["sigma_x_m"].Number(), y = board["size"]["sigma_y_m"].Number();
  if (!x || !y) return "-";
  return Scaled(std::max(*x, *y), kMmPerM, 3) + (board["sigma_assumed"].Flag() ? " assumed" : "");
}

std::string FlatnessText(const Document& board) { return Scaled(board["flatness_m"].Number(), kMmPerM, 2); }

std::string NextCheckText(const Document& board) {
  return board["next_check"].Text("-") + (board["check_due"].Flag() ? " due" : "");
}

std::string DependsText(const Document& totals) {
  return CountedText(totals["sessions"].Integer().value_or(0), "session", "sessions") + ", " +
         CountedText(totals["revisions"].Integer().value_or(0), "revision", "revisions") + " and " +
         CountedText(totals["robots"].Integer().value_or(0), "robot", "robots");
}

// "1 to 4, 7": ascending numbers.
std::string RevisionRanges(const std::vector<Document>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    const std::int64_t first = numbers[i].Integer().value_or(0);
    std::size_t end = i + 1;
    while (end < numbers.size() && numbers[end].Integer().value_or(0) == first + static_cast<std::int64_t>(end - i))
      ++end;
    const std::int64_t last = first + static_cast<std::int64_t>(end - i) - 1;
    text += (text.empty() ? "" : ", ") + std::to_string(first) + (last > first ? " to " + std::to_string(last) : "");
    i = end;
  }
  return text.empty() ? "none" : text;
}

void PrintChecks(const Document& history, std::ostream& out) {
  Table table(
      {{"CHECKED"}, {"BY"}, {"SQUARE mm"}, {"SIGMA mm"}, {"FLAT mm", Align::kRight}, {"NEXT CHECK"}, {"REMARK"}});
  for (const Document& measure : history.Items())
    table.Add({DayOf(measure["measured_at"]), measure["who"].Text("?"), BoardSizeText(measure), BoardSigmaText(measure),
               FlatnessText(measure), measure["next_check"].Text("-"), measure["reason"].Text()});
  table.Print(out);
}

}  // namespace

void PrintBoardList(const Document& document, std::ostream& out) {
  Table table({{"SERIAL"},
               {"PATTERN"},
               {"SQUARE mm"},
               {"SIGMA mm"},
               {"FLAT mm", Align::kRight},
               {"CHECKED"},
               {"NEXT CHECK"},
               {"SESSIONS", Align::kRight}});
  for (const Document& board : document["boards"].Items())
    table.Add({board["serial"].Text("?"), BoardWhatText(board), BoardSizeText(board), BoardSigmaText(board),
               FlatnessText(board), DayOf(board["measured_at"]), NextCheckText(board), CountOf(board["sessions"])});
  if (table.empty())
    out << "No board is in the registry. `rigcal board print` draws one, `rigcal board measure` enters it.\n";
  else
    table.Print(out);
  const std::string next = document["next"].Text();
  if (!next.empty()) out << "More: rigcal board list --after " << TypedSerial(Plain(next)) << '\n';
  for (const Document& board : document["unregistered"].Items())
    out << "Not in the registry: " << Plain(board["serial"].Text("?")) << ", a " << BoardWhatText(board) << ", in "
        << CountedText(board["sessions"].Integer().value_or(0), "session", "sessions") << '\n';
}

void PrintBoard(const Document& document, std::ostream& out) {
  const Document board = document["board"];
  out << Plain(board["serial"].Text("?")) << ", a " << BoardWhatText(board) << ", in "
      << CountedText(board["sessions"].Integer().value_or(0), "session", "sessions") << '\n';
  if (board["check_due"].Flag())
    out << "Its check was due on " << Plain(board["next_check"].Text("?")) << ": `"
        << MeasureCommand(Plain(board["serial"].Text("?"))) << "`\n";
  PrintChecks(document["history"], out);
}

void PrintBoardTrace(const Document& document, std::ostream& out) {
  const Document totals = document["totals"];
  out << "On board " << Plain(document["serial"].Text("?")) << " depend " << DependsText(totals) << ".\n";
  if (document["robots"].size() == 0) return;
  out << "Listed is who names it: a session whose sensors did not see it is among them.\n";
  Table robots({{"ROBOT"}, {"SESSIONS", Align::kRight}, {"REVISIONS"}});
  Table sessions({{"ROBOT"}, {"SESSION"}, {"CAPTURED"}, {"COUNTS"}});
  for (const Document& robot : document["robots"].Items()) {
    const std::string name = robot["robot"].Text("?");
    robots.Add({name, CountOf(robot["sessions_total"]), RevisionRanges(robot["revisions"].Items())});
    for (const Document& session : robot["sessions"].Items())
      sessions.Add({name, session["session"].Text("?").substr(0, 16), session["captured_at"].Text("-"),
                    session["counts"].Flag() ? "yes" : "no"});
  }
  robots.Print(out);
  out << '\n';
  sessions.Print(out);
  if (document["more"].Flag()) out << "There are more sessions than are listed.\n";
}

void PrintBoardMeasured(const Document& document, std::ostream& out) {
  const Document board = document["board"], before = document["before"], depends = document["depends"];
  const std::string serial = Plain(board["serial"].Text("?"));
  out << "Board " << serial << ", a " << BoardWhatText(board) << ": its squares measure " << BoardSizeText(board)
      << " mm (sigma " << BoardSigmaText(board) << "), by " << Plain(board["who"].Text("?")) << ".\n";
  if (const std::string next = board["next_check"].Text(); !next.empty()) out << "Next check: " << Plain(next) << ".\n";
  const bool changed = document["size_changed"].Flag();
  if (changed) out << "Before, they measured " << BoardSizeText(before) << " mm.\n";
  if (depends["sessions"].Integer().value_or(0) == 0) return;
  out << DependsText(depends) << " depend on it" << (changed ? ", and stay as they are" : "")
      << ": `rigcal board trace " << TypedSerial(serial) << "` lists them"
      << (changed ? ", `rigcal resolve --board " + TypedSerial(serial) + "` computes them again.\n" : ".\n");
}

void PrintBoardRemarks(const Document& remarks, std::ostream& out) {
  std::map<std::string, std::set<std::string>> sessions;  // by what is said of them
  for (const Document& remark : remarks.Items()) sessions[remark["what"].Text()].insert(remark["session"].Text());
  std::set<std::string> told;
  for (const Document& remark : remarks.Items()) {
    const std::string what = remark["what"].Text();
    if (what.empty() || !told.insert(what).second) continue;
    const std::size_t count = sessions[what].size();
    out << (remark["level"].Text() == "warn" ? "Warning: " : "Note: ") << Plain(what)
        << (count > 1 ? " (" + std::to_string(count) + " sessions)" : "") << ". " << Plain(remark["cure"].Text())
        << '\n';
  }
}

}  // namespace rigcal::client
