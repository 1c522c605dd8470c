// Processor time, so that other work of the machine does not count; limits that catch a lost index or statement cache.
#include <ctime>
#include <functional>
#include <iostream>

#include "storage/fleet/fleet_list.h"
#include "storage/fleet/robot_summary.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

double NowMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

double MillisecondsOf(const std::string& name, const std::function<void()>& body) {
  const double start_ms = NowMs();
  body();
  const double elapsed_ms = NowMs() - start_ms;
  std::cout << "  " << name << ": " << elapsed_ms << " ms of processor time\n";
  return elapsed_ms;
}

class SpeedTest : public StoreTest {
 protected:
  void SetUp() override {
    if (!IsOnSqlite()) GTEST_SKIP() << "its limits are those of SQLite";
  }
};

TEST_F(SpeedTest, SixThousandPushedEdgesInOneTransaction) {
  constexpr int kEdges = 6000;
  std::vector<Edge> edges;
  for (int i = 0; i < kEdges; ++i) {
    Edge edge = MakeEdge(i);
    edge.uncertainty = FromInformation(Matrix6d::Identity() * (1.0 + i), UncertaintySource::kGiven, 0);
    edge.diagnoses.clear();
    edge.figures.clear();
    edge.captures.clear();
    edge.evidence.clear();
    edges.push_back(edge);
  }
  const BatchId batch(DigestOf("batch").str());
  const auto push = [&]() -> Status {
    RIGCAL_TRY(AppendBatch(store_, kRobot, batch, kEdges, {1}));
    for (int i = 0; i < kEdges; ++i)
      RIGCAL_TRY(AppendBatchItems(store_, batch, {{i, edges[static_cast<std::size_t>(i)]}}, {1}));
    return {};
  };
  EXPECT_LT(MillisecondsOf("6,000 edges with their batch", [&] { ASSERT_TRUE(store_.Write(push)); }), 2000.0);
  EXPECT_LT(MillisecondsOf("the same again", [&] { ASSERT_TRUE(store_.Write(push)); }), 2000.0);
  EXPECT_LT(MillisecondsOf("load them", [&] { ASSERT_EQ(LoadEdges(store_, kRobot, true)->size(), edges.size()); }),
            2000.0);
}

TEST_F(SpeedTest, TenThousandPayloads) {
  constexpr std::size_t kPayloads = 10'000;
  SessionId id;
  EXPECT_LT(MillisecondsOf("append 10,000 payloads", [&] { id = AppendOpenSession(store_, kPayloads); }), 2000.0);
  std::vector<std::uint32_t> all(kPayloads);
  for (std::uint32_t i = 0; i < kPayloads; ++i) all[i] = i;
  EXPECT_LT(MillisecondsOf("mark them", [&] { ASSERT_TRUE(AppendHeld(store_, id, all, {1})); }), 2000.0);
  EXPECT_LT(MillisecondsOf("LoadHeld", [&] { ASSERT_EQ(LoadHeld(store_, id)->size(), kPayloads); }), 200.0);
  const Digest digest = MakeManifest(kPayloads).payloads.back().digest;
  EXPECT_LT(MillisecondsOf("IsHeld", [&] { ASSERT_TRUE(IsHeld(store_, kRobot, digest).value()); }), 20.0);
}

TEST_F(SpeedTest, AFleetAtRest) {
  constexpr int kRobots = 3000;
  ASSERT_TRUE(store_.Write([&]() -> Status {
    for (int i = 0; i < kRobots; ++i) {
      const RobotId robot("robot-" + std::to_string(i));
      for (int k = 0; k < 3; ++k) RIGCAL_TRY(AppendEdge(store_, MakeEdge(k, robot), {1}));
      RIGCAL_ASSIGN(const std::int64_t watermark, LoadEdgeWatermark(store_, robot));
      RIGCAL_TRY(AppendRevision(store_, MakeRevision(watermark, robot)));
    }
    return {};
  }));
  EXPECT_LT(MillisecondsOf("LoadUnsolvedRobots, 3,000 robots",
                           [&] { ASSERT_TRUE(LoadUnsolvedRobots(store_).value().empty()); }),
            200.0);
  EXPECT_LT(MillisecondsOf("open the store", [&] { Open(); }), 500.0);
}

TEST_F(SpeedTest, AListOfTenThousandRobots) {
  constexpr int kRobots = 10'000;
  ASSERT_TRUE(store_.Write([&]() -> Status {
    for (int i = 0; i < kRobots; ++i) {
      RobotSummary summary;
      summary.robot = RobotId("robot-" + std::to_string(i));
      summary.verdict = {static_cast<VerdictLevel>(i % 4), "Sentence " + std::to_string(i) + " says why.", ""};
      RIGCAL_TRY(AppendRobot(store_, summary.robot, {1}));
      RIGCAL_TRY(ReplaceSummary(store_, summary, 1));
    }
    return {};
  }));
  const Stamp now{1};
  const FleetQuery last_page{"", "", "", false, kRobots}, search{"sentence 9999", "", "", false, 1};
  EXPECT_LT(MillisecondsOf("count them", [&] { ASSERT_EQ(CountFleet(store_, now)->robots, kRobots); }), 100.0);
  EXPECT_LT(MillisecondsOf("first page", [&] { ASSERT_EQ(LoadFleetPage(store_, {}, now)->rows.size(), 100u); }), 100.0);
  EXPECT_LT(MillisecondsOf("last page", [&] { ASSERT_EQ(LoadFleetPage(store_, last_page, now)->rows.size(), 100u); }),
            100.0);
  EXPECT_LT(MillisecondsOf("search", [&] { ASSERT_EQ(LoadFleetPage(store_, search, now)->matches, 1u); }), 200.0);
  EXPECT_LT(MillisecondsOf("how many there are", [&] { ASSERT_EQ(LoadFleetSize(store_)->robots, kRobots); }), 20.0);
}

}  // namespace
}  // namespace rigcal::storage
