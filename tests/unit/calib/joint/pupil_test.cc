// Lenses whose rays do not meet in one point: the entrance pupil of the virtual camera, projected by OpenCV.
#include <gmock/gmock.h>

#include "tests/unit/calib/joint/visit.h"

namespace rigcal::calib::joint {
namespace {

constexpr double kShift_m = 0.001;

sim::Options WithShift(std::uint64_t seed, double shift_m) {
  sim::Options options = WithSeed(seed);
  options.disturb.pupil_shift_m = shift_m;
  return options;
}

TEST(JointPupil, ThatMovesIsTakenOutAndTold) {
  const FeatureSession session = Visit(WithShift(21, kShift_m));
  const SessionEstimate estimate = EstimateFrom(session);
  EXPECT_LT(WorstT2(session, estimate), 40.0);  // 6 are expected
  ASSERT_FALSE(estimate.pupil_shifts.empty());
  for (const PupilShift& shift : estimate.pupil_shifts)
    EXPECT_NEAR(shift.shift_m, kShift_m, 4 * shift.sigma_m) << shift.camera.str();
}

TEST(JointPupil, IsNotToldWhereItStays) {
  for (const std::uint64_t seed : {22, 23})
    EXPECT_THAT(EstimateFrom(Visit(WithShift(seed, 0.0))).pupil_shifts, testing::IsEmpty()) << "seed " << seed;
}

}  // namespace
}  // namespace rigcal::calib::joint
