// What is still to be done: jobs, batches, robots to solve, revisions to publish.
#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <random>

#include "storage/sessions/retired.h"
#include "storage/sessions/standing.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class WorkTest : public StoreTest {
 protected:
  BatchId batch_{DigestOf("a batch").str()};

  void AppendItem(std::int64_t item_idx, int seed, Stamp now) {
    ASSERT_TRUE(store_.Write([&]() -> Status {
      RIGCAL_TRY(AppendBatch(store_, kRobot, batch_, 3, now));
      return AppendBatchItems(store_, batch_, {{item_idx, MakeEdge(seed)}}, now);
    }));
  }
};

TEST_F(WorkTest, JobsComeOldestFirstAndRobotsDoNotWaitForEachOther) {
  const SessionId first = AppendClosedSession(store_, 1, {{kLeft, kRight}, {kLeft, kThird}});
  const SessionId second = AppendClosedSession(store_, 1, {{kRight, kThird}}, kOtherRobot);
  const JobRow job = LoadNextJob(store_, {}).value().value();
  EXPECT_EQ(job.robot, kRobot);
  EXPECT_EQ(job.session, first);
  EXPECT_EQ(job.pair, (SensorPair{kLeft, kRight}));
  const JobRow beside = LoadNextJob(store_, {kRobot}).value().value();
  EXPECT_EQ(beside.session, second);
  EXPECT_EQ(beside.pair, (SensorPair{kRight, kThird}));
  EXPECT_FALSE(LoadNextJob(store_, {kRobot, kOtherRobot}).value().has_value());
}

// Sessions of the fixture are closed at 12.
TEST_F(WorkTest, TheOldestJobThatWaitsIsKnownAndNoneThatWaitsOnceMore) {
  EXPECT_EQ(LoadOldestQueuedAt(store_).value(), std::nullopt);
  AppendClosedSession(store_, 1, {{kLeft, kRight}});
  EXPECT_EQ(LoadOldestQueuedAt(store_).value(), Stamp{12});
  const std::int64_t number = LoadNextJob(store_, {}).value()->number;
  ASSERT_TRUE(FinishJob(store_, number, {20}));
  EXPECT_EQ(LoadOldestQueuedAt(store_).value(), std::nullopt);
}

TEST_F(WorkTest, AFinishedJobIsNotFoundAgain) {
  const SessionId session = AppendClosedSession(store_, 1, {{kLeft, kRight}, {kLeft, kThird}});
  EXPECT_EQ(CountJobs(store_, kRobot).value(), 2);
  const JobRow job = LoadNextJob(store_, {}).value().value();
  ASSERT_TRUE(FinishJob(store_, job.number, {1}));
  ASSERT_TRUE(FinishJob(store_, job.number, {2}));
  EXPECT_EQ(CountJobs(store_, kRobot).value(), 1);
  EXPECT_EQ(CountJobs(store_, session).value().waiting, 1);
  EXPECT_EQ(CountJobs(store_, session).value().total, 2);
  EXPECT_EQ(LoadNextJob(store_, {}).value()->pair, (SensorPair{kLeft, kThird}));
  // After a restart as well.
  Store reopened = Open();
  EXPECT_EQ(LoadNextJob(reopened, {}).value()->pair, (SensorPair{kLeft, kThird}));
  EXPECT_EQ(FinishJob(store_, 4711, {1}).error().code, ErrorCode::kNotFound);
}

TEST_F(WorkTest, ABatchIsOpenUntilItsLastItem) {
  const auto open = [&] { return LoadOpenBatches(store_, kRobot).value(); };
  EXPECT_EQ(LoadBatchHeld(store_, batch_).value(), std::nullopt);
  EXPECT_THAT(open(), IsEmpty());
  ASSERT_TRUE(AppendBatch(store_, kRobot, batch_, 3, {5}));
  ASSERT_EQ(open().size(), 1u);
  EXPECT_EQ(open()[0].newest_at, Stamp{5});
  AppendItem(2, 2, {20});
  EXPECT_THAT(LoadBatchHeld(store_, batch_).value().value(), ElementsAre(false, false, true));
  EXPECT_EQ(open()[0].id, batch_);
  EXPECT_EQ(open()[0].robot, kRobot);
  EXPECT_EQ(open()[0].items, 3);
  EXPECT_EQ(open()[0].held, 1);
  EXPECT_EQ(open()[0].opened_at, Stamp{5});
  EXPECT_EQ(open()[0].newest_at, Stamp{20});
  EXPECT_THAT(LoadOpenBatches(store_, kOtherRobot).value(), IsEmpty());
  AppendItem(0, 0, {30});
  AppendItem(0, 0, {31});  // the same again
  EXPECT_EQ(open()[0].held, 2);
  EXPECT_EQ(open()[0].newest_at, Stamp{31});
  AppendItem(1, 1, {40});
  EXPECT_THAT(LoadBatchHeld(store_, batch_).value().value(), ElementsAre(true, true, true));
  EXPECT_THAT(open(), IsEmpty());
  AppendItem(1, 1, {50});
  EXPECT_THAT(open(), IsEmpty());
}

