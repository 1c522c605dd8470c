#include "server/base/process/vitals.h"

#include <gtest/gtest.h>

namespace rigcal {
namespace {

class SetClock : public Clock {
 public:
  Stamp now{1'000};
  [[nodiscard]] Stamp Now() const override { return now; }
};

class VitalsTest : public testing::Test {
 protected:
  PartState After(std::chrono::seconds time) { return vitals_.States(std::chrono::steady_clock::now() + time).front(); }
  SetClock clock_;
  Vitals vitals_{clock_};
  Part& part_ = vitals_.Expect("intake", std::chrono::seconds(30));
};

TEST_F(VitalsTest, PartThatStandsStillIsTold) {
  EXPECT_FALSE(After(std::chrono::seconds(10)).problem);
  const PartState still = After(std::chrono::seconds(60));
  ASSERT_TRUE(still.problem);
  EXPECT_EQ(still.problem->what, "the part 'intake' of the server stands still");
  EXPECT_EQ(still.since, Stamp{1'000});
  EXPECT_EQ(still.name, "intake");
}

TEST_F(VitalsTest, PartThatIsOpenedAgainGoesOn) {
  part_.Fail({ErrorCode::kInternal, "DDS wait set: error", "Wait."});
  EXPECT_EQ(&vitals_.Expect("intake", std::chrono::seconds(30)), &part_);
  ASSERT_EQ(vitals_.States().size(), 1u);
  EXPECT_FALSE(After(std::chrono::seconds(10)).problem);
}

TEST_F(VitalsTest, TurningIsWell) {
  part_.Turn();
  EXPECT_FALSE(After(std::chrono::seconds(10)).problem);
}

TEST_F(VitalsTest, RestMayBeAsLongAsItLikes) {
  part_.Rest();
  EXPECT_FALSE(After(std::chrono::hours(1000)).problem);
  part_.Turn();
  EXPECT_TRUE(After(std::chrono::hours(1000)).problem);
}

TEST_F(VitalsTest, FailureHoldsSinceItsFirstUntilTheNextTurn) {
  clock_.now.ns = 2'000;
  part_.Fail({ErrorCode::kInternal, "DDS wait set: error", "Wait."});
  clock_.now.ns = 3'000;
  part_.Fail({ErrorCode::kInternal, "DDS wait set: bad parameter", "Wait."});
  const PartState failing = After(std::chrono::seconds(0));
  ASSERT_TRUE(failing.problem);
  EXPECT_EQ(failing.problem->what, "DDS wait set: bad parameter");
  EXPECT_EQ(failing.since, Stamp{2'000});
  EXPECT_EQ(failing.failures, 2);
  part_.Turn();
  EXPECT_FALSE(After(std::chrono::seconds(0)).problem);
  EXPECT_EQ(After(std::chrono::seconds(0)).failures, 2);
}

}  // namespace
}  // namespace rigcal
