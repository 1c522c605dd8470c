// What robots of a rig model scatter by: one row per robot and sensor, replaced with each revision.
#include "storage/fleet/visit_scatter.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include <limits>

#include "storage/database/query.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;
using testing::SizeIs;

using Scatter = std::map<SensorId, VisitScatter>;
const SensorId kRear("rear");

// Every number differs from every other.
VisitScatter Some(double seed, double dof = 6.0) {
  return {{1e-7 * seed, 2e-8 * seed, dof, {0.1 * seed, 0.2 * seed, 0.3 * seed}},
          {-3e-9 * seed, 4e-8 * seed, dof + 3, {0.4 * seed, 0.5 * seed, 0.6 * seed}}};
}

class VisitScatterTest : public StoreTest {
 protected:
  void SetUp() override {
    for (const char* robot : {"a", "b", "c", "d"}) ASSERT_TRUE(AppendRobot(store_, RobotId(robot), {1}));
  }
  Status Replace(const std::string& robot, const Scatter& scatter, const std::string& model = "mars",
                 const SensorId& reference = kLeft) {
    return store_.Write([&] { return ReplaceVisitScatter(store_, RobotId(robot), model, reference, scatter); });
  }
  std::vector<Scatter> OthersOf(const std::string& robot, const std::string& model = "mars", int max = 100,
                                const SensorId& reference = kLeft) {
    const auto others = LoadScatterOfOthers(store_, RobotId(robot), model, reference, max);
    EXPECT_TRUE(others) << WordsOf(others);
    return others.value_or(std::vector<Scatter>());
  }
};

TEST_F(VisitScatterTest, IsThatOfTheOtherRobotsAsItWasPut) {
  ASSERT_TRUE(Replace("b", {{kRight, Some(1)}, {kRear, Some(2)}}));
  ASSERT_TRUE(Replace("a", {{kRight, Some(3)}}));
  EXPECT_THAT(OthersOf("c"), ElementsAre(ElementsAre(Pair(kRight, Some(3))),
                                         ElementsAre(Pair(kRear, Some(2)), Pair(kRight, Some(1)))));
  EXPECT_THAT(OthersOf("a"), ElementsAre(SizeIs(2)));
  EXPECT_THAT(OthersOf("b"), ElementsAre(ElementsAre(Pair(kRight, Some(3)))));
}

// A revision without a session that was retired, or of which another of the same pictures took the place, or without a
// sensor that was.
TEST_F(VisitScatterTest, OfEachRobotOnlyWhatItsNewestRevisionTells) {
  ASSERT_TRUE(Replace("a", {{kRight, Some(1, 12)}, {kRear, Some(2, 12)}}));
  ASSERT_TRUE(Replace("a", {{kRight, Some(5, 9)}}));
  EXPECT_THAT(OthersOf("b"), ElementsAre(ElementsAre(Pair(kRight, Some(5, 9)))));
  ASSERT_TRUE(Replace("a", {{kRight, Some(5, 0)}}));  // of one visit
  EXPECT_THAT(OthersOf("b"), IsEmpty());
  ASSERT_TRUE(Replace("a", {}));
  EXPECT_THAT(OthersOf("b"), IsEmpty());
}

TEST_F(VisitScatterTest, ARobotIsOfOneModelAndOneReference) {
  ASSERT_TRUE(Replace("a", {{kRight, Some(1)}}));
  ASSERT_TRUE(Replace("a", {{kRight, Some(2)}}, "venus"));
  EXPECT_THAT(OthersOf("b"), IsEmpty());
  EXPECT_THAT(OthersOf("b", "venus"), SizeIs(1));
  ASSERT_TRUE(Replace("a", {{kLeft, Some(3)}}, "venus", kRight));
  EXPECT_THAT(OthersOf("b", "venus"), IsEmpty());
  EXPECT_THAT(OthersOf("b", "venus", 100, kRight), SizeIs(1));
  ASSERT_TRUE(Replace("a", {{kLeft, Some(3)}}, ""));
  EXPECT_THAT(OthersOf("b", "venus", 100, kRight), IsEmpty());
}

TEST_F(VisitScatterTest, SoManyRobotsAndNoPartOfOne) {
  for (const char* robot : {"a", "b", "c"}) ASSERT_TRUE(Replace(robot, {{kRight, Some(1)}, {kRear, Some(2)}}));
  EXPECT_THAT(OthersOf("d", "mars", 2), ElementsAre(SizeIs(2), SizeIs(2)));
  EXPECT_THAT(OthersOf("a", "mars", 2), ElementsAre(SizeIs(2), SizeIs(2)));
  EXPECT_THAT(OthersOf("d", "mars", 0), IsEmpty());
}

TEST_F(VisitScatterTest, ANumberThatIsNoneIsRefusedAndNothingChanges) {
  ASSERT_TRUE(Replace("a", {{kRight, Some(1)}}));
  VisitScatter none = Some(2);
  none.rotation.between = std::numeric_limits<double>::quiet_NaN();
  const Status refused = Replace("a", {{kRight, none}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidInput);
  none = Some(2);
  none.translation.ratio[1] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(Replace("a", {{kRight, none}}));
  EXPECT_THAT(OthersOf("b"), ElementsAre(ElementsAre(Pair(kRight, Some(1)))));
}

// The rows of one model by its index, whatever other models have.
TEST_F(VisitScatterTest, LooksAtNoOtherModel) {
  if (!IsOnSqlite()) GTEST_SKIP() << "asks SQLite for its plan";
  SQLite::Statement query(
      store_.database(),
      "EXPLAIN QUERY PLAN SELECT robot_id FROM summary_scatter WHERE rig_model = ? AND reference_id = ? AND "
      "robot_id <> ? ORDER BY robot_id, sensor_id");
  std::string plan;
  while (query.executeStep()) plan += query.getColumn(3).getString() + "; ";
  EXPECT_THAT(plan, testing::HasSubstr("SEARCH summary_scatter USING PRIMARY KEY (rig_model=? AND reference_id=?)"));
  EXPECT_THAT(plan, testing::Not(testing::HasSubstr("TEMP B-TREE")));
}

}  // namespace
}  // namespace rigcal::storage
