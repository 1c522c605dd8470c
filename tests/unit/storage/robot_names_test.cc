#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using Names = std::vector<RobotId>;

class RobotNamesTest : public StoreTest {
 protected:
  void SetUp() override {
    for (const char* name : {"rover-2", "Mapper-01", "mapper-01", "mapper-02", "mapperz", "mapp", "arm_left"})
      ASSERT_TRUE(AppendRobot(store_, RobotId(name), {1}));
  }
  static Names Of(const std::vector<const char*>& names) { return {names.begin(), names.end()}; }
};

TEST_F(RobotNamesTest, OfAPrefixInOrder) {
  EXPECT_EQ(LoadRobotNames(store_, "mapper", 9).value(), Of({"mapper-01", "mapper-02", "mapperz"}));
  EXPECT_EQ(LoadRobotNames(store_, "mapper", 2).value(), Of({"mapper-01", "mapper-02"}));
  EXPECT_EQ(LoadRobotNames(store_, "mapper-01", 9).value(), Of({"mapper-01"}));
  EXPECT_TRUE(LoadRobotNames(store_, "x", 9)->empty());
  EXPECT_EQ(LoadRobotNames(store_, "", 99)->size(), 7U);
  EXPECT_TRUE(LoadRobotNames(store_, "", 0)->empty());
}

TEST_F(RobotNamesTest, BesideANameThatIsNotKnown) {
  EXPECT_EQ(LoadRobotsBeside(store_, RobotId("mapper-015"), 2).value(),
            Of({"mapp", "mapper-01", "mapper-02", "mapperz"}));
  EXPECT_EQ(LoadRobotsBeside(store_, RobotId("A"), 1).value(), Of({"Mapper-01"}));
  EXPECT_EQ(LoadRobotsBeside(store_, RobotId("zz"), 1).value(), Of({"rover-2"}));
  EXPECT_EQ(LoadRobotsBeside(store_, RobotId("mapper-01"), 99)->size(), 6U) << "not itself";
}

TEST_F(RobotNamesTest, ThoseOfAListThatAreKnown) {
  EXPECT_EQ(LoadRobotsNamed(store_, Of({"rover-2", "mapper-01", "mapper-1", "rover-2"})).value(),
            Of({"mapper-01", "rover-2"}));
  EXPECT_TRUE(LoadRobotsNamed(store_, {})->empty());
}

}  // namespace
}  // namespace rigcal::storage