TEST_F(WorkTest, OpenBatchesAreListedTheOldestFirst) {
  const BatchId other(DigestOf("another batch").str());
  ASSERT_TRUE(AppendBatch(store_, kRobot, batch_, 3, {50}));
  ASSERT_TRUE(AppendBatch(store_, kOtherRobot, other, 2, {20}));
  ASSERT_EQ(LoadOpenBatches(store_, RobotId()).value().size(), 2u);
  EXPECT_EQ(LoadOpenBatches(store_, RobotId()).value()[0].id, batch_);
  EXPECT_EQ(LoadOpenBatches(store_, kOtherRobot).value().front().id, other);
  for (int i = 0; i < 3; ++i) AppendItem(i, i, {60});
  EXPECT_EQ(LoadOpenBatches(store_, RobotId()).value().front().id, other);
}

TEST_F(WorkTest, AnEmptyBatchIsComplete) {
  ASSERT_TRUE(AppendBatch(store_, kRobot, batch_, 0, {1}));
  EXPECT_THAT(LoadOpenBatches(store_, kRobot).value(), IsEmpty());
  EXPECT_THAT(LoadBatchHeld(store_, batch_).value().value(), IsEmpty());
}

TEST_F(WorkTest, NoEdgeOfABatchCountsBeforeAllAreThere) {
  const auto counted = [&] { return LoadEdges(store_, kRobot, false).value().size(); };
  AppendItem(0, 0, {1});
  AppendItem(2, 2, {2});
  EXPECT_EQ(counted(), 0u);
  EXPECT_FALSE(LoadEdge(store_, MakeEdge(0).id).value());
  EXPECT_EQ(LoadEdgeWatermark(store_, kRobot).value(), 0);
  EXPECT_EQ(LoadRobot(store_, kRobot).value()->edges, 0);
  EXPECT_THAT(LoadUnsolvedRobots(store_).value(), IsEmpty());
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(7), {3}));  // another's edge counts at once, and theirs do not with it
  EXPECT_EQ(counted(), 1u);
  ASSERT_TRUE(AppendRevision(store_, MakeRevision(LoadEdgeWatermark(store_, kRobot).value())));
  EXPECT_THAT(LoadUnsolvedRobots(store_).value(), IsEmpty());
  AppendItem(1, 1, {4});
  EXPECT_EQ(counted(), 4u);
  EXPECT_EQ(LoadRobot(store_, kRobot).value()->edges, 4);
  EXPECT_THAT(LoadUnsolvedRobots(store_).value(), ElementsAre(kRobot));
}

// The batch is completed by an edge that counted before: the others are new to the graph all the same.
TEST_F(WorkTest, ABatchCompletedByAKnownEdgeAsksForARevision) {
  AppendItem(0, 0, {1});
  AppendItem(1, 1, {1});
  const BatchId other(DigestOf("another batch").str());
  ASSERT_TRUE(AppendBatch(store_, kRobot, other, 1, {2}));
  ASSERT_TRUE(AppendBatchItems(store_, other, {{0, MakeEdge(2)}}, {2}));
  const std::int64_t before = LoadEdgeWatermark(store_, kRobot).value();
  ASSERT_TRUE(AppendRevision(store_, MakeRevision(before)));
  EXPECT_EQ(LoadEdges(store_, kRobot, false).value().size(), 1u);
  AppendItem(2, 2, {3});
  EXPECT_EQ(LoadEdges(store_, kRobot, false).value().size(), 3u);
  EXPECT_GT(LoadEdgeWatermark(store_, kRobot).value(), before);
  EXPECT_THAT(LoadUnsolvedRobots(store_).value(), ElementsAre(kRobot));
}

