#include "client/import/stream_kind.h"

#include <gtest/gtest.h>

namespace rigcal::importing {
namespace {

constexpr std::int64_t kMs = 1'000'000, kTolerance_ns = 5 * kMs;

SensorStamps Every(std::int64_t period_ms, std::int64_t offset_ms, std::int64_t count = 60) {
  SensorStamps stamps;
  for (std::int64_t k = 0; k < count; ++k) stamps.stamps_ns.push_back((k * period_ms + offset_ms) * kMs);
  return stamps;
}

TEST(StreamKind, SensorsThatAreTriggeredTogetherAreTakenAsTheyAre) {
  EXPECT_FALSE(RunsFreely({Every(100, 0), Every(100, 2)}, {Every(200, -1)}, kTolerance_ns));
  SensorStamps misses = Every(100, 1);
  misses.stamps_ns.erase(misses.stamps_ns.begin() + 20, misses.stamps_ns.begin() + 28);
  EXPECT_FALSE(RunsFreely({Every(100, 0), misses}, {}, kTolerance_ns));
}

TEST(StreamKind, AListOfStillsIsTakenAsItIs) {
  EXPECT_FALSE(RunsFreely({Every(2000, 0), Every(2000, 40)}, {}, kTolerance_ns));
  EXPECT_FALSE(RunsFreely({Every(10'000, 0, 8), Every(3000, 1, 20)}, {}, kTolerance_ns));
  EXPECT_FALSE(RunsFreely({Every(50, 0, 10), Every(100, 0, 10)}, {}, kTolerance_ns));  // too few to be a stream
}

TEST(StreamKind, CamerasOfDifferentRatesOrWithoutPartnersRunFreely) {
  EXPECT_TRUE(RunsFreely({Every(33, 0), Every(67, 3), Every(100, 7)}, {}, kTolerance_ns));
  EXPECT_TRUE(RunsFreely({Every(100, 0), Every(100, 27)}, {}, kTolerance_ns));
  EXPECT_TRUE(RunsFreely({Every(33, 0)}, {Every(101, 12)}, kTolerance_ns));
}

TEST(StreamKind, OneCameraAloneAndNoCamera) {
  EXPECT_FALSE(RunsFreely({Every(33, 0)}, {}, kTolerance_ns));
  EXPECT_FALSE(RunsFreely({}, {Every(100, 0), Every(100, 40)}, kTolerance_ns));
}

TEST(StreamKind, ThePeriodIsTheMiddleOne) {
  EXPECT_EQ(Period_ns({0, 100, 200, 900, 1000}), 100);
  EXPECT_FALSE(Period_ns({0, 100}));
}

}  // namespace
}  // namespace rigcal::importing
