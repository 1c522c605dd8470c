#include "client/moments/clock_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "client/sim/rig/random.h"

namespace rigcal::moments {
namespace {

constexpr double kDuration_s = 60;
const Eigen::Vector3d kCentre_m(0.2, 0.15, 0);

// A board that swings before the reference; about every third second it is held.
Se3 T_reference_board(double t_s) {
  const double whole = std::floor(t_s / 3), part = t_s / 3 - whole;
  const double ramp = part < 0.3 ? 0 : (part - 0.3) / 0.7;
  const double phase = whole + ramp * ramp * (3 - 2 * ramp);
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = (i < 3 ? 0.15 : 0.3) * std::sin((0.9 + 0.17 * i) * phase + i);
  Se3 T;
  T.p_m = {-0.2, -0.1, 1.5};
  return T * Se3::Exp(xi);
}

struct TrackOptions {
  double rate_hz = 30, offset_s = 0, drift_ratio = 0, noise_m = 2e-4, noise_rad = 5e-4;
  Se3 T_sensor_reference = {};
  bool moves = true;
};

std::vector<TimedPose> Track(const TrackOptions& options, std::uint64_t key) {
  sim::Random random(key);
  std::vector<TimedPose> track;
  for (double t_s = random.Uniform() / options.rate_hz; t_s < kDuration_s; t_s += 1 / options.rate_hz) {
    Vector6d noise;
    noise << options.noise_m * random.Normals<3>(), options.noise_rad * random.Normals<3>();
    const Se3 T = options.T_sensor_reference * T_reference_board(options.moves ? t_s : 0.0);
    track.push_back({t_s + options.offset_s + options.drift_ratio * t_s, T * Se3::Exp(noise)});
  }
  return track;
}

Se3 Beside() {
  Vector6d xi;
  xi << 0.4, 0.05, 0.1, 0.1, -0.3, 0.05;
  return Se3::Exp(xi);
}

TEST(ClockFit, OffsetAndDriftAreFoundWithinTheirSigmas) {
  double squares = 0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    sim::Random random(sim::KeyOf(seed, "clock"));
    const double offset_s = random.Uniform(-0.04, 0.04), drift = random.Uniform(-2e-5, 2e-5);
    const auto fit =
        FitClock(Track({}, 2 * seed), Track({10, offset_s, drift, 2e-4, 5e-4, Beside()}, 2 * seed + 1), kCentre_m);
    ASSERT_TRUE(fit) << seed;
    for (const double t_s : {0.0, kDuration_s}) {
      const double error_s = fit->OffsetAt_s(t_s) - offset_s - drift * t_s;
      EXPECT_LT(std::abs(error_s), 5e-4) << seed;
      squares += std::pow(error_s / fit->SigmaAt_s(t_s), 2), ++count;
    }
  }
  EXPECT_LT(squares / count, 2.0);
  EXPECT_GT(squares / count, 0.3);
}

TEST(ClockFit, AQuarterOfASecondIsFoundToo) {
  const auto fit = FitClock(Track({15}, 1), Track({30, 0.25, 0, 2e-4, 5e-4, Beside()}, 2), kCentre_m);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->offset_s, 0.25, 5e-4);
}

TEST(ClockFit, WhatStandsStillTellsNoTime) {
  EXPECT_FALSE(FitClock(Track({30, 0, 0, 2e-4, 5e-4, {}, false}, 1),
                        Track({10, 0.02, 0, 2e-4, 5e-4, Beside(), false}, 2), kCentre_m));
}

TEST(ClockFit, TwoMotionsThatHaveNothingInCommonTellNone) {
  std::vector<TimedPose> backwards = Track({10, 0, 0, 2e-4, 5e-4, Beside()}, 2);
  for (std::size_t i = 0; i < backwards.size() / 2; ++i)
    std::swap(backwards[i].T_cam_board, backwards[backwards.size() - 1 - i].T_cam_board);
  const auto fit = FitClock(Track({}, 1), backwards, kCentre_m);
  EXPECT_TRUE(!fit || fit->offset_sigma_s > 0.01) << fit->offset_s << " +- " << fit->offset_sigma_s;
}

TEST(ClockFit, TooFewPosesTellNone) { EXPECT_FALSE(FitClock(Track({}, 1), {}, kCentre_m)); }

}  // namespace
}  // namespace rigcal::moments
