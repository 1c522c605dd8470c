// The registry of boards, which sessions used which, and what depends on one.
#include <gmock/gmock.h>

#include "server/formats/documents.h"
#include "storage/audit.h"
#include "storage/boards/measures.h"
#include "storage/boards/uses.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/standing.h"
#include "tests/unit/storage/fixture.h"
#include "tests/unit/storage/old_store.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

BoardMeasure MeasureOfBoard(const std::string& serial, double ruler_m, std::int64_t at_ns = 1'800'000'000'000'000'000) {
  BoardMeasure measure;
  measure.serial = serial;
  measure.pattern = {TargetKind::kCheckerboard, 9, 6, 0.025};
  measure.length_x_m = measure.length_y_m = 0.2;
  measure.measured_x_m = ruler_m, measure.measured_y_m = 0.2004;
  measure.sigma_m = 0.0002, measure.sigma_is_assumed = true;
  measure.flatness_m = 0.0004;
  measure.next_check_at = Stamp{at_ns + 1};
  measure.word = {{at_ns}, "Ada", "glued anew"};
  return measure;
}

class BoardsTest : public StoreTest {
 protected:
  // A closed session of the fixture's board, "B-7", with a good edge.
  SessionId Use(std::size_t payloads, const std::string& serial, const RobotId& robot = kRobot, bool with_edge = true) {
    Manifest manifest = MakeManifest(payloads, robot);
    manifest.header.targets.front().serial = serial;
    for (Payload& payload : manifest.payloads)
      payload.digest = DigestOf(robot.str() + serial + std::to_string(payloads) + payload.path);
    const SessionId id(DigestOf(robot.str() + serial + std::to_string(payloads)).str());
    std::vector<std::uint32_t> all(payloads);
    for (std::uint32_t i = 0; i < payloads; ++i) all[i] = i;
    EXPECT_TRUE(AppendSession(store_, id, formats::WriteManifest(manifest), manifest, {10}));
    EXPECT_TRUE(AppendHeld(store_, id, all, {11}));
    EXPECT_TRUE(CloseSession(store_, id, {}, {12}));
    if (!with_edge) return id;
    Edge edge = MakeEdge(++edges_, robot);
    edge.session = id;
    EXPECT_TRUE(AppendEdge(store_, edge, {13}));
    return id;
  }
  int Revise(const RobotId& robot = kRobot) {
    Revision revision = MakeRevision(LoadEdgeWatermark(store_, robot).value(), robot);
    revision.standing_watermark = LoadStandingWatermark(store_, robot).value();
    return AppendRevision(store_, revision).value();
  }
  int edges_ = 0;
};

TEST_F(BoardsTest, TheNewestMeasureHoldsAndAllAreKept) {
  const auto first = AppendBoardMeasure(store_, MeasureOfBoard("B-7", 0.2));
  ASSERT_TRUE(first) << WordsOf(first);
  ASSERT_TRUE(AppendBoardMeasure(store_, MeasureOfBoard("A-1", 0.2)));
  const auto second = AppendBoardMeasure(store_, MeasureOfBoard("B-7", 0.199));
  ASSERT_TRUE(second) << WordsOf(second);
  const BoardMeasure kept = LoadBoardMeasure(store_, "B-7").value().value();
  EXPECT_EQ(kept.number, second->number);
  EXPECT_EQ(kept.measured_x_m, 0.199);
  EXPECT_EQ(kept.measured_y_m, 0.2004);
  EXPECT_EQ(kept.pattern, MeasureOfBoard("B-7", 0.2).pattern);
  EXPECT_EQ(kept.flatness_m, 0.0004);
  EXPECT_TRUE(kept.sigma_is_assumed);
  EXPECT_EQ(kept.next_check_at, MeasureOfBoard("B-7", 0.2).next_check_at);
  EXPECT_EQ(kept.word, (Word{{1'800'000'000'000'000'000}, "Ada", "glued anew"}));
  EXPECT_EQ(LoadBoardHistory(store_, "B-7")->size(), 2u);
  const auto boards = LoadBoards(store_).value();
  ASSERT_EQ(boards.size(), 2u);
  EXPECT_EQ(boards[0].serial, "A-1");
  EXPECT_EQ(boards[1].measured_x_m, 0.199);
  EXPECT_EQ(LoadBoards(store_, "A-1")->size(), 1u);
  EXPECT_EQ(CountBoards(store_).value(), 2);
  EXPECT_FALSE(LoadBoardMeasure(store_, "b-7")->has_value());
}

