// What sessions found stays with the revision that was made of them.
#include "storage/revisions/as_found.h"

#include <gmock/gmock.h>

#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using AsFoundStoreTest = StoreTest;

AsFound FoundBy(char session, FoundState state) {
  AsFound found;
  found.session = SessionId(std::string(64, session));
  found.captured_at = {5};
  found.in_use = 1;
  found.made_at = Stamp{4};
  found.tests = 6;
  found.relative_to = SensorId("left");
  for (const char* name : {"right", "top"}) {
    found.sensors.emplace_back();
    found.sensors.back().sensor = SensorId(name);
    found.sensors.back().state = state;
  }
  found.text = "As found.";
  return found;
}

TEST_F(AsFoundStoreTest, ComesBackWholeAndAtAGlance) {
  ASSERT_TRUE(store_.Write([&]() -> Status {
    for (int i = 1; i <= 3; ++i) {
      RIGCAL_ASSIGN(const int number, AppendRevision(store_, MakeRevision(i)));
      if (i == 2) RIGCAL_TRY(AppendAsFound(store_, {kRobot, number}, FoundBy('b', FoundState::kDrifted)));
      if (i == 3) RIGCAL_TRY(AppendAsFound(store_, {kRobot, number}, FoundBy('c', FoundState::kUnchanged)));
    }
    return {};
  }));
  EXPECT_FALSE(LoadAsFound(store_, {kRobot, 1}).value());
  const auto found = LoadAsFound(store_, {kRobot, 2}).value();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->session, SessionId(std::string(64, 'b')));
  EXPECT_EQ(found->sensors.size(), 2u);
  EXPECT_EQ(found->made_at, Stamp{4});
  const auto summaries = LoadAsFoundSummaries(store_, kRobot, {1, 2, 3}).value();
  ASSERT_EQ(summaries.size(), 2u);
  EXPECT_EQ(summaries.at(2).state, FoundState::kDrifted);
  EXPECT_THAT(summaries.at(2).drifted, testing::ElementsAre(SensorId("right"), SensorId("top")));
  EXPECT_EQ(summaries.at(3).session, SessionId(std::string(64, 'c')));
  EXPECT_TRUE(summaries.at(3).drifted.empty());
  EXPECT_EQ(LoadAsFoundSummaries(store_, kRobot, {3})->size(), 1u);
}

}  // namespace
}  // namespace rigcal::storage
