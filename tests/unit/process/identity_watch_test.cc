// What was no good once is looked at again.
#include "server/identity_watch.h"

#include <gtest/gtest.h>

#include <fstream>

#include "client/identity/authority.h"
#include "server/base/files/durable_file.h"
#include "tests/unit/temp_folder.h"

namespace rigcal {
namespace {

namespace fs = std::filesystem;

class IdentityWatchTest : public testing::Test {
 protected:
  void Revoke(std::int64_t later_s = 0) {
    const Stamp now = SystemClock().Now();
    ASSERT_TRUE(authority_.Issue(IdentityHolder::kRobot, "a", now, {now.ns + 3'600'000'000'000}, true));
    ASSERT_TRUE(authority_.Revoke(IdentityHolder::kRobot, "a", {now.ns + later_s * 1'000'000'000}));
  }
  [[nodiscard]] fs::path List() const { return place_ / identity_files::kRevoked; }
  [[nodiscard]] bool LooksNow() {
    watch_.LookNow();
    return watch_.HasNext();
  }

  const TempFolder folder_;
  client::Authority authority_ = client::Authority::Make(folder_.path() / "fleet", SystemClock().Now()).value();
  const fs::path place_ = folder_.path() / "fleet/server";
  IdentityWatch watch_{place_};
};

TEST_F(IdentityWatchTest, TellsOfAChangeUntilItIsTakenUp) {
  EXPECT_FALSE(LooksNow());
  Revoke();
  EXPECT_TRUE(LooksNow());
  watch_.WasRefused();
  EXPECT_FALSE(watch_.HasNext()) << "not at once again";
  EXPECT_TRUE(LooksNow()) << "what was refused counts as taken up";
  watch_.TakenUp();
  EXPECT_FALSE(LooksNow());
}

TEST_F(IdentityWatchTest, WhatWasNoGoodIsTakenUpOnceItIs) {
  Revoke();
  fs::permissions(place_, fs::perms::others_write, fs::perm_options::add);
  EXPECT_FALSE(LooksNow());
  fs::permissions(place_, fs::perms::others_write, fs::perm_options::remove);
  EXPECT_TRUE(LooksNow());
}

// A copy of before, over the list in force: who was revoked since would be let in again.
TEST_F(IdentityWatchTest, AnOlderListIsRefused) {
  const std::string older = ReadFile(List(), 1 << 20).value();
  Revoke(5);
  ASSERT_TRUE(LooksNow());
  watch_.TakenUp();
  const std::string newer = ReadFile(List(), 1 << 20).value();
  std::ofstream(List(), std::ios::binary) << older;
  testing::internal::CaptureStderr();
  EXPECT_FALSE(LooksNow());
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("revoked.crl was made at "), said.npos) << said;
  EXPECT_NE(said.find(", before the list in force, of "), said.npos) << said;
  std::ofstream(List(), std::ios::binary) << newer;
  EXPECT_TRUE(LooksNow());
  watch_.TakenUp();
  Revoke(10);
  EXPECT_TRUE(LooksNow());
}

// Whoever takes over from another server reads the files anew, without a change that is told of first.
TEST_F(IdentityWatchTest, AnOlderListMayNotBeReadByWhoTakesOver) {
  const std::string older = ReadFile(List(), 1 << 20).value();
  EXPECT_TRUE(watch_.CheckMayBeRead()) << "nothing changed";
  Revoke(5);
  EXPECT_TRUE(watch_.CheckMayBeRead()) << "a newer one may";
  ASSERT_TRUE(LooksNow());
  watch_.TakenUp();
  const std::string newer = ReadFile(List(), 1 << 20).value();
  std::ofstream(List(), std::ios::binary) << older;
  const Status refused = watch_.CheckMayBeRead();
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().what.find(", before the list in force, of "), std::string::npos) << refused.error().what;
  std::ofstream(List(), std::ios::binary) << newer;
  EXPECT_TRUE(watch_.CheckMayBeRead());
}

}  // namespace
}  // namespace rigcal
