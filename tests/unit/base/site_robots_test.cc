// Of which robots a site is.
#include "server/base/site_robots.h"

#include <gtest/gtest.h>

namespace rigcal {
namespace {

TEST(RobotNames, AreWholeOrBeginnings) {
  EXPECT_TRUE(IsAmongRobots("mapper-*,bench", "mapper-01"));
  EXPECT_TRUE(IsAmongRobots("mapper-*,bench", "bench"));
  EXPECT_TRUE(IsAmongRobots("*", "any"));
  for (const char* other : {"bench-2", "benc", "amapper-01", "mapper", ""})
    EXPECT_FALSE(IsAmongRobots("mapper-*,bench", other)) << other;
  EXPECT_FALSE(IsAmongRobots("", "mapper-01"));
}

TEST(RobotNames, AreChecked) {
  for (const char* good : {"*", "mapper-*", "a,b,c-*"}) EXPECT_TRUE(CheckRobotNames(good)) << good;
  for (const char* bad : {"", "a b", "a,,b", "*a", "a**", "a, b"}) EXPECT_FALSE(CheckRobotNames(bad)) << bad;
}

}  // namespace
}  // namespace rigcal
