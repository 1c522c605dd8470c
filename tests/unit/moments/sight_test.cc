#include "client/moments/sight.h"

#include <gtest/gtest.h>

namespace rigcal::moments {
namespace {

Sight SightOf(const std::vector<int>& corners, float shift_px) {
  Sight sight;
  sight.target_idx = 0;
  sight.m_per_px = 0.002;
  sight.corner_idx = corners;
  for (const int idx : corners) sight.corners_px.emplace_back(10.0F * static_cast<float>(idx) + shift_px, 5.0F);
  return sight;
}

TEST(Sight, TheShiftIsThatOfTheCornersThatBothShow) {
  const auto shift = ShiftBetween(SightOf({0, 1, 2, 5, 7}, 0), SightOf({1, 2, 3, 5, 6, 7}, 3));
  ASSERT_TRUE(shift);
  EXPECT_NEAR(shift->px, 3.0, 1e-6);
  EXPECT_NEAR(shift->m, 0.006, 1e-8);
}

TEST(Sight, WithoutCommonCornersOrOnAnotherBoardThereIsNone) {
  EXPECT_FALSE(ShiftBetween(SightOf({0, 1, 2}, 0), SightOf({3, 4, 5}, 0)));
  Sight other = SightOf({0, 1, 2}, 0);
  other.target_idx = 1;
  EXPECT_FALSE(ShiftBetween(SightOf({0, 1, 2}, 0), other));
  EXPECT_FALSE(ShiftBetween(Sight{}, Sight{}));
}

}  // namespace
}  // namespace rigcal::moments
