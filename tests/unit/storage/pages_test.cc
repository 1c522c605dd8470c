// Pages of a history: one after the other they are the whole list, whatever comes meanwhile.
#include "server/formats/documents.h"
#include "storage/fleet/fleet_facts.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

const RobotId kOtherRobot("mapper-02");

class PagesTest : public StoreTest {
 protected:
  // Captured at so many seconds: several at once too.
  SessionId AppendCaptured(int seed, int at_s, const RobotId& robot = kRobot) {
    Manifest manifest = MakeManifest(1, robot);
    manifest.header.captured_at = {1'000'000'000LL * at_s};
    const SessionId id(DigestOf("session " + std::to_string(seed)).str());
    EXPECT_TRUE(AppendSession(store_, id, formats::WriteManifest(manifest), manifest, {10}));
    return id;
  }
  static std::vector<SessionId> IdsOf(const std::vector<SessionRow>& rows) {
    std::vector<SessionId> ids;
    for (const SessionRow& row : rows) ids.push_back(row.id);
    return ids;
  }
  std::vector<SessionId> SessionsByPages(const RobotId& robot, std::int64_t limit) {
    std::vector<SessionId> all;
    for (SessionId before;;) {
      const auto page = IdsOf(LoadSessions(store_, robot, before, limit).value());
      if (page.empty()) return all;
      EXPECT_LE(static_cast<std::int64_t>(page.size()), limit);
      all.insert(all.end(), page.begin(), page.end());
      before = page.back();
    }
  }
};

TEST_F(PagesTest, OfSessionsAreTheList) {
  for (int i = 0; i < 11; ++i) AppendCaptured(i, i % 4, i % 3 == 0 ? kOtherRobot : kRobot);
  for (const RobotId& robot : {kRobot, kOtherRobot, RobotId()}) {
    const auto whole = IdsOf(LoadSessions(store_, robot).value());
    EXPECT_EQ(whole.size(), robot.empty() ? 11U : robot == kRobot ? 7U : 4U);
    for (const std::int64_t limit : {1, 2, 3, 100}) EXPECT_EQ(SessionsByPages(robot, limit), whole) << limit;
  }
}

TEST_F(PagesTest, OfSessionsGoOnWhereTheyWereWhateverCame) {
  for (int i = 0; i < 4; ++i) AppendCaptured(i, 10 * i);
  const auto first = IdsOf(LoadSessions(store_, kRobot, SessionId(), 2).value());
  AppendCaptured(7, 100);  // newer than all
  const SessionId between = AppendCaptured(8, 15);
  const auto second = IdsOf(LoadSessions(store_, kRobot, first.back(), 2).value());
  ASSERT_EQ(second.size(), 2U);
  EXPECT_EQ(second.front(), between);
  EXPECT_EQ(LoadSessions(store_, kRobot, SessionId(DigestOf("none").str()), 2).error().code, ErrorCode::kNotFound);
}

TEST_F(PagesTest, OfEdgesAreThoseThatCountTheNewestFirst) {
  ASSERT_TRUE(AppendRobot(store_, kRobot, {1}));
  std::vector<EdgeId> newest_first;
  for (int i = 0; i < 7; ++i) {
    ASSERT_TRUE(AppendEdge(store_, MakeEdge(i), {1}));
    ASSERT_TRUE(AppendEdge(store_, MakeEdge(i, kOtherRobot), {1}));
    newest_first.insert(newest_first.begin(), MakeEdge(i).id);
  }
  const BatchId batch(DigestOf("batch").str());
  ASSERT_TRUE(AppendBatch(store_, kRobot, batch, 2, {1}));
  ASSERT_TRUE(AppendBatchItems(store_, batch, {{0, MakeEdge(50)}}, {1}));  // the other one is missing
  for (const std::int64_t limit : {1, 3, 100}) {
    std::vector<EdgeId> all;
    for (EdgeId before;;) {
      const std::vector<EdgeId> page = LoadEdgeIds(store_, kRobot, before, limit).value();
      if (page.empty()) break;
      all.insert(all.end(), page.begin(), page.end());
      before = page.back();
    }
    EXPECT_EQ(all, newest_first) << limit;
  }
  for (const EdgeId& none : {MakeEdge(50).id, MakeEdge(1, kOtherRobot).id})
    EXPECT_EQ(LoadEdgeIds(store_, kRobot, none, 2).error().code, ErrorCode::kNotFound);
}

TEST_F(PagesTest, OfRevisionsGoDownFromANumber) {
  for (int i = 1; i <= 6; ++i) {
    Revision revision = MakeRevision(i);
    revision.created_at = {100 * i};
    ASSERT_TRUE(AppendRevision(store_, revision));
  }
  const auto numbers = [&](int before, std::int64_t limit) {
    std::vector<int> found;
    const std::vector<Revision> page = LoadRevisions(store_, kRobot, before, limit).value();
    for (const Revision& revision : page) found.push_back(revision.number);
    return found;
  };
  EXPECT_EQ(numbers(0, 2), (std::vector<int>{6, 5}));
  EXPECT_EQ(numbers(5, 3), (std::vector<int>{4, 3, 2}));
  EXPECT_EQ(numbers(2, 3), (std::vector<int>{1}));
  EXPECT_EQ(numbers(1, 3), (std::vector<int>{}));
  const auto created_at = LoadCreatedAt(store_, kRobot, {2, 6, 7}).value();
  ASSERT_EQ(created_at.size(), 2U);
  EXPECT_EQ(created_at.at(6).ns, 600);
}

TEST_F(PagesTest, OfSessionsKnowWhatCameOfThem) {
  const SessionId one = AppendCaptured(1, 1), two = AppendCaptured(2, 2);
  Edge good = MakeEdge(1), failed = MakeFailedEdge(1);
  good.session = failed.session = one;
  for (const Edge& edge : {good, failed}) ASSERT_TRUE(AppendEdge(store_, edge, {1}));
  const auto facts = LoadSessionFacts(store_, {one, two}).value();
  ASSERT_EQ(facts.size(), 1U);
  EXPECT_EQ(facts.at(one).good, 1);
  EXPECT_EQ(facts.at(one).failed, 1);
  const auto captured_at =
      LoadCapturedAt(store_, std::vector<SessionId>{two, SessionId(DigestOf("none").str())}).value();
  ASSERT_EQ(captured_at.size(), 1U);
  EXPECT_EQ(captured_at.at(two).ns, 2'000'000'000);
}

}  // namespace
}  // namespace rigcal::storage
