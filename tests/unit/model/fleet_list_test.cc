#include "server/model/robots/fleet_list.h"

#include <gtest/gtest.h>

#include "tests/unit/model/values.h"

namespace rigcal {
namespace {

TEST(NextMonday, IsTheFirstMomentOfTheFollowingWeek) {
  EXPECT_EQ(NextMonday(At("2026-02-01T12:00:00Z")), At("2026-02-02T00:00:00Z"));  // a Sunday
  EXPECT_EQ(NextMonday(At("2026-02-01T23:59:59.999999999Z")), At("2026-02-02T00:00:00Z"));
  EXPECT_EQ(NextMonday(At("2026-02-02T00:00:00Z")), At("2026-02-09T00:00:00Z"));
  EXPECT_EQ(NextMonday(At("2026-02-04T07:30:00Z")), At("2026-02-09T00:00:00Z"));
}

TEST(NextMonday, HoldsAroundTheFirstOfAllDays) {
  EXPECT_EQ(NextMonday(Stamp{0}), At("1970-01-05T00:00:00Z"));
  EXPECT_EQ(NextMonday(Stamp{-1}), At("1970-01-05T00:00:00Z"));
  EXPECT_EQ(NextMonday(Stamp{-4 * (kWeek_ns / 7)}), Stamp{-3 * (kWeek_ns / 7)});  // a Sunday
}

}  // namespace
}  // namespace rigcal
