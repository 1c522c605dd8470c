// Which of a robot's calibrations led to the one that it has.
#include "server/model/robots/calibration_series.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigcal {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

CalibrationPoint PointAt(std::int64_t ns, double sigmas) { return {Stamp{ns}, sigmas}; }

TEST(CalibrationSeries, OfRevisionsOfOneCalibrationTheNewestTells) {
  EXPECT_THAT(CalibrationsOf({}), IsEmpty());
  EXPECT_THAT(
      CalibrationsOf({PointAt(30, 3.5), PointAt(30, 3.0), PointAt(20, 2.0), PointAt(10, 1.5), PointAt(10, 1.0)}),
      ElementsAre(PointAt(10, 1.5), PointAt(20, 2.0), PointAt(30, 3.5)));
}

// The newest revision is made of what was measured at 20: what another had counted since was retired.
TEST(CalibrationSeries, WhatWasTakenBackIsNoPartOfIt) {
  EXPECT_THAT(CalibrationsOf({PointAt(20, 2.5), PointAt(30, 3.0), PointAt(20, 2.0), PointAt(10, 1.0)}),
              ElementsAre(PointAt(10, 1.0), PointAt(20, 2.5)));
}

TEST(CalibrationSeries, IsBounded) {
  std::vector<CalibrationPoint> newest_first;
  for (std::int64_t at = 100; at > 0; --at) newest_first.push_back(PointAt(at, 1.0));
  const std::vector<CalibrationPoint> points = CalibrationsOf(newest_first);
  ASSERT_EQ(points.size(), kCalibrationsListedMax);
  EXPECT_EQ(points.back().calibrated_at, Stamp{100});
  EXPECT_EQ(points.front().calibrated_at, Stamp{75});
}

}  // namespace
}  // namespace rigcal