TEST_F(BoardsTest, EachCheckIsAudited) {
  ASSERT_TRUE(AppendBoardMeasure(store_, MeasureOfBoard("B-7", 0.2)));
  const auto again = AppendBoardMeasure(store_, MeasureOfBoard("B-7", 0.2));
  ASSERT_TRUE(again) << WordsOf(again);
  EXPECT_EQ(again->number, 1) << "the same check, said twice";
  ASSERT_TRUE(AppendBoardMeasure(store_, MeasureOfBoard("B-7", 0.199)));
  const auto audit = LoadAudit(store_, {}).value();
  ASSERT_EQ(audit.size(), 2u);
  EXPECT_THAT(audit[0].what,
              HasSubstr("measured board B-7, a checkerboard of 9 x 6 inner corners, 25 mm: 24.875 x 25.050 mm"));
  EXPECT_THAT(audit[0].what, HasSubstr(", before 25.000 x 25.050 mm"));
  EXPECT_THAT(audit[0].what, HasSubstr(": glued anew"));
  EXPECT_FALSE(VerifyAudit(store_)->fault);
  BoardMeasure bad = MeasureOfBoard("B-7", 0.2);
  bad.sigma_m = 0;
  EXPECT_FALSE(AppendBoardMeasure(store_, bad));
  EXPECT_EQ(LoadAudit(store_, {})->size(), 2u);
}

TEST_F(BoardsTest, ClosedSessionsSayWhichBoardsTheyUsed) {
  const SessionId used = Use(2, "B-7"), none = Use(3, "");
  const auto boards = LoadSessionBoards(store_, {none, used}).value();
  ASSERT_EQ(boards.size(), 2u);
  EXPECT_EQ(boards[0].session, none);
  EXPECT_EQ(boards[0].serial, "");
  EXPECT_EQ(boards[1].serial, "B-7");
  EXPECT_EQ(boards[1].target, TargetId("board"));
  EXPECT_EQ(boards[1].pattern, (BoardPattern{TargetKind::kCheckerboard, 9, 6, 0.025}));
  EXPECT_EQ(boards[1].square_sigma_m, 0.0001);
  EXPECT_EQ(CountSessionsWith(store_, "B-7").value(), 1);
  EXPECT_EQ(CountSessionsWith(store_, "").value(), 0) << "no board is called so";
  Use(4, "A-2");
  EXPECT_THAT(LoadUnregistered(store_, "", 10).value(), ElementsAre("A-2", "B-7"));
  ASSERT_TRUE(AppendBoardMeasure(store_, MeasureOfBoard("A-2", 0.2)));
  EXPECT_THAT(LoadUnregistered(store_, "", 10).value(), ElementsAre("B-7"));
  EXPECT_EQ(LoadNewestUse(store_, "B-7")->value().session, used);
}

