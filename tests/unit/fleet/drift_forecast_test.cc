// The date by which a sensor may have drifted by its tolerance, over fleets that are drawn by laws of our own: at that
// date so many are beyond as was said.
#include "server/fleet/status/drift_forecast.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rigcal::fleet {
namespace {

constexpr PoseLimit kTolerance = {0.005, 0.005};
constexpr double kNoTurn = 1e-5;  // rad
const RobotId kThis("robot-0");

class Draw {
 public:
  explicit Draw(unsigned seed) : engine_(seed) {}
  double Normal(double sigma) { return sigma * normal_(engine_); }
  double Days(double least, double most) { return least + (most - least) * uniform_(engine_); }
  Vector6d Shift(double sigma_m) {
    Vector6d shift = Vector6d::Zero();
    for (int axis = 0; axis < 3; ++axis) shift(axis) = Normal(sigma_m), shift(axis + 3) = Normal(kNoTurn);
    return shift;
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
};

Vector6d Sigma(double sigma_m) {
  Vector6d sigma = Vector6d::Constant(kNoTurn);
  sigma.head<3>().setConstant(sigma_m);
  return sigma;
}

RobotId Named(int robot) { return RobotId("robot-" + std::to_string(robot)); }

struct DrawnFleet {
  std::vector<DriftStep> steps;
  Vector6d own_rate_m = Vector6d::Zero();  // of kThis, per day; of a linear fleet
};

DrawnFleet Walking(Draw& draw, int robots, int visits, double m_per_root_day, double noise_m) {
  DrawnFleet fleet;
  for (int robot = 0; robot < robots; ++robot)
    for (int visit = 0; visit < visits; ++visit) {
      const double days = draw.Days(3, 40);
      Vector6d change = draw.Shift(m_per_root_day * std::sqrt(days)) + draw.Shift(noise_m);
      fleet.steps.push_back({Named(robot), days, change, Sigma(noise_m)});
    }
  return fleet;
}

DrawnFleet Creeping(Draw& draw, int robots, int visits, double m_per_day, double noise_m) {
  DrawnFleet fleet;
  for (int robot = 0; robot < robots; ++robot) {
    Vector6d rate = Vector6d::Zero();
    for (int axis = 0; axis < 3; ++axis) rate(axis) = draw.Normal(m_per_day);
    if (robot == 0) fleet.own_rate_m = rate;
    for (int visit = 0; visit < visits; ++visit) {
      const double days = draw.Days(3, 40);
      fleet.steps.push_back({Named(robot), days, days * rate + draw.Shift(noise_m), Sigma(noise_m)});
    }
  }
  return fleet;
}

TEST(DriftForecast, ProbabilityOfABallIsThatOfDrawnPoints) {
  Draw draw(1);
  for (const double distance : {0.0, 1e-7, 0.3, 1.0, 2.5})
    for (const double radius : {0.4, 1.3, 3.0}) {
      constexpr int kPoints = 100'000;
      int beyond = 0;
      for (int i = 0; i < kPoints; ++i) {
        const Eigen::Vector3d x(distance + draw.Normal(0.8), draw.Normal(0.8), draw.Normal(0.8));
        beyond += x.norm() > radius ? 1 : 0;
      }
      EXPECT_NEAR(BeyondBall(distance, 0.8, radius), beyond / double{kPoints}, 0.0085) << distance << " " << radius;
    }
  EXPECT_EQ(BeyondBall(2.0, 0.0, 1.0), 1.0);
  EXPECT_EQ(BeyondBall(0.5, 0.0, 1.0), 0.0);
}

TEST(DriftForecast, OfFleetsThatWalkFivePercentAreBeyondAtTheDate) {
  Draw draw(2);
  int dated = 0, walks = 0, beyond = 0;
  constexpr int kFleets = 300, kFutures = 40;
  for (int fleet = 0; fleet < kFleets; ++fleet) {
    const double m_per_root_day = 2.5e-4;
    const auto steps = Walking(draw, 12, 4, m_per_root_day, 3e-4).steps;
    const auto forecast = ForecastDrift(steps, kThis, kTolerance, 3000);
    if (!forecast) continue;
    ++dated;
    walks += forecast->law == DriftLaw::kRandomWalk ? 1 : 0;
    for (int future = 0; future < kFutures; ++future)
      beyond += draw.Shift(m_per_root_day * std::sqrt(forecast->days)).head<3>().norm() > kTolerance.m ? 1 : 0;
    EXPECT_EQ(forecast->visits, 48);
    EXPECT_EQ(forecast->robots, 12);
  }
  EXPECT_EQ(dated, kFleets);
  EXPECT_GT(walks, kFleets * 95 / 100);
  EXPECT_NEAR(beyond / double{kFleets * kFutures}, kForecastOdds, 0.025);
}

TEST(DriftForecast, OfFleetsThatCreepFivePercentAreBeyondAtTheDate) {
  Draw draw(3);
  int dated = 0, lines = 0, beyond = 0;
  constexpr int kFleets = 2000;
  for (int fleet = 0; fleet < kFleets; ++fleet) {
    const DrawnFleet drawn = Creeping(draw, 12, 3, 6e-5, 3e-4);
    const auto forecast = ForecastDrift(drawn.steps, kThis, kTolerance, 3000);
    if (!forecast) continue;
    ++dated;
    lines += forecast->law == DriftLaw::kLinear ? 1 : 0;
    beyond += (forecast->days * drawn.own_rate_m.head<3>()).norm() > kTolerance.m ? 1 : 0;
  }
  EXPECT_GT(dated, kFleets * 9 / 10);
  EXPECT_GT(lines, dated * 9 / 10);
  EXPECT_NEAR(beyond / double{kFleets}, kForecastOdds, 0.025);
}

TEST(DriftForecast, WithFewVisitsItIsEarlierAndStillHolds) {
  Draw draw(4);
  double few_days = 0.0, many_days = 0.0;
  int beyond = 0;
  constexpr int kFleets = 1000;
  for (int fleet = 0; fleet < kFleets; ++fleet) {
    const double m_per_root_day = 2.5e-4;
    const auto few = ForecastDrift(Walking(draw, 3, 1, m_per_root_day, 2e-4).steps, kThis, kTolerance, 3000);
    if (!few) continue;
    few_days += few->days;
    beyond += draw.Shift(m_per_root_day * std::sqrt(few->days)).head<3>().norm() > kTolerance.m ? 1 : 0;
    if (fleet % 20 != 0) continue;
    many_days += 20 * ForecastDrift(Walking(draw, 20, 5, m_per_root_day, 2e-4).steps, kThis, kTolerance, 3000)->days;
  }
  EXPECT_LT(few_days, many_days);
  EXPECT_LT(beyond / double{kFleets}, 0.075);
}

// One visit each after 20 to 40 days tells a walk hardly from a rate that stays, and the tolerance is used up before
// that: by the wrong law alone 14 % would be beyond.
TEST(DriftForecast, WhereNothingTellsTheLawItHoldsByBoth) {
  Draw draw(8);
  int beyond = 0;
  constexpr int kFleets = 300, kFutures = 20;
  for (int fleet = 0; fleet < kFleets; ++fleet) {
    const double m_per_root_day = 5e-4;
    std::vector<DriftStep> steps;
    for (int robot = 0; robot < 12; ++robot) {
      const double days = draw.Days(20, 40);
      const Vector6d change = draw.Shift(m_per_root_day * std::sqrt(days)) + draw.Shift(3e-4);
      steps.push_back({Named(robot), days, change, Sigma(3e-4)});
    }
    const auto forecast = ForecastDrift(steps, kThis, kTolerance, 3000);
    ASSERT_TRUE(forecast);
    for (int future = 0; future < kFutures; ++future)
      beyond += draw.Shift(m_per_root_day * std::sqrt(forecast->days)).head<3>().norm() > kTolerance.m ? 1 : 0;
  }
  EXPECT_LT(beyond / double{kFleets * kFutures}, 0.11);
}

// Months, weeks or years: the law, and the date in steps, are those of the changes.
TEST(DriftForecast, TheUnitOfTimeDoesNotChooseTheLaw) {
  for (const double least : {30.0, 3.0}) {
    std::vector<double> dates_in_steps;
    for (const double scale : {0.1, 7.0 / 30, 1.0, 3.0}) {
      Draw draw(9);
      std::vector<DriftStep> steps;
      for (int robot = 0; robot < 12; ++robot) {
        const double days = draw.Days(least, 30);
        steps.push_back({Named(robot), scale * days, draw.Shift(1e-3 * std::sqrt(days / 30)), Sigma(3e-4)});
      }
      const auto forecast = ForecastDrift(steps, kThis, kTolerance, 1e6);
      ASSERT_TRUE(forecast);
      if (least == 30.0) {  // nothing tells
        EXPECT_EQ(forecast->law, DriftLaw::kRandomWalk) << scale;
      }
      dates_in_steps.push_back(forecast->days / scale);
    }
    for (const double date : dates_in_steps) EXPECT_NEAR(date, dates_in_steps.front(), 1e-6 * date) << least;
  }
}

TEST(DriftForecast, ARobotThatCreepsFasterThanItsFleetIsDueEarlier) {
  Draw draw(5);
  DrawnFleet fleet = Creeping(draw, 20, 4, 2e-5, 1e-4);
  const RobotId fast("fast");
  for (const double days : {10.0, 20.0, 30.0}) {
    Vector6d change = Vector6d::Zero();
    change(tangent::kZ) = 1e-4 * days;
    fleet.steps.push_back({fast, days, change, Sigma(1e-4)});
  }
  const auto of_fast = ForecastDrift(fleet.steps, fast, kTolerance, 3000);
  const auto of_this = ForecastDrift(fleet.steps, kThis, kTolerance, 3000);
  ASSERT_TRUE(of_fast && of_this);
  EXPECT_EQ(of_fast->law, DriftLaw::kLinear);
  EXPECT_NEAR(of_fast->days, 50, 8);  // 0.1 mm a day, and 5 mm of tolerance
  EXPECT_GT(of_this->days, of_fast->days);
}

TEST(DriftForecast, WhatDoesNotMoveHasNoDate) {
  Draw draw(6);
  const auto steps = Walking(draw, 12, 6, 0.0, 1e-4).steps;
  EXPECT_FALSE(ForecastDrift(steps, kThis, kTolerance, 90));
  EXPECT_FALSE(ForecastDrift({steps[0], steps[1]}, kThis, kTolerance, 1e9)) << "two visits tell nothing";
  EXPECT_FALSE(ForecastDrift({}, kThis, kTolerance, 90));
}

TEST(DriftForecast, NeverTakesWhatIsNoNumber) {
  Draw draw(7);
  auto steps = Walking(draw, 6, 4, 3e-4, 1e-4).steps;
  const auto clean = ForecastDrift(steps, kThis, kTolerance, 3000);
  DriftStep bad = steps.front();
  bad.change(0) = std::nan("");
  steps.push_back(bad);
  bad.change(0) = 0.0, bad.days = 0.0;
  steps.push_back(bad);
  bad.days = 5.0, bad.sigma.setZero();
  steps.push_back(bad);
  const auto same = ForecastDrift(steps, kThis, kTolerance, 3000);
  ASSERT_TRUE(clean && same);
  EXPECT_EQ(clean->days, same->days);
  EXPECT_EQ(same->visits, 24);
  EXPECT_FALSE(ForecastDrift(steps, kThis, {0.0, 0.005}, 3000));
}

}  // namespace
}  // namespace rigcal::fleet
