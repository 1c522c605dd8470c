#include "server/dds/record/open_sessions.h"

#include <gtest/gtest.h>

#include "server/base/digests/sha256.h"
#include "server/base/limits_in_force.h"
#include "server/dds/record/batch_recorder.h"
#include "tests/unit/dds/fixture.h"

namespace rigcal::dds {
namespace {

class OpenSessionsTest : public testing::Test {
 protected:
  ~OpenSessionsTest() override { limits::Enforce({}); }
  static void Allow(std::int64_t sessions) {
    limits::Limits limits;
    limits.open_sessions = sessions;
    limits::Enforce(limits);
  }
  static SessionId IdOf(const std::string& name) { return SessionId(Sha256Of(name).str()); }
  SessionIntake& Added(const std::string& name, const std::vector<bool>& held = {false}) {
    Manifest manifest;
    for (std::size_t i = 0; i < held.size(); ++i) {
      Payload payload;
      payload.digest = Sha256Of(name + std::to_string(i));
      payload.size_bytes = 10;
      manifest.payloads.push_back(payload);
    }
    return **sessions_.Add(RobotId("mapper-01"), IdOf(name), manifest, held);
  }
  TempFolder folder_;
  OpenSessions sessions_{folder_.path(), 7};
};

TEST_F(OpenSessionsTest, TheOneUsedLongestAgoIsInTheWay) {
  Allow(2);
  Added("a");
  EXPECT_FALSE(sessions_.InTheWayOf(1));
  Added("b");
  EXPECT_EQ(sessions_.InTheWayOf(1), IdOf("a"));
  ASSERT_NE(sessions_.Find(IdOf("a")), nullptr);  // it is used
  EXPECT_EQ(sessions_.InTheWayOf(1), IdOf("b"));
  sessions_.Remove(IdOf("b"));
  EXPECT_FALSE(sessions_.InTheWayOf(1));
  EXPECT_EQ(sessions_.InTheWayOf(2'000'000), IdOf("a"));  // so many payloads fit beside no other
  sessions_.Remove(IdOf("a"));
  EXPECT_FALSE(sessions_.InTheWayOf(2'000'000));
}

TEST_F(OpenSessionsTest, EachHasAFolderWhileItIsReceived) {
  const std::filesystem::path folder = Added("a").folder();
  EXPECT_TRUE(std::filesystem::is_directory(folder));
  EXPECT_EQ(sessions_.Count(), 1u);
  sessions_.dirty().insert(IdOf("a"));
  sessions_.Remove(IdOf("a"));
  EXPECT_FALSE(std::filesystem::exists(folder));
  EXPECT_EQ(sessions_.Count(), 0u);
  EXPECT_TRUE(sessions_.dirty().empty());
  EXPECT_EQ(sessions_.Find(IdOf("a")), nullptr);
}

TEST_F(OpenSessionsTest, ClientsSendAgainWhatWasDroppedUnfinished) {
  Added("whole", {true, true});
  sessions_.Remove(IdOf("whole"));
  EXPECT_EQ(sessions_.incarnation(), 7u);
  Added("half", {true, false});
  sessions_.Remove(IdOf("half"));
  EXPECT_EQ(sessions_.incarnation(), 8u);
  sessions_.Remove(IdOf("half"));  // gone already
  EXPECT_EQ(sessions_.incarnation(), 8u);
}

TEST_F(OpenSessionsTest, WhatALastRunLeftIsRemoved) {
  const std::filesystem::path left = Added("a").folder();
  const OpenSessions next(folder_.path(), 8);
  EXPECT_FALSE(std::filesystem::exists(left));
}

TEST(OpenBatches, ForgetsTheOneUsedLongestAgo) {
  OpenBatches batches;
  const auto id = [](int i) { return BatchId(Sha256Of(std::to_string(i)).str()); };
  const auto add = [&](int i, std::size_t items) {
    batches.Add(id(i), {RobotId("mapper-01"), std::vector<bool>(items, false)});
  };
  EXPECT_FALSE(batches.IsFullFor(1u << 30));  // whatever comes first fits
  for (int i = 0; i < 256; ++i) add(i, 2);
  EXPECT_TRUE(batches.IsFullFor(1));
  ASSERT_NE(batches.Find(id(0)), nullptr);
  batches.RemoveOldest();
  EXPECT_EQ(batches.Find(id(1)), nullptr);
  EXPECT_NE(batches.Find(id(0)), nullptr);
  EXPECT_FALSE(batches.IsFullFor(1));
  EXPECT_TRUE(batches.IsFullFor(16'000'000)) << "items of all together";
  batches.Remove(id(9));
  EXPECT_FALSE(batches.IsFullFor(16'000'000 - 2 * 254));
}

}  // namespace
}  // namespace rigcal::dds
