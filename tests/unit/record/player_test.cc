#include "client/record/player.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace rigcal::recording {
namespace {

TEST(DueAfter, IsTheBagsPaceTimesTheRate) {
  EXPECT_EQ(DueAfter(1'700'000'000'000'000'000, 1'700'000'002'000'000'000, 0.5).count(), 4'000'000'000);
  EXPECT_EQ(DueAfter(5, 3, 1).count(), 0) << "before the first";
}

TEST(DueAfter, HoldsForAnyStamps) {
  const std::int64_t most_ns = DueAfter(INT64_MIN, INT64_MAX, 0.001).count();
  EXPECT_GT(most_ns, 3'000'000'000'000'000'000);
  EXPECT_EQ(DueAfter(0, 1'700'000'000'000'000'000, 0.001).count(), most_ns);
}

}  // namespace
}  // namespace rigcal::recording
