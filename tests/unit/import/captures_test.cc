#include "client/import/captures.h"

#include <gtest/gtest.h>

namespace rigcal::importing {
namespace {

constexpr std::int64_t kMs = 1'000'000;

std::size_t Sum(const SensorUse& use) { return use.used + use.without_partner + use.repeated_stamp + use.thinned_out; }

TEST(Captures, TheNearestWithinTheToleranceAreOne) {
  const CapturePlan plan =
      PlanCaptures({{{0, 100 * kMs, 200 * kMs}}, {{3 * kMs, 99 * kMs, 101 * kMs, 206 * kMs}}}, 5 * kMs, 0);
  ASSERT_EQ(plan.captures.size(), 2U);
  EXPECT_EQ(plan.captures[0].message[1], 0U);
  EXPECT_EQ(plan.captures[1].message[1], 1U);  // of two as near the earlier
  EXPECT_EQ(plan.captures[1].stamp_ns, 100 * kMs);
  EXPECT_EQ(plan.uses[0].without_partner, 1U);
  EXPECT_EQ(plan.uses[1].without_partner, 2U);
}

TEST(Captures, OneMessageIsInOneCapture) {
  // Both of the fast one are within reach of the slow one's; only the nearer is taken.
  const CapturePlan plan = PlanCaptures({{{0, 4 * kMs, 8 * kMs}}, {{5 * kMs}}}, 5 * kMs, 0);
  ASSERT_EQ(plan.captures.size(), 1U);
  EXPECT_EQ(plan.captures[0].message[0], 1U);
}

TEST(Captures, TwoSensorsMatchWhereTheThirdIsSilent) {
  const CapturePlan plan = PlanCaptures({{{0, 100 * kMs}}, {{0, 100 * kMs}}, {{0}}}, kMs, 0);
  ASSERT_EQ(plan.captures.size(), 2U);
  EXPECT_FALSE(plan.captures[1].message[2]);
  EXPECT_TRUE(plan.captures[1].message[0] && plan.captures[1].message[1]);
}

TEST(Captures, ATrackerMakesNoneAndServesMany) {
  const CapturePlan plan = PlanCaptures({{{0, 2 * kMs, 50 * kMs}}, {{kMs, 90 * kMs}, false}}, 5 * kMs, 0);
  ASSERT_EQ(plan.captures.size(), 3U);  // one sensor alone: each of its messages
  EXPECT_EQ(plan.captures[0].message[1], 0U);
  EXPECT_EQ(plan.captures[1].message[1], 0U);
  EXPECT_FALSE(plan.captures[2].message[1]);
}

TEST(Captures, RepeatedStampsAndThinnedCapturesAreCounted) {
  const CapturePlan plan = PlanCaptures({{{0, 0, 100 * kMs, 200 * kMs, 300 * kMs}}}, kMs, 150 * kMs);
  ASSERT_EQ(plan.captures.size(), 2U);
  EXPECT_EQ(plan.uses[0].repeated_stamp, 1U);
  EXPECT_EQ(plan.uses[0].thinned_out, 2U);
  EXPECT_EQ(Sum(plan.uses[0]), 5U);
}

TEST(Captures, NamesSortAsStampsAndEveryOneIsAccountedFor) {
  std::vector<SensorStamps> sensors(3);
  for (std::int64_t k = 0; k < 200; ++k) {
    sensors[0].stamps_ns.push_back(1'700'000'000'000'000'000 + k * 33 * kMs);
    sensors[1].stamps_ns.push_back(1'700'000'000'000'000'000 + k * 40 * kMs + k % 7 * kMs);
    if (k % 3 == 0) sensors[2].stamps_ns.push_back(1'700'000'000'000'000'000 + k * 33 * kMs - 2 * kMs);
  }
  const CapturePlan plan = PlanCaptures(sensors, 5 * kMs, 0);
  for (std::size_t i = 1; i < plan.captures.size(); ++i) EXPECT_LT(plan.captures[i - 1].name, plan.captures[i].name);
  for (std::size_t s = 0; s < 3; ++s) EXPECT_EQ(Sum(plan.uses[s]), sensors[s].stamps_ns.size());
  for (const PlannedCapture& capture : plan.captures)
    for (std::size_t s = 0; s < 3; ++s) {
      if (!capture.message[s]) continue;
      EXPECT_LE(std::abs(sensors[s].stamps_ns[*capture.message[s]] - capture.stamp_ns), 5 * kMs);
    }
}

TEST(Captures, StampsOfEveryKindHaveNames) {
  const CapturePlan plan = PlanCaptures({{{INT64_MIN, -1, 0, INT64_MAX}}}, 0, 0);
  ASSERT_EQ(plan.captures.size(), 4U);
  EXPECT_EQ(plan.captures[1].name, "m1-999999999");
  EXPECT_EQ(plan.captures[2].name, "0-000000000");
}

}  // namespace
}  // namespace rigcal::importing
