// What was no good once is looked at again.
#include "server/identity_watch.h"

#include <gtest/gtest.h>

#include "client/identity/authority.h"
#include "tests/unit/temp_folder.h"

namespace rigcal {
namespace {

namespace fs = std::filesystem;

class IdentityWatchTest : public testing::Test {
 protected:
  void Revoke() {
    const Stamp now = SystemClock().Now();
    ASSERT_TRUE(authority_.Issue(IdentityHolder::kRobot, "a", now, {now.ns + 3'600'000'000'000}, true));
    ASSERT_TRUE(authority_.Revoke(IdentityHolder::kRobot, "a", now));
  }
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

}  // namespace
}  // namespace rigcal
