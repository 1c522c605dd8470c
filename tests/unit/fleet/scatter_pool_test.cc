// What robots of a rig model scatter by, drawn: false alarms of a test by it, and the smallest change it sees.
#include "server/fleet/population/scatter_pool.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "server/fleet/as_found/smallest_change.h"
#include "server/math/statistics.h"
#include "server/model/approval/policy.h"
#include "server/model/sessions/as_found.h"

namespace rigcal::fleet {
namespace {

const SensorId kLeft("left"), kTop("top");
constexpr int kRobots = 20, kAxes = 24;                     // of four sensors
constexpr double kScatter_m2 = 0.25e-6, kOwn_m2 = 0.04e-6;  // 0.5 mm and 0.2 mm

class Draw {
 public:
  explicit Draw(unsigned seed) : engine_(seed) {}
  double Normal() { return normal_(engine_); }
  // As so many visits show a variance.
  ScatterOfAxes Shown(double between, double own, int visits) {
    const double dof = 3.0 * (visits - 1);
    if (dof <= 0) return {0.0, own, 0.0};
    return {(between + own) * std::chi_squared_distribution<>(dof)(engine_) / dof - own, own, dof};
  }
  double ShownOfAxis(double variance, int dof) {
    return variance * std::chi_squared_distribution<>(dof)(engine_) / dof;
  }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

RobotScatter Of(const ScatterOfAxes& scatter) { return {{kLeft, {scatter, scatter}}}; }

std::optional<ScatterOfAxes> PoolWithout(std::size_t robot, const std::vector<ScatterOfAxes>& shown) {
  std::vector<RobotScatter> others;
  for (std::size_t i = 0; i < shown.size(); ++i)
    if (i != robot && shown[i].dof > 0) others.push_back(Of(shown[i]));
  const PooledScatter pooled = PoolScatter(others);
  return pooled.contains(kLeft) ? std::optional(pooled.at(kLeft).translation) : std::nullopt;
}

double LimitOf(double dof) { return LimitInSigmas(kAsFoundAlpha / kAxes, dof); }

// Of a session against a calibration of so many visits: what is taken for its variance, by which degrees of freedom.
ScatterTaken Told(const ScatterOfAxes& own, const std::optional<ScatterOfAxes>& pooled) {
  const ScatterTaken taken = TakenScatter(own, pooled);
  return taken.dof > 0 ? taken : ScatterTaken{std::pow(kDefaultMovedMin.m, 2), 0.0, false};
}

// By the normal tail given what is told, so that odds of one in a thousand need no million sessions.
double FalseAlarmOdds(const ScatterTaken& told, double truth_m2) {
  const double sigmas = std::sqrt((told.variance + kOwn_m2) / (truth_m2 + kOwn_m2));
  return std::min(1.0, kAxes * ChiSquareTail(std::pow(LimitOf(told.dof) * sigmas, 2), 1));
}

double SmallestChange_m(const ScatterTaken& told, int visits) {
  const double sigma_m = std::sqrt((told.variance + kOwn_m2) * (1 + 1.0 / visits));
  return sigma_m * (LimitOf(told.dof) + BeyondLimitInSigmas(told.dof));
}

// Means over robots of drawn fleets; `alone`: by the robot's own visits and the policy, as without a pool.
struct Told20 {
  double odds = 0.0, odds_alone = 0.0, smallest_m = 0.0, smallest_alone_m = 0.0;
};
Told20 DrawFleets(int fleets, int visits, int visits_of_others, unsigned seed,
                  const std::function<double(Draw&, int)>& truth_of) {
  Draw draw(seed);
  Told20 mean;
  const double share = 1.0 / (fleets * kRobots);
  for (int fleet = 0; fleet < fleets; ++fleet) {
    std::vector<double> truth;
    std::vector<ScatterOfAxes> shown;
    for (int robot = 0; robot < kRobots; ++robot) {
      truth.push_back(truth_of(draw, robot));
      shown.push_back(draw.Shown(truth.back(), kOwn_m2, visits_of_others));
    }
    for (std::size_t robot = 0; robot < kRobots; ++robot) {
      const ScatterOfAxes own = draw.Shown(truth[robot], kOwn_m2, visits);
      const ScatterTaken told = Told(own, PoolWithout(robot, shown)), alone = Told(own, std::nullopt);
      mean.odds += share * FalseAlarmOdds(told, truth[robot]);
      mean.odds_alone += share * FalseAlarmOdds(alone, truth[robot]);
      if (fleet > 0) continue;
      mean.smallest_m += SmallestChange_m(told, visits) / kRobots;
      mean.smallest_alone_m += SmallestChange_m(alone, visits) / kRobots;
    }
  }
  return mean;
}

double Alike(Draw&, int) { return kScatter_m2; }
// Of 20 the most and the least differ by about seven times in variance.
double Different(Draw& draw, int) { return kScatter_m2 * std::exp(0.5 * draw.Normal()); }
// Half of them scatter three times as much as the others.
double Halves(Draw&, int robot) { return robot % 2 == 0 ? 0.09e-6 : 0.81e-6; }

TEST(ScatterPool, RobotsThatAreAlikeGiveNoMoreFalseAlarmsThanAlpha) {
  for (int visits = 1; visits <= 10; ++visits) {
    const Told20 told = DrawFleets(100, visits, 6, 10 + static_cast<unsigned>(visits), Alike);
    EXPECT_LE(told.odds, kAsFoundAlpha) << visits << " visits";
    EXPECT_GE(told.odds, 0.05 * kAsFoundAlpha) << visits << " visits";  // nor is it blind
  }
}

// As many as alpha says, or as the robots' own visits and the policy's assumption give without any pool.
TEST(ScatterPool, RobotsThatAreNotAlikeGiveNoMoreEither) {
  for (int visits = 1; visits <= 10; ++visits)
    for (const auto& truth_of : {std::function(Different), std::function(Halves)}) {
      const Told20 told = DrawFleets(100, visits, 6, 30 + static_cast<unsigned>(visits), truth_of);
      EXPECT_LE(told.odds, 1.2 * std::max(kAsFoundAlpha, told.odds_alone)) << visits << " visits";
    }
}

// It is accused until its own visits show what it scatters by: README.md has how often.
TEST(ScatterPool, ALoneRobotThatScattersMoreIsHeldByItsOwnVisits) {
  const auto truth_of = [](Draw&, int robot) { return robot == 0 ? 9 * kScatter_m2 : kScatter_m2; };
  for (int visits = 7; visits <= 10; ++visits)  // 0.94 of alpha over 1,000 fleets, up to 1.2 over 100
    EXPECT_LE(DrawFleets(100, visits, 6, 60 + static_cast<unsigned>(visits), truth_of).odds, 1.5 * kAsFoundAlpha)
        << visits << " visits";
  EXPECT_LT(DrawFleets(100, 3, 6, 71, truth_of).odds, 10 * kAsFoundAlpha);
}

TEST(ScatterPool, ItSeesSmallerChangesThanTheRobotAlone) {
  const Told20 one = DrawFleets(1, 1, 6, 51, Alike), three = DrawFleets(1, 3, 6, 52, Alike),
               ten = DrawFleets(1, 10, 6, 53, Alike);
  EXPECT_GT(one.smallest_alone_m, 8e-3);
  EXPECT_LT(one.smallest_m, 6.5e-3);
  EXPECT_GT(three.smallest_alone_m, 7e-3);
  EXPECT_LT(three.smallest_m, 5e-3);
  EXPECT_LT(ten.smallest_m, ten.smallest_alone_m);
}

TEST(ScatterPool, IsWhatItsRobotsShow) {
  Draw draw(1);
  std::vector<RobotScatter> robots;
  for (int robot = 0; robot < 200; ++robot) robots.push_back(Of(draw.Shown(kScatter_m2, kOwn_m2, 11)));
  const PooledScatter pooled = PoolScatter(robots);
  ASSERT_TRUE(pooled.contains(kLeft));
  EXPECT_EQ(pooled.at(kLeft).robots, 200);
  EXPECT_NEAR(pooled.at(kLeft).translation.between, kScatter_m2, 0.1 * kScatter_m2);
  EXPECT_NEAR(pooled.at(kLeft).translation.own, kOwn_m2, 1e-15);
  EXPECT_GT(pooled.at(kLeft).translation.dof, 60);
  EXPECT_LE(pooled.at(kLeft).translation.dof, kPoolDofMax);
}

// s^2 of a scaled inverse chi-square of 12 degrees of freedom: that is what it must not exceed by much.
TEST(ScatterPool, KnowsHowUnlikeItsRobotsAre) {
  Draw draw(2);
  std::mt19937 engine(3);
  std::vector<RobotScatter> robots;
  for (int robot = 0; robot < 200; ++robot) {
    const double truth = kScatter_m2 * 12 / std::chi_squared_distribution<>(12)(engine);
    robots.push_back(Of(draw.Shown(truth, 0.0, 40)));
  }
  const PooledScatter pooled = PoolScatter(robots);
  ASSERT_TRUE(pooled.contains(kLeft));
  EXPECT_LT(pooled.at(kLeft).translation.dof, 16);
  EXPECT_GE(pooled.at(kLeft).translation.dof, 7);
}

TEST(ScatterPool, OneStrangerTakesThePoolsWord) {
  std::vector<RobotScatter> robots;
  for (int robot = 0; robot < 19; ++robot) robots.push_back(Of({kScatter_m2, kOwn_m2, 60.0}));
  ASSERT_TRUE(PoolScatter(robots).contains(kLeft));
  robots.push_back(Of({100 * kScatter_m2, kOwn_m2, 60.0}));
  EXPECT_FALSE(PoolScatter(robots).contains(kLeft));
}

TEST(ScatterPool, FewRobotsOrFewVisitsTellNothing) {
  std::vector<RobotScatter> robots(4, Of({kScatter_m2, kOwn_m2, 60.0}));
  EXPECT_TRUE(PoolScatter(robots).empty());
  robots.push_back(Of({kScatter_m2, kOwn_m2, 0.0}));  // one visit
  EXPECT_TRUE(PoolScatter(robots).empty());
  robots.push_back({{kTop, {{kScatter_m2, kOwn_m2, 60.0}, {kScatter_m2, kOwn_m2, 60.0}}}});
  EXPECT_TRUE(PoolScatter(robots).empty());
  robots.push_back(Of({kScatter_m2, kOwn_m2, 60.0}));
  EXPECT_TRUE(PoolScatter(robots).contains(kLeft));
  EXPECT_FALSE(PoolScatter(robots).contains(kTop));
}

// Those of them that scatter most are told to have moved, and are not here: the others are no sample.
TEST(ScatterPool, RobotsOfTwoVisitsDoNotCount) {
  EXPECT_TRUE(PoolScatter(std::vector<RobotScatter>(40, Of({kScatter_m2, kOwn_m2, 3.0}))).empty());
  std::vector<RobotScatter> robots(12, Of({kScatter_m2, kOwn_m2, 6.0}));
  robots.resize(52, Of({0.01 * kScatter_m2, kOwn_m2, 3.0}));
  const PooledScatter pooled = PoolScatter(robots);
  ASSERT_TRUE(pooled.contains(kLeft));
  EXPECT_EQ(pooled.at(kLeft).robots, 12);
  EXPECT_GE(pooled.at(kLeft).translation.between, 0.9 * kScatter_m2);
}

TEST(ScatterPool, VisitsThatAgreeBetterThanTheySayScatterByNothing) {
  const std::vector<RobotScatter> robots(8, Of({-0.5 * kOwn_m2, kOwn_m2, 30.0}));
  const PooledScatter pooled = PoolScatter(robots);
  ASSERT_TRUE(pooled.contains(kLeft));
  EXPECT_EQ(pooled.at(kLeft).translation.between, 0.0);
}

// As so many visits show variances that axes need not have alike.
ScatterOfAxes ShownAlong(const ThreeAxes& truth_m2, int visits, Draw& draw) {
  ThreeAxes shown{};
  for (std::size_t axis = 0; axis < 3; ++axis) shown[axis] = draw.ShownOfAxis(truth_m2[axis] + kOwn_m2, visits - 1);
  const double mean = (shown[0] + shown[1] + shown[2]) / 3;
  ScatterOfAxes scatter{mean - kOwn_m2, kOwn_m2, 3.0 * (visits - 1)};
  for (std::size_t axis = 0; axis < 3; ++axis) scatter.ratio[axis] = shown[axis] / mean;
  return scatter;
}

struct ToldOfAxes {
  double odds = 0.0, sigma_limit_m = 0.0;  // of a false alarm; what an axis must change by to be told, mean
};
ToldOfAxes DrawAxes(int fleets, int robots, int visits, const ThreeAxes& parts, unsigned seed,
                    int visits_of_others = 6) {
  Draw draw(seed);
  ToldOfAxes mean;
  for (int fleet = 0; fleet < fleets; ++fleet) {
    const ThreeAxes truth_m2 = {parts[0] * kScatter_m2, parts[1] * kScatter_m2, parts[2] * kScatter_m2};
    std::vector<RobotScatter> others;
    for (int robot = 1; robot < robots; ++robot) others.push_back(Of(ShownAlong(truth_m2, visits_of_others, draw)));
    const PooledScatter pooled = PoolScatter(others);
    const ScatterOfAxes own = visits > 1 ? ShownAlong(truth_m2, visits, draw) : ScatterOfAxes{0.0, kOwn_m2, 0.0};
    const ScatterTaken told =
        Told(own, pooled.contains(kLeft) ? std::optional(pooled.at(kLeft).translation) : std::nullopt);
    const Vector6d along_m2 = AlongAxes(told, {});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      mean.odds += FalseAlarmOdds({along_m2[static_cast<Eigen::Index>(axis)], told.dof}, truth_m2[axis]) / 3 / fleets;
      mean.sigma_limit_m +=
          LimitOf(told.dof) * std::sqrt(along_m2[static_cast<Eigen::Index>(axis)] + kOwn_m2) / 3 / fleets;
    }
  }
  return mean;
}

// Taken as alike, axes of which one has all accuse up to a hundred times as often as alpha: README.md has the figures.
TEST(ScatterPool, RobotsThatScatterAlongOneAxisGiveNoMoreFalseAlarmsThanAlpha) {
  for (const int robots : {10, 20})
    for (const int visits : {1, 2, 3, 5, 10})
      for (const ThreeAxes& parts : {ThreeAxes{3, 0, 0}, ThreeAxes{1.5, 1.5, 0}, ThreeAxes{1, 1, 1}})
        EXPECT_LE(DrawAxes(300, robots, visits, parts, 80 + static_cast<unsigned>(visits)).odds, 1.5 * kAsFoundAlpha)
            << robots << " robots, " << visits << " visits, " << parts[0];
}

// Each axis shows two numbers: what few robots show along their axes may be anything by chance.
TEST(ScatterPool, FewRobotsOfThreeVisitsGiveNoMoreFalseAlarmsThanAlpha) {
  for (const int robots : {7, 9, 11})
    for (const int visits : {1, 2, 3, 5})
      for (const ThreeAxes& parts : {ThreeAxes{1, 1, 1}, ThreeAxes{2, 0.5, 0.5}, ThreeAxes{3, 0, 0}})
        EXPECT_LE(DrawAxes(600, robots, visits, parts, 140 + static_cast<unsigned>(robots), 3).odds, kAsFoundAlpha)
            << robots << " robots, " << visits << " visits, " << parts[0];
}

// Robots that no other tells: of each sensor's shifts, what axes scatter by over the mean.
ToldOfAxes DrawAlone(int sensors, int visits, const std::function<ThreeAxes(int)>& parts_of, unsigned seed) {
  constexpr int kAlone = 2000;
  const ScatterOfAxes some{kScatter_m2, kOwn_m2, 3.0 * (visits - 1), {1, 1, 1}};
  const double dof =
      TakenScatter(some, std::nullopt, std::vector<ScatterOfAxes>(static_cast<std::size_t>(sensors), some)).dof;
  const double limit = LimitOf(dof), smallest = limit + BeyondLimitInSigmas(dof);
  Draw draw(seed);
  ToldOfAxes mean;
  for (int robot = 0; robot < kAlone; ++robot) {
    std::vector<ThreeAxes> truth_m2;
    std::vector<ScatterOfAxes> shown;
    for (int sensor = 0; sensor < sensors; ++sensor) {
      const ThreeAxes parts = parts_of(sensor);
      truth_m2.push_back({parts[0] * kScatter_m2, parts[1] * kScatter_m2, parts[2] * kScatter_m2});
      shown.push_back(ShownAlong(truth_m2.back(), visits, draw));
    }
    for (std::size_t sensor = 0; sensor < shown.size(); ++sensor) {
      const ScatterTaken told = TakenScatter(shown[sensor], std::nullopt, shown);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double told_m2 = told.variance * told.share[axis] + kOwn_m2;
        const double sigmas = limit * std::sqrt(told_m2 / (truth_m2[sensor][axis] + kOwn_m2));
        mean.odds += kAxes * ChiSquareTail(sigmas * sigmas, 1) / (3.0 * sensors * kAlone);
        mean.sigma_limit_m += smallest * std::sqrt(told_m2 * (1 + 1.0 / visits)) / (3.0 * sensors * kAlone);
      }
    }
  }
  return mean;
}

// Taken as alike, one axis that has all accuses up to a hundred times as often as alpha, however many visits:
// README.md.
TEST(ScatterPool, ARobotAloneIsNotAccusedForAScatterAlongFewAxes) {
  for (const int sensors : {1, 2, 4, 11})
    for (const int visits : {2, 3, 5, 10})
      for (const ThreeAxes& parts :
           {ThreeAxes{3, 0, 0}, ThreeAxes{1.5, 1.5, 0}, ThreeAxes{2, 0.5, 0.5}, ThreeAxes{1, 1, 1}})
        EXPECT_LE(DrawAlone(
                      sensors, visits, [&](int) { return parts; }, 90 + static_cast<unsigned>(visits))
                      .odds,
                  kAsFoundAlpha)
            << sensors << " sensors, " << visits << " visits, " << parts[0];
}

// One mount of four that gives along one axis by ten times as much as the others.
TEST(ScatterPool, ARobotAloneIsNotAccusedForOneLooseMount) {
  const auto loose = [](int sensor) { return sensor == 0 ? ThreeAxes{100, 1, 1} : ThreeAxes{1, 1, 1}; };
  for (const int visits : {2, 3, 5, 10})
    EXPECT_LE(DrawAlone(4, visits, loose, 110 + static_cast<unsigned>(visits)).odds, 3 * kAsFoundAlpha)
        << visits << " visits";
}

// What that costs, where axes are alike.
TEST(ScatterPool, ARobotAloneSeesChangesByItsVisits) {
  const auto smallest_m = [](int visits) {
    return DrawAlone(
               4, visits,
               [](int) {
                 return ThreeAxes{1, 1, 1};
               },
               120 + static_cast<unsigned>(visits))
        .sigma_limit_m;
  };
  const double three_m = smallest_m(3), five_m = smallest_m(5), ten_m = smallest_m(10);
  RecordProperty("three_mm", std::to_string(1e3 * three_m));
  RecordProperty("five_mm", std::to_string(1e3 * five_m));
  RecordProperty("ten_mm", std::to_string(1e3 * ten_m));
  EXPECT_LT(three_m, 22e-3);
  EXPECT_LT(five_m, 10e-3);
  EXPECT_LT(ten_m, 5.5e-3);
}

TEST(ScatterPool, AxesThatAreAlikeAreTakenAsAlike) {
  Draw draw(4);
  std::vector<RobotScatter> robots;
  for (int robot = 0; robot < 100; ++robot)
    robots.push_back(Of(ShownAlong({kScatter_m2, kScatter_m2, kScatter_m2}, 6, draw)));
  for (const double ratio : PoolScatter(robots).at(kLeft).translation.ratio) EXPECT_NEAR(ratio, 1.0, 0.1);
}

// What robots of different scatter have in common is along which axes: the scale is left to each of them.
TEST(ScatterPool, TellsTheAxesOfRobotsThatDoNotTellTheScale) {
  Draw draw(5);
  std::vector<RobotScatter> robots;
  for (int robot = 0; robot < 12; ++robot) {
    const double scale = std::pow(10.0, robot % 3);
    robots.push_back(Of(ShownAlong({3 * scale * kScatter_m2, 0.0, 0.0}, 11, draw)));
  }
  const ScatterOfAxes pool = PoolScatter(robots).at(kLeft).translation;
  EXPECT_EQ(pool.dof, 0.0);
  EXPECT_EQ(pool.between, 0.0);
  EXPECT_GT(pool.ratio[0], 2.5);
  EXPECT_LT(pool.ratio[1], 0.2);
}

}  // namespace
}  // namespace rigcal::fleet
