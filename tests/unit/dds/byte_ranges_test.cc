#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "server/dds/record/part_file.h"

namespace rigcal::dds {

void PrintTo(const ByteRange& range, std::ostream* out) { *out << "[" << range.begin << ", " << range.end << ")"; }

namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(ByteRanges, GivesWhatIsNew) {
  ByteRanges ranges;
  EXPECT_THAT(ranges.Add({10, 20}), ElementsAre(ByteRange{10, 20}));
  EXPECT_THAT(ranges.Add({10, 20}), IsEmpty());
  EXPECT_THAT(ranges.Add({12, 15}), IsEmpty());
  EXPECT_THAT(ranges.Add({30, 40}), ElementsAre(ByteRange{30, 40}));
  EXPECT_THAT(ranges.Add({5, 45}), ElementsAre(ByteRange{5, 10}, ByteRange{20, 30}, ByteRange{40, 45}));
  EXPECT_EQ(ranges.pieces(), 1u);
  EXPECT_FALSE(ranges.CoversUpTo(45));
  EXPECT_THAT(ranges.Add({0, 5}), ElementsAre(ByteRange{0, 5}));
  EXPECT_TRUE(ranges.CoversUpTo(45));
  EXPECT_FALSE(ranges.CoversUpTo(46));
  EXPECT_THAT(ranges.Add({7, 7}), IsEmpty());
}

// Against a byte map.
TEST(ByteRanges, AgreesWithAByteMap) {
  std::mt19937 random(5);
  for (int round = 0; round < 200; ++round) {
    ByteRanges ranges;
    std::vector<bool> map(64, false);
    for (int step = 0; step < 20; ++step) {
      const std::uint64_t a = random() % 64, b = random() % 65;
      std::vector<bool> fresh(64, false);
      for (const ByteRange& range : ranges.Add({std::min(a, b), std::max(a, b)}))
        for (std::uint64_t i = range.begin; i < range.end; ++i) fresh[i] = true;
      for (std::uint64_t i = 0; i < 64; ++i) {
        const bool inside = i >= std::min(a, b) && i < std::max(a, b);
        ASSERT_EQ(fresh[i], inside && !map[i]);
        if (inside) map[i] = true;
      }
    }
    const auto first_gap = static_cast<std::uint64_t>(std::find(map.begin(), map.end(), false) - map.begin());
    EXPECT_TRUE(ranges.CoversUpTo(first_gap));
    EXPECT_FALSE(ranges.CoversUpTo(first_gap + 1));
  }
}

}  // namespace
}  // namespace rigcal::dds
