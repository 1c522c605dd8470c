// How a body moved about one instant, against differences of the path itself.
#include "server/calib/motion/local_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace rigcal::calib {
namespace {

constexpr std::int64_t kInstant_ns = 1'700'000'000'000'000'000;
const Stamp kInstant{kInstant_ns};

using PathAt = std::function<Se3(double)>;

PoseTable Rows(const PathAt& at, double step_s, double from_s = -0.4, double until_s = 0.4) {
  PoseTable rows;
  for (double t_s = from_s; t_s <= until_s; t_s += step_s)
    rows.push_back({{}, Stamp{kInstant_ns + std::llround(t_s * 1e9)}, at(t_s)});
  return rows;
}

const Se3 kTold = Se3::Exp((Vector6d() << 1, 2, 0.5, 0.3, -0.4, 2.0).finished());
const Vector6d kTwist = (Vector6d() << 0.3, -0.2, 0.1, 0.5, 0.2, -0.7).finished();

Se3 Steady(double t_s) { return kTold * Se3::Exp(t_s * kTwist); }
// Turns and swings about axes that do not stay.
Se3 Curved(double t_s) {
  Vector6d swing;
  swing << 0.04 * std::sin(4 * t_s), 0.03 * (1 - std::cos(5 * t_s)), 0.0, 0.0, 0.05 * std::sin(6 * t_s), 0.0;
  return kTold * Se3::Exp(t_s * kTwist) * Se3::Exp(swing);
}

Vector6d Difference(const PathAt& at, double t_s) {
  constexpr double kStep_s = 1e-5;
  return (at(t_s - kStep_s).Inverse() * at(t_s + kStep_s)).Log() / (2 * kStep_s);
}

TEST(LocalPath, StandsStillByDefault) {
  EXPECT_EQ(LocalPath{}.StepTo(0.1), Se3{});
  EXPECT_TRUE(LocalPath{}.TwistAt(0.1).isZero(0));
}

TEST(LocalPath, OfASteadyMotionIsThatMotion) {
  for (const double step_s : {0.07, 0.05, 0.01}) {
    const auto fit = FitLocalPath(Rows(Steady, step_s), kInstant, kTold);
    ASSERT_TRUE(fit) << step_s;
    for (const double t_s : {-0.3, -0.1, 0.0, 0.02, 0.3}) {
      EXPECT_LT((fit->path.TwistAt(t_s) - kTwist).norm(), 1e-6) << t_s;
      EXPECT_LT((Steady(t_s).Inverse() * kTold * fit->path.StepTo(t_s)).Log().norm(), 1e-7) << t_s;
    }
    EXPECT_LT(fit->squares.maxCoeff(), 1e-12);
  }
}

TEST(LocalPath, FollowsABend) {
  const auto fit = FitLocalPath(Rows(Curved, 0.01), kInstant, kTold);
  ASSERT_TRUE(fit);
  for (const double t_s : {-0.05, 0.0, 0.05})
    EXPECT_LT((fit->path.TwistAt(t_s) - Difference(Curved, t_s)).norm(), 0.005) << t_s;
}

TEST(LocalPath, TheTwistIsTheDerivativeOfTheStepAlsoBeyondTheSpan) {
  const auto fit = FitLocalPath(Rows(Curved, 0.01), kInstant, kTold);
  ASSERT_TRUE(fit);
  for (const double t_s : {-0.3, -0.12, 0.0, 0.07, 0.2}) {
    const auto step_to = [&](double at_s) { return fit->path.StepTo(at_s); };
    EXPECT_LT((fit->path.TwistAt(t_s) - Difference(step_to, t_s)).norm(), 1e-6) << t_s;
  }
}

TEST(LocalPath, GoesThroughThePoseThatIsToldForTheInstant) {
  Vector6d noise;
  noise << 1e-3, -1e-3, 2e-3, 1e-3, 2e-3, -1e-3;
  const Se3 told = kTold * Se3::Exp(noise);
  const auto fit = FitLocalPath(Rows(Curved, 0.01), kInstant, told);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->path.StepTo(0.0), Se3{});
  const auto about_later = FitLocalPath(Rows(Curved, 0.01), kInstant, told, 0.1);
  ASSERT_TRUE(about_later);
  EXPECT_LT((fit->path.StepTo(0.1).Inverse() * about_later->path.StepTo(0.1)).Log().norm(), 1e-3);
}

TEST(LocalPath, ItsVelocityScattersAsItSays) {
  const auto fit = FitLocalPath(Rows(Curved, 0.01), kInstant, kTold);
  ASSERT_TRUE(fit);
  // Shifts of single rows, one after the other: the sum of squares of what they do is the gain.
  PoseTable rows = Rows(Curved, 0.01);
  double gain_per_s2 = 0;
  for (TimedPose& row : rows) {
    const Se3 was = row.T_world_body;
    row.T_world_body = kTold * Se3{Eigen::Vector3d(1e-6, 0, 0), Eigen::Quaterniond::Identity()} * kTold.Inverse() * was;
    gain_per_s2 +=
        std::pow((FitLocalPath(rows, kInstant, kTold)->path.TwistAt(0) - fit->path.TwistAt(0)).norm() / 1e-6, 2);
    row.T_world_body = was;
  }
  EXPECT_NEAR(gain_per_s2, fit->velocity_gain_per_s2, 0.05 * fit->velocity_gain_per_s2);
}

TEST(LocalPath, IsNotKnownOfFewRowsOneSideOrAGap) {
  EXPECT_FALSE(FitLocalPath({}, kInstant, kTold));
  EXPECT_FALSE(FitLocalPath(Rows(Steady, 0.12), kInstant, kTold));
  EXPECT_FALSE(FitLocalPath(Rows(Steady, 0.01, 0.001), kInstant, kTold));
  EXPECT_FALSE(FitLocalPath(Rows(Steady, 0.01, -0.4, -0.001), kInstant, kTold));
  PoseTable gap = Rows(Steady, 0.01);
  std::erase_if(gap, [](const TimedPose& row) { return std::abs(row.stamp.ns - kInstant_ns) < 90'000'000; });
  EXPECT_FALSE(FitLocalPath(gap, kInstant, kTold));
  EXPECT_FALSE(FitLocalPath(Rows(Steady, 0.01), Stamp{kInstant_ns + 60'000'000'000}, kTold));
}

}  // namespace
}  // namespace rigcal::calib
