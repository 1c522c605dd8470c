#include "client/record/arrivals.h"

#include <gtest/gtest.h>

namespace rigcal::recording {
namespace {

constexpr std::int64_t kMs = 1'000'000, kS = 1'000'000'000;

TEST(Arrivals, RatesAndGapsAreOfWhatCame) {
  Arrivals arrivals;
  EXPECT_FALSE(arrivals.Rate_hz());
  EXPECT_FALSE(arrivals.SinceLast_ns(5 * kS));
  for (const std::int64_t at_ms : {1000, 1100, 1200, 1900, 2000}) arrivals.Add(at_ms * kMs, 10, 1, 0);
  EXPECT_EQ(arrivals.messages(), 5);
  EXPECT_EQ(arrivals.bytes(), 50);
  EXPECT_DOUBLE_EQ(*arrivals.Rate_hz(), 4.0);
  EXPECT_EQ(arrivals.LongestGap_ns(), 700 * kMs);
  EXPECT_EQ(arrivals.SinceLast_ns(2500 * kMs), 500 * kMs);
}

TEST(Arrivals, OfLateCountsFromTheWindowOn) {
  Arrivals arrivals;
  for (int k = 0; k < 10; ++k) arrivals.Add(k * 100 * kMs, 1, 1, 0);
  EXPECT_FALSE(arrivals.RecentRate_hz(kS));
  arrivals.BeginWindow(kS);
  EXPECT_FALSE(arrivals.RecentRate_hz(kS));
  EXPECT_DOUBLE_EQ(*arrivals.RecentRate_hz(2 * kS), 0.0);
  arrivals.Add(2 * kS, 1, 1, 0);
  EXPECT_DOUBLE_EQ(*arrivals.RecentRate_hz(3 * kS), 0.5);
}

TEST(Arrivals, GapsInAPublishersNumbersAreLostMessages) {
  Arrivals arrivals;
  for (const std::int64_t sequence : {7, 8, 11, 12}) arrivals.Add(sequence, 1, 1, sequence);
  EXPECT_EQ(arrivals.missed(), 2) << "9 and 10; what was before the first is not known";
  for (const std::int64_t sequence : {1, 2, 4}) arrivals.Add(sequence, 1, 2, sequence);
  EXPECT_EQ(arrivals.missed(), 3) << "each publisher counts by itself";
  arrivals.Add(5, 1, 3, 0);
  arrivals.Add(6, 1, 1, 12);
  EXPECT_EQ(arrivals.missed(), 3) << "a number that is not known, and one that comes twice, say nothing";
}

TEST(Arrivals, StalledByWhatWasUsual) {
  Arrivals fast, slow, few;
  for (int k = 0; k < 20; ++k) fast.Add(k * 100 * kMs, 1, 1, 0);
  for (int k = 0; k < 20; ++k) slow.Add(k * 10 * kS, 1, 1, 0);
  few.Add(0, 1, 1, 0);
  EXPECT_FALSE(fast.IsStalled(1900 * kMs + 1900 * kMs));
  EXPECT_TRUE(fast.IsStalled(1900 * kMs + 2100 * kMs));
  EXPECT_FALSE(slow.IsStalled(190 * kS + 49 * kS)) << "one in ten seconds is late after fifty";
  EXPECT_TRUE(slow.IsStalled(190 * kS + 51 * kS));
  EXPECT_FALSE(few.IsStalled(1000 * kS)) << "how often it comes is not known";
}

}  // namespace
}  // namespace rigcal::recording