// What a client sends again may lie beside what is new, and twice in one group.
TEST_F(WorkTest, ItemsThatComeTwiceCountOnce) {
  ASSERT_TRUE(AppendBatch(store_, kRobot, batch_, 3, {1}));
  const Edge first = MakeEdge(0), second = MakeEdge(1), third = MakeEdge(2);
  ASSERT_TRUE(AppendBatchItems(store_, batch_, {{1, second}, {1, second}}, {1}));
  ASSERT_TRUE(AppendBatchItems(store_, batch_, {{1, second}, {0, first}}, {2}));
  EXPECT_THAT(LoadEdges(store_, kRobot, false).value(), IsEmpty());
  const Status twice = AppendBatchItems(store_, batch_, {{2, third}, {2, first}}, {3});
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().code, ErrorCode::kConflict);
  EXPECT_EQ(LoadBatchHeld(store_, batch_).value(), (std::vector<bool>{true, true, false}));
  ASSERT_TRUE(AppendBatchItems(store_, batch_, {{2, third}, {0, first}}, {3}));
  EXPECT_EQ(LoadEdges(store_, kRobot, false).value().size(), 3u);
}

TEST_F(WorkTest, WhatDoesNotFitABatchIsRefused) {
  const auto append = [&](std::int64_t idx, const Edge& edge) {
    return AppendBatchItems(store_, batch_, {{idx, edge}}, {1});
  };
  EXPECT_EQ(append(0, MakeEdge(1)).error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(AppendBatch(store_, kRobot, batch_, 3, {1}));
  EXPECT_EQ(AppendBatch(store_, kRobot, batch_, 4, {1}).error().code, ErrorCode::kConflict);
  EXPECT_EQ(append(3, MakeEdge(1)).error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(append(-1, MakeEdge(1)).error().code, ErrorCode::kInvalidInput);
  Edge bad = MakeEdge(9);
  bad.T_a_b.p_m.x() = std::nan("");
  EXPECT_EQ(append(0, bad).error().code, ErrorCode::kInvalidInput);
  ASSERT_TRUE(append(0, MakeEdge(1)));
  const Status other = append(0, MakeEdge(2));
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::kConflict);
  EXPECT_THAT(other.error().what, HasSubstr("another edge as item 0"));
}

TEST_F(WorkTest, ARobotIsUnsolvedWhileItsNewestEdgeIsInNoRevision) {
  const auto unsolved = [&] { return LoadUnsolvedRobots(store_).value(); };
  ASSERT_TRUE(AppendRobot(store_, RobotId("quiet"), {1}));
  EXPECT_THAT(unsolved(), IsEmpty());
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {1}));
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1, kOtherRobot), {1}));
  EXPECT_THAT(unsolved(), ElementsAre(kRobot, kOtherRobot));
  ASSERT_TRUE(AppendRevision(store_, MakeRevision(LoadEdgeWatermark(store_, kRobot).value())));
  EXPECT_THAT(unsolved(), ElementsAre(kOtherRobot));
  EXPECT_TRUE(IsUnsolved(store_, kOtherRobot).value());
  EXPECT_FALSE(IsUnsolved(store_, kRobot).value());
  ASSERT_TRUE(AppendEdge(store_, MakeFailedEdge(1), {1}));
  EXPECT_THAT(unsolved(), ElementsAre(kOtherRobot, kRobot));
}

// Whoever brings edges without a pause keeps its place, and takes the last one when it was revised: names tell nothing.
TEST_F(WorkTest, RobotsAreRevisedInTheOrderInWhichTheyBeganToWait) {
  const RobotId third("mapper-03");
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1, kOtherRobot), {1}));
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {1}));
  const std::int64_t solved = LoadEdgeWatermark(store_, kRobot).value();
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1, third), {1}));
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(2), {1}));  // while its revision is made
  EXPECT_THAT(LoadUnsolvedRobots(store_).value(), ElementsAre(kOtherRobot, kRobot, third));
  ASSERT_TRUE(AppendRevision(store_, MakeRevision(solved)));
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(2, kOtherRobot), {1}));
  EXPECT_THAT(LoadUnsolvedRobots(store_).value(), ElementsAre(kOtherRobot, third, kRobot));
}

