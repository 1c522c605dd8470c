// Which boards of sessions are marked, and what is a warning.
#include <gmock/gmock.h>

#include "server/fleet/boards/remarks.h"

namespace rigcal::fleet {
namespace {

using testing::HasSubstr;

BoardMeasure Known() {
  BoardMeasure measure;
  measure.serial = "B-7";
  measure.pattern = {TargetKind::kCheckerboard, 9, 6, 0.025};
  measure.length_x_m = measure.length_y_m = 0.2;
  measure.measured_x_m = measure.measured_y_m = 0.2;
  measure.sigma_m = 0.0002;
  measure.next_check_at = ParseIso("2027-05-31").value();
  measure.word = {ParseIso("2026-05-31").value(), "Ada", ""};
  return measure;
}

SessionBoard Used() {
  return {SessionId(std::string(64, 'a')),
          ParseIso("2026-11-03T12:00:00Z").value(),
          TargetId("board"),
          "B-7",
          Known().pattern,
          0.0};
}

std::vector<BoardRemark> Remarks(const SessionBoard& board, const BoardMeasure& known = Known()) {
  return RemarksOn({board}, {{known.serial, known}});
}

TEST(BoardRemarks, OneThatIsMeasuredAndAgreesIsNotSpokenOf) { EXPECT_TRUE(Remarks(Used()).empty()); }

TEST(BoardRemarks, MarksWhatNobodyCanTellAndWhatNobodyMeasured) {
  SessionBoard board = Used();
  board.serial = "";
  ASSERT_EQ(Remarks(board).size(), 1u);
  EXPECT_EQ(Remarks(board)[0].code, "no_serial");
  EXPECT_FALSE(Remarks(board)[0].is_warning);
  board.serial = "B-8";
  ASSERT_EQ(Remarks(board).size(), 1u);
  EXPECT_EQ(Remarks(board)[0].code, "unknown_serial");
  EXPECT_THAT(Remarks(board)[0].cure,
              HasSubstr("rigcal board measure B-8 --type checkerboard --cols 9 --rows 6 --square-mm 25 "));
}

TEST(BoardRemarks, MarksAnOverdueCheckOfTheDayOfTheSession) {
  SessionBoard board = Used();
  board.captured_at = ParseIso("2027-06-01").value();
  ASSERT_EQ(Remarks(board).size(), 1u);
  EXPECT_EQ(Remarks(board)[0].code, "check_overdue");
  EXPECT_THAT(Remarks(board)[0].what, HasSubstr("due for a check on 31 May 2027, before it was used on 1 Jun 2027"));
}

// Sigma of the measure: 25 um. The rest is stated.
TEST(BoardRemarks, WarnsOfASizeThatTheSigmasDoNotAllowAndNamesBoth) {
  SessionBoard board = Used();
  board.pattern.square_m = 0.02507;
  EXPECT_TRUE(Remarks(board).empty()) << "2.8 sigmas";
  board.pattern.square_m = 0.02508;
  ASSERT_EQ(Remarks(board).size(), 1u) << "3.2 sigmas";
  EXPECT_EQ(Remarks(board)[0].code, "other_size");
  EXPECT_TRUE(Remarks(board)[0].is_warning);
  EXPECT_EQ(Remarks(board)[0].what,
            "a square of board B-7 is 25.08 mm in the session (taken as exact), and was measured to be 25 mm along x "
            "by Ada on 31 May "
            "2026 (sigma 0.025 mm)");
  board.square_sigma_m = 0.00003;
  EXPECT_TRUE(Remarks(board).empty()) << "2 sigmas of both";
  BoardMeasure stretched = Known();
  stretched.measured_y_m = 0.201;
  board = Used();
  ASSERT_EQ(Remarks(board, stretched).size(), 1u);
  EXPECT_THAT(Remarks(board, stretched)[0].what, HasSubstr("25.125 mm along y"));
}

TEST(BoardRemarks, WarnsOfAnotherPatternUnderItsSerialAndSaysNothingOfItsSize) {
  SessionBoard board = Used();
  board.pattern = {TargetKind::kCharuco, 10, 7, 0.04};
  ASSERT_EQ(Remarks(board).size(), 1u);
  EXPECT_EQ(Remarks(board)[0].code, "other_pattern");
  EXPECT_THAT(Remarks(board)[0].what, HasSubstr("checkerboard of 9 x 6 inner corners, 25 mm in the registry, and a "
                                                "charuco of 11 x 8 squares, 40 mm in the session"));
}

}  // namespace
}  // namespace rigcal::fleet
