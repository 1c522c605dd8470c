// What robots say that they run, and how it is told beside what is in use.
#include "storage/fleet/robot_runs.h"

#include <gtest/gtest.h>

#include "storage/revisions/decisions.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

class RobotRunsTest : public StoreTest {
 protected:
  RunsReport Report(const Digest& digest, const std::string& who = "rigcal agent") {
    return {kRobot, digest, {5}, who};
  }
};

TEST_F(RobotRunsTest, OnlyChangesAreKept) {
  ASSERT_TRUE(AppendRobot(store_, kRobot, {1}));
  EXPECT_FALSE(LoadRuns(store_, kRobot).value());
  EXPECT_TRUE(AppendRuns(store_, Report(DigestOf("a")), {10}).value());
  EXPECT_FALSE(AppendRuns(store_, Report(DigestOf("a")), {11}).value());
  EXPECT_TRUE(AppendRuns(store_, Report(DigestOf("b")), {12}).value());
  EXPECT_TRUE(AppendRuns(store_, Report(DigestOf("a")), {13}).value());
  const RobotRuns runs = *LoadRuns(store_, kRobot).value();
  EXPECT_EQ(runs.report.digest, DigestOf("a"));
  EXPECT_EQ(runs.report.applied_at, Stamp{5});
  EXPECT_EQ(runs.report.who, "rigcal agent");
  EXPECT_EQ(runs.told_at, Stamp{13});
  EXPECT_EQ(runs.revision, 0);
}

TEST_F(RobotRunsTest, ADigestIsThatOfARevisionOfTheRobot) {
  ASSERT_TRUE(AppendRevision(store_, MakeRevision(1)));
  ASSERT_TRUE(AppendRevision(store_, MakeRevision(2)));
  ASSERT_TRUE(AppendRuns(store_, Report(MakeRevision(1).digest), {10}));
  EXPECT_EQ(LoadRuns(store_, kRobot).value()->revision, 1);
}

TEST_F(RobotRunsTest, WhatCannotBeKeptIsRefused) {
  EXPECT_EQ(AppendRuns(store_, Report(DigestOf("a")), {10}).error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(AppendRobot(store_, kRobot, {1}));
  EXPECT_EQ(AppendRuns(store_, Report(DigestOf("a"), "a\nb"), {10}).error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(AppendRuns(store_, Report(DigestOf("a"), std::string(65, 'a')), {10}).error().code,
            ErrorCode::kInvalidInput);
}

TEST(RobotRuns, AreToldBesideWhatIsInUse) {
  RobotRuns runs{{kRobot, Digest(std::string(64, 'a')), {5}, "agent"}, 3, {6}};
  const UsableRevision third{3, {}}, fifth{5, {}};
  EXPECT_EQ(RunsOf(runs, true, {}, third).trouble, "");
  EXPECT_EQ(RunsOf(runs, true, {}, fifth).trouble, "It runs revision 3; revision 5 is in use: not applied yet.");
  EXPECT_EQ(RunsOf(runs, false, {}, fifth).trouble,
            "It runs revision 3, which nobody approved; revision 5 is in use: not applied yet.");
  EXPECT_EQ(RunsOf(runs, true, {}, std::nullopt).trouble, "It runs revision 3; no calibration of it is in use.");
  EXPECT_EQ(RunsOf(runs, true, {}, fifth).revision, 3);
  EXPECT_EQ(RunsOf(runs, true, {}, fifth).digest, runs.report.digest);
  const Decision no{9, 3, "rejected", {{1'793'707'200'000'000'000}, "Ada", "bent"}};
  EXPECT_EQ(RunsOf(runs, true, no, fifth).trouble,
            "It runs revision 3, which was rejected by Ada, 3 Nov 2026; revision 5 is in use: not applied yet.");
  EXPECT_EQ(RunsOf(runs, true, no, fifth).what, "revision 3, which was rejected by Ada, 3 Nov 2026");
  runs.revision = 0;
  EXPECT_EQ(RunsOf(runs, false, {}, fifth).trouble,
            "It runs a calibration that nobody approved here (sha256 aaaaaaaaaaaa).");
}

}  // namespace
}  // namespace rigcal::storage