// The queue of robots to solve is kept by triggers and by AppendRevision; it must always say what IsUnsolved works out.
TEST_F(WorkTest, ARobotIsUnsolvedSinceItsFirstEdgeThatIsInNoRevision) {
  EXPECT_FALSE(LoadUnsolvedSince(store_, kRobot).value());
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {5}));
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(2), {7}));
  EXPECT_EQ(LoadUnsolvedSince(store_, kRobot).value()->ns, 5);
  ASSERT_TRUE(AppendRevision(store_, MakeRevision(LoadEdgeWatermark(store_, kRobot).value())));
  EXPECT_FALSE(LoadUnsolvedSince(store_, kRobot).value());
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(3), {9}));
  EXPECT_EQ(LoadUnsolvedSince(store_, kRobot).value()->ns, 9);
}

TEST_F(WorkTest, TheQueueOfRobotsIsWhatTheWatermarksSay) {
  std::mt19937 random(11);
  const auto draw = [&](int count) { return std::uniform_int_distribution<int>(0, count - 1)(random); };
  std::map<RobotId, std::vector<EdgeId>> edges;
  int number = 0, unsolved_seen = 0, solved_seen = 0;
  for (int step = 0; step < 200; ++step) {
    const RobotId robot = draw(2) == 0 ? kRobot : kOtherRobot;
    const int what = draw(4);
    if (what < 2) {
      const Edge edge = MakeEdge(++number, robot);
      ASSERT_TRUE(AppendEdge(store_, edge, {step}));
      edges[robot].push_back(edge.id);
    } else if (what == 2 && !edges[robot].empty()) {
      ASSERT_TRUE(RetireEdge(store_, edges[robot].back(), {{step}, "Ada", "typed wrong"}));
      edges[robot].pop_back();
    } else {
      Revision revision =
          MakeRevision(LoadEdgeWatermark(store_, robot).value() - draw(2), robot);  // one may have come meanwhile
      revision.standing_watermark = LoadStandingWatermark(store_, robot).value();
      ASSERT_TRUE(AppendRevision(store_, revision));
    }
    const std::vector<RobotId> queue = LoadUnsolvedRobots(store_).value();
    for (const RobotId& one : {kRobot, kOtherRobot}) {
      const bool is_queued = std::find(queue.begin(), queue.end(), one) != queue.end();
      EXPECT_EQ(is_queued, IsUnsolved(store_, one).value()) << one.str() << " after step " << step;
      ++(is_queued ? unsolved_seen : solved_seen);
    }
  }
  EXPECT_GT(std::min(unsolved_seen, solved_seen), 50);
}

TEST_F(WorkTest, RevisionsAreNumberedPerRobot) {
  EXPECT_EQ(AppendRevision(store_, MakeRevision(10)).value(), 1);
  EXPECT_EQ(AppendRevision(store_, MakeRevision(20)).value(), 2);
  EXPECT_EQ(AppendRevision(store_, MakeRevision(30, kOtherRobot)).value(), 1);
  const Revision newest = LoadRevision(store_, kRobot, 0).value().value();
  const Revision given = MakeRevision(20);
  EXPECT_EQ(newest.robot, kRobot);
  EXPECT_EQ(newest.number, 2);
  EXPECT_EQ(newest.created_at.ns, 77);
  EXPECT_EQ(newest.verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(newest.verdict.why, given.verdict.why);
  EXPECT_EQ(newest.verdict.what_to_do, given.verdict.what_to_do);
  EXPECT_EQ(newest.document, given.document);
  EXPECT_EQ(newest.digest, given.digest);
  EXPECT_EQ(newest.edge_watermark, 20);
  EXPECT_EQ(LoadRevision(store_, kRobot, 1).value()->edge_watermark, 10);
  EXPECT_FALSE(LoadRevision(store_, kRobot, 3).value().has_value());
  EXPECT_FALSE(LoadRevision(store_, RobotId("nobody"), 0).value().has_value());
  const std::vector<Revision> list = LoadRevisions(store_, kRobot).value();
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].number, 2);
  EXPECT_EQ(list[1].number, 1);
  EXPECT_TRUE(list[0].document.empty());
}

