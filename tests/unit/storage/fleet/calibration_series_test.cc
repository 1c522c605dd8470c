// A robot's calibrations as its summary keeps them: from its newest revisions, and as text.
#include "storage/fleet/calibration_series.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <sqlite3.h>

#include "storage/fleet/fleet_facts.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

class CalibrationSeriesTest : public StoreTest {
 protected:
  // The next revision of the robot. Without a time it counts nothing, without sigmas nothing checks an edge.
  void Append(std::optional<std::int64_t> calibrated_s, std::optional<double> sigmas, const RobotId& robot = kRobot) {
    Revision revision = MakeRevision(1, robot);
    if (calibrated_s) revision.calibrated_at = Stamp{*calibrated_s * kSecond_ns};
    const auto number = AppendRevision(store_, revision);
    ASSERT_TRUE(number) << WordsOf(number);
    if (!sigmas) return;
    ASSERT_TRUE(AppendWorstEdge(store_, {robot, *number}, {SensorId("left"), SensorId("right"), *sigmas}));
  }
  std::int64_t StepsOf(const RobotId& robot, std::size_t points) {
    const auto count = [&] {
      std::int64_t steps = 0;
      sqlite3* database = store_.database().getHandle();
      for (sqlite3_stmt* one = sqlite3_next_stmt(database, nullptr); one != nullptr;
           one = sqlite3_next_stmt(database, one)) {
        EXPECT_EQ(sqlite3_stmt_status(one, SQLITE_STMTSTATUS_FULLSCAN_STEP, 1), 0) << sqlite3_sql(one);
        steps += sqlite3_stmt_status(one, SQLITE_STMTSTATUS_VM_STEP, 1);
      }
      return steps;
    };
    (void)count();
    EXPECT_EQ(LoadCalibrations(store_, robot)->size(), points);
    return count();
  }
};

TEST_F(CalibrationSeriesTest, AreThoseOfTheRevisionsOfTheRobot) {
  EXPECT_THAT(LoadCalibrations(store_, kRobot).value(), IsEmpty());
  Append(10, 0.5);
  Append(std::nullopt, std::nullopt);
  Append(20, std::nullopt);
  Append(30, 1.25);
  Append(30, 2.5);  // judged anew
  Append(40, 9.0, RobotId("another"));
  EXPECT_THAT(LoadCalibrations(store_, kRobot).value(),
              ElementsAre(CalibrationPoint{Stamp{10 * kSecond_ns}, 0.5}, CalibrationPoint{Stamp{20 * kSecond_ns}},
                          CalibrationPoint{Stamp{30 * kSecond_ns}, 2.5}));
}

// It is asked for whenever something of a robot changed.
TEST_F(CalibrationSeriesTest, CostTheSameHoweverManyRevisionsThereAre) {
  if (!IsOnSqlite()) GTEST_SKIP() << "counts SQLite's steps";
  for (std::int64_t visit = 1; visit <= 110; ++visit) Append(visit, 1.0);
  const std::int64_t with_some = StepsOf(kRobot, kCalibrationsListedMax);
  for (std::int64_t visit = 111; visit <= 400; ++visit) Append(visit, 1.0);
  EXPECT_LE(StepsOf(kRobot, kCalibrationsListedMax), with_some + with_some / 20);
}

TEST(CalibrationSeriesText, ComesBackToTheSecondAndTheThousandth) {
  const std::vector<CalibrationPoint> points = {{Stamp{1'769'860'800 * kSecond_ns + 7}, 0.4204},
                                                {Stamp{1'777'291'200 * kSecond_ns}},
                                                {Stamp{1'777'291'201 * kSecond_ns}, 1e300}};
  const std::string text = TextOfCalibrations(points);
  EXPECT_EQ(text, "1769860800 420,1777291200 -,1777291201 1000000000000000");
  EXPECT_THAT(CalibrationsOfText(text), ElementsAre(CalibrationPoint{Stamp{1'769'860'800 * kSecond_ns}, 0.42},
                                                    CalibrationPoint{Stamp{1'777'291'200 * kSecond_ns}},
                                                    CalibrationPoint{Stamp{1'777'291'201 * kSecond_ns}, 1e12}));
  EXPECT_EQ(TextOfCalibrations({}), "");
  EXPECT_THAT(CalibrationsOfText(""), IsEmpty());
}

TEST(CalibrationSeriesText, WhatIsNoneEndsIt) {
  const CalibrationPoint first{Stamp{kSecond_ns}, 2.0};
  for (const char* rest : {",", ",x", ",2", ",2 ", ",2 x", ",2 3x", ", 3", ",2 -x"})
    EXPECT_THAT(CalibrationsOfText(std::string("1 2000") + rest), ElementsAre(first)) << rest;
}

}  // namespace
}  // namespace rigcal::storage