TEST_F(BoardsTest, SessionsWithEveryKindOfBoardClose) {
  for (const TargetKind kind : {TargetKind::kCheckerboard, TargetKind::kCharuco, TargetKind::kArucoGrid,
                                TargetKind::kAprilGrid, TargetKind::kCircleGrid, TargetKind::kAsymmetricCircleGrid}) {
    SCOPED_TRACE(NameOf(kind));
    Manifest manifest = MakeManifest(2, kRobot);
    Target& board = manifest.header.targets.front();
    board.kind = kind, board.serial = NameOf(kind), board.cols = 4, board.rows = 7;
    if (IsCircleGrid(kind)) board.diameter_m = board.square_m / 2;
    if (IsTagGrid(kind)) board.spacing_ratio = 0.3;
    if (MarkerCountOf(board) > 0) board.dictionary = "DICT_4X4_50", board.marker_m = board.square_m / 2;
    ASSERT_TRUE(Validate(board));
    for (Payload& payload : manifest.payloads) payload.digest = DigestOf(NameOf(kind) + payload.path);
    const SessionId id(DigestOf(NameOf(kind)).str());
    ASSERT_TRUE(AppendSession(store_, id, formats::WriteManifest(manifest), manifest, {10}));
    ASSERT_TRUE(AppendHeld(store_, id, std::vector<std::uint32_t>{0, 1}, {11}));
    const Status closed = CloseSession(store_, id, {}, {12});
    ASSERT_TRUE(closed) << Sentence(closed.error());
    const auto boards = LoadSessionBoards(store_, {id}).value();
    ASSERT_EQ(boards.size(), 1u);
    EXPECT_EQ(boards[0].pattern, PatternOf(board));
  }
}

TEST_F(BoardsTest, TracesSessionsRevisionsAndRobots) {
  Use(2, "other");
  Revise();
  const SessionId first = Use(3, "B-7");
  Revise();
  Use(4, "other");
  Revise();
  const SessionId second = Use(5, "B-7");
  const RobotId robot("zz");
  const SessionId without = Use(2, "B-7", robot, false);
  const BoardTrace trace = LoadBoardTrace(store_, "B-7").value();
  ASSERT_EQ(trace.robots.size(), 2u);
  EXPECT_EQ(trace.sessions(), 3u);
  EXPECT_EQ(trace.robots[0].robot, kRobot);
  EXPECT_THAT(trace.robots[0].revisions, ElementsAre(2, 3));
  ASSERT_EQ(trace.robots[0].sessions.size(), 2u);
  EXPECT_EQ(trace.robots[0].sessions[0].session, first);
  EXPECT_EQ(trace.robots[0].sessions[1].session, second);
  EXPECT_EQ(trace.robots[1].sessions[0].session, without);
  EXPECT_THAT(trace.robots[1].revisions, IsEmpty()) << "it gave nothing";
  EXPECT_TRUE(LoadBoardTrace(store_, "")->robots.empty());
}

TEST_F(BoardsTest, WhatWasRetiredIsCountedByTheRevisionsOfBefore) {
  const SessionId session = Use(3, "B-7");
  Revise();
  ASSERT_TRUE(RetireSession(store_, session, {{20}, "Ada", "bent"}));
  Revise();
  ASSERT_TRUE(MakeCurrent(store_, session, MadeCurrent::kRestored, {{21}, "Ada", ""}));
  Revise();
  ASSERT_TRUE(RetireSession(store_, session, {{22}, "Ada", "bent after all"}));
  const BoardTrace trace = LoadBoardTrace(store_, "B-7").value();
  EXPECT_THAT(trace.robots.at(0).revisions, ElementsAre(1, 3));
  EXPECT_FALSE(trace.robots[0].sessions[0].counts);
}

// Pushed again with another serial: the pictures are the same, the board is another one.
TEST_F(BoardsTest, WhatIsSupersededCountsNoMore) {
  const auto push = [&](const std::string& serial, const char* id_of) {
    Manifest manifest = MakeManifest(3);
    manifest.header.targets.front().serial = serial;
    const SessionId id(DigestOf(id_of).str());
    EXPECT_TRUE(AppendSession(store_, id, formats::WriteManifest(manifest), manifest, {10}));
    EXPECT_TRUE(AppendHeld(store_, id, {0, 1, 2}, {11}));
    EXPECT_TRUE(CloseSession(store_, id, {}, {12}));
    Edge edge = MakeEdge(++edges_);
    edge.session = id;
    EXPECT_TRUE(AppendEdge(store_, edge, {13}));
    Revise();
    return id;
  };
  push("B-7", "wrong");
  const SessionId right = push("B-8", "right");
  const BoardTrace wrong = LoadBoardTrace(store_, "B-7").value();
  EXPECT_THAT(wrong.robots.at(0).revisions, ElementsAre(1));
  EXPECT_FALSE(wrong.robots[0].sessions[0].counts);
  const BoardTrace trace = LoadBoardTrace(store_, "B-8").value();
  EXPECT_THAT(trace.robots.at(0).revisions, ElementsAre(2));
  EXPECT_EQ(trace.robots[0].sessions[0].session, right);
  EXPECT_TRUE(trace.robots[0].sessions[0].counts);
}