TEST_F(WorkTest, ARevisionThatCountsNothingHasNoTimeOfMeasurement) {
  Revision revision = MakeRevision(1);
  revision.calibrated_at = Stamp{1000};
  ASSERT_TRUE(AppendRevision(store_, revision));
  EXPECT_EQ(LoadRevision(store_, kRobot, 1).value()->calibrated_at, Stamp{1000});
  ASSERT_TRUE(AppendRevision(store_, MakeRevision(1, kOtherRobot)));
  EXPECT_EQ(LoadRevision(store_, kOtherRobot, 1).value()->calibrated_at, std::nullopt);
}

TEST_F(WorkTest, ALargeDocumentComesBack) {
  Revision revision = MakeRevision(1);
  revision.document.assign(12u << 20, 'd');
  revision.document.back() = 'e';
  ASSERT_TRUE(AppendRevision(store_, revision));
  EXPECT_TRUE(LoadRevision(store_, kRobot, 1).value()->document == revision.document);
}

TEST_F(WorkTest, ARevisionIsUnpublishedUntilItIsMarked) {
  ASSERT_TRUE(AppendRevision(store_, MakeRevision(1)));
  ASSERT_TRUE(AppendRevision(store_, MakeRevision(2)));
  ASSERT_EQ(LoadUnpublished(store_).value().size(), 2u);
  ASSERT_TRUE(AppendPublication(store_, {kRobot, 1}, {1}));
  ASSERT_TRUE(AppendPublication(store_, {kRobot, 1}, {2}));
  const std::vector<RevisionKey> keys = LoadUnpublished(store_).value();
  ASSERT_EQ(keys.size(), 1u);
  EXPECT_EQ(keys[0].number, 2);
  EXPECT_EQ(AppendPublication(store_, {kRobot, 9}, {1}).error().code, ErrorCode::kConflict);
}

TEST_F(WorkTest, AViewComesBackForItsDetectorOnly) {
  StoredView stored;
  stored.view.found = true;
  stored.view.target = TargetId("board");
  stored.view.image_width_px = 640;
  stored.view.image_height_px = 480;
  stored.view.corners_px = {{1.0 / 3.0, 2.5}, {-0.25, 4.0}};
  stored.picture = DigestOf("picture");
  ASSERT_TRUE(AppendView(store_, DigestOf("image"), "chessboard 1", stored));
  ASSERT_TRUE(AppendView(store_, DigestOf("image"), "chessboard 1", {}));
  const StoredView loaded = LoadView(store_, DigestOf("image"), "chessboard 1").value().value();
  EXPECT_TRUE(loaded.view.found);
  EXPECT_EQ(loaded.view.target, TargetId("board"));
  EXPECT_EQ(loaded.view.image_width_px, 640);
  EXPECT_EQ(loaded.view.image_height_px, 480);
  EXPECT_EQ(loaded.view.corners_px, stored.view.corners_px);
  EXPECT_EQ(loaded.picture, stored.picture);
  EXPECT_FALSE(LoadView(store_, DigestOf("image"), "chessboard 2").value().has_value());
  EXPECT_FALSE(LoadView(store_, DigestOf("other"), "chessboard 1").value().has_value());
  EXPECT_EQ(WasFound(store_, DigestOf("image"), "chessboard 1", TargetId("other")).value(), true);
  EXPECT_EQ(WasFound(store_, DigestOf("image"), "chessboard 2", TargetId("board")).value(), true);
  EXPECT_EQ(WasFound(store_, DigestOf("image"), "chessboard 2", TargetId("other")).value(), std::nullopt);
}

TEST_F(WorkTest, AViewWithoutABoardSaysWhy) {
  StoredView stored;
  stored.view.why_not = "the picture is blurred";
  ASSERT_TRUE(AppendView(store_, DigestOf("image"), "chessboard 1", stored));
  const StoredView loaded = LoadView(store_, DigestOf("image"), "chessboard 1").value().value();
  EXPECT_FALSE(loaded.view.found);
  EXPECT_EQ(loaded.view.why_not, "the picture is blurred");
  EXPECT_TRUE(loaded.view.corners_px.empty());
  EXPECT_TRUE(loaded.picture.empty());
}

}  // namespace
}  // namespace rigcal::storage
