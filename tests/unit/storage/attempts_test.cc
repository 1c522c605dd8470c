// How often work was begun: what is counted, what is not, and in which order jobs come then.
#include "storage/work/attempts.h"

#include <gmock/gmock.h>

#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

class AttemptsTest : public StoreTest {
 protected:
  const std::string work_ = WorkOfJob(1);
  [[nodiscard]] int Counted() { return LoadAttemptCounts(store_).value()[work_]; }
  [[nodiscard]] JobRow Next() { return LoadNextJob(store_, {}).value().value(); }
};

TEST_F(AttemptsTest, WhatIsCutOffCountsAcrossARestart) {
  ASSERT_TRUE(BeginAttempt(store_, work_, {1}));
  EXPECT_EQ(Counted(), 1);
  Store reopened = Open();  // as after kill -9: nothing ended it
  EXPECT_THAT(EndOpenAttempts(reopened, AttemptEnd::kCutOff, {2}).value(), ElementsAre(work_));
  EXPECT_THAT(EndOpenAttempts(reopened, AttemptEnd::kCutOff, {2}).value(), IsEmpty());
  EXPECT_EQ(LoadAttemptCounts(reopened).value()[work_], 1);
  ASSERT_TRUE(BeginAttempt(reopened, work_, {3}));
  ASSERT_TRUE(BeginAttempt(reopened, work_, {4}));  // the one before was never ended: it was cut off too
  const Attempts attempts = LoadAttempts(reopened, work_).value();
  EXPECT_EQ(attempts.cut_off, 3);
  EXPECT_EQ(attempts.failed, 0);
}

TEST_F(AttemptsTest, WhatIsGivenBackDoesNotCount) {
  ASSERT_TRUE(BeginAttempt(store_, work_, {1}));
  ASSERT_TRUE(EndAttempt(store_, work_, AttemptEnd::kFailed, "no memory", {2}));
  ASSERT_TRUE(BeginAttempt(store_, work_, {3}));
  EXPECT_THAT(EndOpenAttempts(store_, AttemptEnd::kGivenBack, {4}).value(), ElementsAre(work_));
  ASSERT_TRUE(EndAttempt(store_, work_, AttemptEnd::kFailed, "it was on its way out", {5}));  // too late
  EXPECT_EQ(Counted(), 1);
  const Attempts attempts = LoadAttempts(store_, work_).value();
  EXPECT_EQ(attempts.failed, 1);
  EXPECT_EQ(attempts.cut_off, 0);
  EXPECT_EQ(attempts.newest_why, "no memory");
}

TEST_F(AttemptsTest, WhatIsKilledFromOutsideCountsFromTheTenthOn) {
  for (int i = 1; i < kKillsMax; ++i) {
    ASSERT_TRUE(BeginAttempt(store_, work_, {2 * i}));
    EXPECT_TRUE(LoadAttempts(store_, work_).value().under_way);
    EXPECT_THAT(EndKilledAttempts(store_, {2 * i + 1}).value(), ElementsAre(work_));
    EXPECT_THAT(LoadAttemptCounts(store_).value(), ElementsAre(Pair(work_, 0)));  // still begun before
  }
  ASSERT_TRUE(BeginAttempt(store_, work_, {100}));
  EXPECT_THAT(EndOpenAttempts(store_, AttemptEnd::kGivenBack, {101}).value(), ElementsAre(work_));  // an orderly stop
  EXPECT_EQ(Counted(), 0);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(BeginAttempt(store_, work_, {200 + i}));
    ASSERT_TRUE(EndKilledAttempts(store_, {200 + i}));
  }
  EXPECT_EQ(Counted(), 3);
  EXPECT_EQ(LoadAttempts(store_, work_).value().cut_off, 3);
  EXPECT_FALSE(LoadAttempts(store_, work_).value().under_way);
}

TEST_F(AttemptsTest, WorkThatIsDoneBeginsAtNoughtAgain) {
  ASSERT_TRUE(BeginAttempt(store_, work_, {1}));
  ASSERT_TRUE(EndAttempt(store_, work_, AttemptEnd::kFailed, "no memory", {2}));
  ASSERT_TRUE(EndAttempt(store_, work_, AttemptEnd::kDone, "", {3}));
  EXPECT_THAT(LoadAttemptCounts(store_).value(), IsEmpty());
  ASSERT_TRUE(BeginAttempt(store_, work_, {4}));
  EXPECT_THAT(LoadAttemptCounts(store_).value(), ElementsAre(Pair(work_, 1)));
  EXPECT_EQ(LoadAttempts(store_, work_).value().failed, 0);
  ASSERT_TRUE(EndAttempt(store_, WorkOfJob(77), AttemptEnd::kDone, "", {5}));  // never begun
}

TEST_F(AttemptsTest, AJobThatWasBegunBeforeComesAfterAllOthers) {
  AppendClosedSession(store_, 1, {{kLeft, kRight}, {kLeft, kThird}, {kRight, kThird}});
  AppendClosedSession(store_, 1, {{kLeft, kRight}}, kOtherRobot);
  const JobRow first = Next();
  ASSERT_TRUE(BeginAttempt(store_, WorkOfJob(first.number), {1}));
  const JobRow second = Next();
  EXPECT_EQ(second.number, first.number + 1);
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(BeginAttempt(store_, WorkOfJob(second.number), {2}));
  EXPECT_EQ(Next().number, second.number + 1);
  EXPECT_EQ(LoadNextJob(store_, {kRobot}).value()->robot, kOtherRobot);
  for (const std::int64_t number : {second.number + 1, second.number + 2}) ASSERT_TRUE(FinishJob(store_, number, {3}));
  EXPECT_EQ(Next().number, first.number);
  EXPECT_EQ(Next().attempts, 1);
  ASSERT_TRUE(FinishJob(store_, first.number, {4}));
  EXPECT_EQ(Next().number, second.number);
  EXPECT_EQ(Next().attempts, 2);
}

TEST_F(AttemptsTest, NamesOfWorkDiffer) {
  EXPECT_NE(WorkOfReport({RobotId("1"), 2}), WorkOfRevision(RobotId("1"), 2, 0));
  EXPECT_NE(WorkOfReport({RobotId("r"), 12}), WorkOfReport({RobotId("r"), 1}));
}

}  // namespace
}  // namespace rigcal::storage