// Version 25: manifests said which boards were used, and nobody looked.
TEST(BoardsMigration, ClosedSessionsOfBeforeAreTraced) {
  const TempFolder folder;
  std::string sql = EmptyStoreOfVersion(25);
  Manifest manifest = MakeManifest(0);
  Target grid;
  grid.id = TargetId("grid"), grid.kind = TargetKind::kAprilGrid, grid.cols = 6, grid.rows = 5, grid.square_m = 0.088;
  grid.spacing_ratio = 0.3, grid.dictionary = "DICT_APRILTAG_36h11", grid.serial = "G-1";
  manifest.header.targets.push_back(grid);
  const auto insert = [&](int number) {
    return "INSERT INTO session VALUES (" + std::to_string(number) + ", '" + DigestOf(std::to_string(number)).str() +
           "', 'mapper-01', 5, 6, 'Ada', 0, 0, '" + formats::WriteManifest(manifest) + "');";
  };
  sql += "INSERT INTO robot VALUES ('mapper-01', 1);" + insert(1) + insert(2) +
         "INSERT INTO session_closed VALUES (1, 7);";
  MakeDatabase(folder.path(), sql);
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  const SessionId closed(DigestOf("1").str());
  const auto boards = LoadSessionBoards(*store, {closed, SessionId(DigestOf("2").str())}).value();
  ASSERT_EQ(boards.size(), 2u) << "of the closed one";
  EXPECT_EQ(boards[0].serial, "B-7");
  EXPECT_EQ(boards[1].serial, "G-1");
  EXPECT_EQ(boards[1].pattern, PatternOf(grid));
  EXPECT_EQ(LoadBoardTrace(*store, "G-1")->robots.at(0).sessions.at(0).session, closed);
}

// The table of measures was made anew for them.
TEST_F(BoardsTest, CirclesAreMeasuredLikeOtherBoardsAndNothingIsTakenBack) {
  ASSERT_TRUE(AppendBoardMeasure(store_, MeasureOfBoard("B-7", 0.1996)));
  for (const TargetKind kind : {TargetKind::kCircleGrid, TargetKind::kAsymmetricCircleGrid}) {
    BoardMeasure measure = MeasureOfBoard("C-" + NameOf(kind), 0.1996);
    measure.pattern = {kind, 4, 11, 0.02};
    ASSERT_TRUE(AppendBoardMeasure(store_, measure));
    EXPECT_EQ(LoadBoardMeasure(store_, measure.serial).value()->pattern, measure.pattern);
  }
  EXPECT_EQ(LoadBoardMeasure(store_, "B-7").value()->number, 1);
}

TEST(BoardsOfBefore, KeepWhatWasMeasuredOfThem) {
  const TempFolder folder;
  MakeDatabase(
      folder.path(),
      EmptyStoreBefore("0045_circle_grids.sql") +
          "INSERT INTO board_measure VALUES (7, 'B-7', 'charuco', 10, 7, 0.03, 0.3, 0.2, 0.2992, 0.1996, 0.0002, 1, "
          "NULL, NULL, 1800000000000000000, 'Ada', '');");
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  const auto known = LoadBoardMeasure(*store, "B-7").value();
  ASSERT_TRUE(known);
  EXPECT_EQ(known->number, 7);
  EXPECT_EQ(known->pattern, (BoardPattern{TargetKind::kCharuco, 10, 7, 0.03}));
  EXPECT_EQ(known->measured_y_m, 0.1996);
  EXPECT_EQ(known->word.who, "Ada");
}

}  // namespace
}  // namespace rigcal::storage
