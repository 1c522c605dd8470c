#include "server/fleet/boards/remarks.h"

#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "server/model/approval/validity.h"

namespace rigcal::fleet {
namespace {

constexpr double kSigmasApart = 3.0;

BoardRemark RemarkOn(const SessionBoard& board, const char* code, std::string what, std::string cure) {
  return {board.session, board.target, board.serial, code, false, std::move(what), std::move(cure)};
}

BoardRemark NoSerial(const SessionBoard& board) {
  return RemarkOn(board, "no_serial",
                  "board '" + board.target.str() +
                      "' has no serial: nobody can tell which board it was, or what was measured of it",
                  "Write `serial: ...` into its target in session.yaml, as it stands on the board.");
}

BoardRemark UnknownSerial(const SessionBoard& board) {
  return RemarkOn(board, "unknown_serial", "board " + board.serial + " is not in the registry: nobody measured it",
                  "Measure it: `" + MeasureCommand(board.serial, &board.pattern) + "`.");
}

BoardRemark CheckOverdue(const SessionBoard& board, Stamp due_at) {
  return RemarkOn(board, "check_overdue",
                  "board " + board.serial + " was due for a check on " + DayText(due_at) + ", before it was used on " +
                      DayText(board.captured_at),
                  "Measure it again: `" + MeasureCommand(board.serial) + "`.");
}

BoardRemark OtherPattern(const SessionBoard& board, const BoardMeasure& known) {
  BoardRemark remark =
      RemarkOn(board, "other_pattern",
               "board " + board.serial + " is a " + TextOf(known.pattern) + " in the registry, and a " +
                   TextOf(board.pattern) + " in the session",
               "Look at the board: mend serial or pattern in session.yaml and push the session again.");
  remark.is_warning = true;
  return remark;
}

struct SizeApart {
  const char* axis = "";
  double measured_m = 0, sigma_m = 0, in_sigmas = 0;
};

// Along the axis where it is most sigmas off; nothing where both agree.
std::optional<SizeApart> ApartFrom(const SessionBoard& board, const BoardMeasure& known) {
  const BoardSize size = SizeOf(known);
  std::optional<SizeApart> most;
  for (const auto& [axis, measured_m, sigma_m] :
       {std::tuple("x", size.x_m, size.sigma_x_m), std::tuple("y", size.y_m, size.sigma_y_m)}) {
    const double sigmas = std::abs(measured_m - board.pattern.square_m) / std::hypot(sigma_m, board.square_sigma_m);
    if (sigmas > kSigmasApart && (!most || sigmas > most->in_sigmas))
      most = SizeApart{axis, measured_m, sigma_m, sigmas};
  }
  return most;
}

BoardRemark OtherSize(const SessionBoard& board, const BoardMeasure& known, const SizeApart& apart) {
  const std::string side = IsTagGrid(board.pattern.kind)      ? "a tag"
                           : IsCircleGrid(board.pattern.kind) ? "the spacing"
                                                              : "a square";
  const std::string stated = board.square_sigma_m > 0 ? "sigma " + BoardMm(board.square_sigma_m) : "taken as exact";
  BoardRemark remark =
      RemarkOn(board, "other_size",
               side + " of board " + board.serial + " is " + BoardMm(board.pattern.square_m) + " in the session (" +
                   stated + "), and was measured to be " + BoardMm(apart.measured_m) + " along " + apart.axis + " by " +
                   known.word.who + " on " + DayText(known.word.at) + " (sigma " + BoardMm(apart.sigma_m) + ")",
               "Mend the size in session.yaml and push the session again; or measure the board again: `" +
                   MeasureCommand(board.serial) + "`.");
  remark.is_warning = true;
  return remark;
}

void AddRemarks(const SessionBoard& board, const BoardMeasure& known, std::vector<BoardRemark>& remarks) {
  if (IsCheckDue(known, board.captured_at)) remarks.push_back(CheckOverdue(board, *known.next_check_at));
  if (!IsSamePattern(board.pattern, known.pattern)) return remarks.push_back(OtherPattern(board, known));
  if (const auto apart = ApartFrom(board, known)) remarks.push_back(OtherSize(board, known, *apart));
}

}  // namespace

std::vector<BoardRemark> RemarksOn(const std::vector<SessionBoard>& boards, const BoardRegistry& registry) {
  std::vector<BoardRemark> remarks;
  for (const SessionBoard& board : boards) {
    const auto known = registry.find(board.serial);
    if (board.serial.empty())
      remarks.push_back(NoSerial(board));
    else if (known == registry.end())
      remarks.push_back(UnknownSerial(board));
    else
      AddRemarks(board, known->second, remarks);
  }
  return remarks;
}

}  // namespace rigcal::fleet
