#include "server/graph/fusion/random_walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/graph/fusion/visit_ages.h"
#include "server/math/statistics.h"
#include "tests/unit/graph/fusion/drawn_visits.h"

namespace rigcal::graph {
namespace {

constexpr double kWeek_days = 7.0;
constexpr std::int64_t kWeek_ns = 7LL * 86'400'000'000'000;

// Weekly visits that err by `own`, scatter by `scatter` and walk by `step` a week, metres and radians alike; newest
// first.
std::vector<VisitResidual> DrawnResiduals(int visits, double own, double scatter, double step, Random& random) {
  std::vector<VisitResidual> newest_first;
  Vector6d place = Vector6d::Zero();
  for (int week = 0; week < visits; ++week) {
    place += step * random.Normal(6);
    newest_first.insert(newest_first.begin(), {place + std::hypot(own, scatter) * random.Normal(6),
                                               own * own * Matrix6d::Identity(), kWeek_days * (visits - 1 - week)});
  }
  return newest_first;
}

double MedianWalk_m2(int visits, double own, double scatter, double step) {
  Random random(3);
  std::vector<double> walks;
  for (int robot = 0; robot < 41; ++robot)
    walks.push_back(WalkOf(DrawnResiduals(visits, own, scatter, step, random)).per_day.translation_m2);
  std::nth_element(walks.begin(), walks.begin() + 20, walks.end());
  return walks[20];
}

TEST(RandomWalk, IsOfItsSize) {
  const double true_m2 = 1e-8 / kWeek_days;
  for (const double scatter_m : {0.0, 1e-4}) {
    const double median_m2 = MedianWalk_m2(32, 1e-4, scatter_m, 1e-4);
    EXPECT_GT(median_m2, 0.5 * true_m2);
    EXPECT_LT(median_m2, 2.0 * true_m2);
  }
}

TEST(RandomWalk, IsSmallWhereVisitsScatterAboutOnePlaceAndTheSmallerTheMoreTheyAre) {
  const double of_12 = MedianWalk_m2(12, 1e-4, 3e-4, 0.0) * 11 * kWeek_days,
               of_32 = MedianWalk_m2(32, 1e-4, 3e-4, 0.0) * 31 * kWeek_days;
  EXPECT_LT(of_12, 0.3 * 9e-8);
  EXPECT_LT(of_32, 0.1 * 9e-8);
  EXPECT_LT(of_32, 0.6 * of_12);
}

TEST(RandomWalk, IsNoneOfFewVisitsOrOfOneDay) {
  Random random(4);
  EXPECT_EQ(WalkOf(DrawnResiduals(5, 1e-4, 0.0, 1e-3, random)).per_day, VisitVariance());
  EXPECT_EQ(WalkOf({}).per_day, VisitVariance());
  std::vector<VisitResidual> one_day = DrawnResiduals(14, 1e-4, 0.0, 1e-3, random);
  for (VisitResidual& visit : one_day) visit.age_days = 3.0;
  EXPECT_EQ(WalkOf(one_day).per_day, VisitVariance());
}

TEST(RandomWalk, VisitsThatSayNothingOrErrByNothingMakeNoNumbersThatAreNone) {
  std::vector<VisitResidual> exact(12, {Vector6d::Zero(), Matrix6d::Zero(), 0.0});
  for (std::size_t k = 0; k < exact.size(); ++k) exact[k].age_days = static_cast<double>(k);
  EXPECT_EQ(WalkOf(exact).per_day, VisitVariance());
  exact[2].e = Vector6d::Ones();
  EXPECT_TRUE(std::isfinite(WalkOf(exact).per_day.translation_m2));
}

TEST(RandomWalk, ResidualsAboutItAreAsLargeAsVisitsLessMeansSay) {
  constexpr double kOwn = 1e-4, kScatter = 2e-4, kStep = 3e-4;
  const VisitVariance walk{kStep * kStep / kWeek_days, kStep * kStep / kWeek_days};
  const VisitVariance scatter{kScatter * kScatter, kScatter * kScatter};
  Random random(12);
  double squares = 0.0, expected = 0.0;
  for (int robot = 0; robot < 300; ++robot) {
    const WalkResiduals about = ResidualsAboutWalk(DrawnResiduals(12, kOwn, kScatter, kStep, random), walk, scatter);
    for (const VisitResidual& visit : about.visits)
      squares += visit.e.head<3>().squaredNorm() / (kOwn * kOwn + kScatter * kScatter);
    EXPECT_GT(about.means.translation, 3.0);  // a place each few visits
    expected += 3.0 * (12.0 - about.means.translation);
  }
  EXPECT_NEAR(squares / expected, 1.0, 0.05);
}

TEST(RandomWalk, WithoutOneVisitsAreLeftAsTheyAre) {
  Random random(13);
  const std::vector<VisitResidual> visits = DrawnResiduals(9, 1e-4, 1e-4, 0.0, random);
  const WalkResiduals about = ResidualsAboutWalk(visits, {}, {1e-8, 1e-8});
  EXPECT_EQ(about.means.translation, 1.0);
  EXPECT_EQ(about.means.rotation, 1.0);
  for (std::size_t k = 0; k < visits.size(); ++k) EXPECT_EQ(about.visits[k].e, visits[k].e);
}

// Depth of a camera, by far the worst of its axes, says nothing of the others.
TEST(RandomWalk, OneAxisThatIsKnownBadlyChangesLittleOfTheOthers) {
  Random random(14), again(14);
  std::vector<VisitResidual> good = DrawnResiduals(16, 1e-4, 0.0, 0.0, random),
                             bad = DrawnResiduals(16, 1e-4, 0.0, 0.0, again);
  for (VisitResidual& visit : bad) {
    visit.e.z() *= 1000.0;
    visit.own(2, 2) *= 1e6;
  }
  EXPECT_LT(WalkOf(bad).per_day.translation_m2, 4.0 * WalkOf(good).per_day.translation_m2);
}

// Two sensors, three visits: nearly linear, so that least squares over all visits at once is the same.
SessionFusion ThreeVisits(Random& random) {
  SessionFusion fusion;
  fusion.sensors = {kLeft, kRight};
  fusion.T_ref = {Truth()[1], Truth()[2]};
  fusion.scatter = {{1e-8, 2e-8}, {3e-8, 0.0}};
  fusion.walk = {{2e-9, 1e-9}, {0.0, 4e-9}};
  for (const double age_days : {0.0, 5.0, 30.0}) {
    const Eigen::MatrixXd C = CovarianceOf(1e-4, 1e-4);
    const Eigen::VectorXd e = random.Of(C);
    SessionFactor factor;
    factor.variable = {0, 1};
    factor.T_frame_sensor = {Truth()[1] * Se3::Exp(e.head<6>()), Truth()[2] * Se3::Exp(e.tail<6>())};
    factor.dof = {50.0, 50.0};
    factor.C = C;
    factor.age_days = age_days;
    fusion.factors.push_back(factor);
  }
  return fusion;
}

// Visits k and l have the walk of the days before both in common, as against the place of the newest.
struct AtOnce {
  Eigen::VectorXd place;
  Eigen::MatrixXd covariance;
};
AtOnce LeastSquaresAtOnce(const SessionFusion& fusion) {
  Eigen::VectorXd y(36), walk(12), scatter(12);
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(36, 36), J(36, 12);
  for (int s = 0; s < 2; ++s) {
    walk.segment<6>(6 * s) = fusion.walk[static_cast<std::size_t>(s)].Matrix().diagonal();
    scatter.segment<6>(6 * s) = fusion.scatter[static_cast<std::size_t>(s)].Matrix().diagonal();
  }
  for (int k = 0; k < 3; ++k) {
    const SessionFactor& factor = fusion.factors[static_cast<std::size_t>(k)];
    J.middleRows<12>(12 * k).setIdentity();
    for (int s = 0; s < 2; ++s)
      y.segment<6>(12 * k + 6 * s) =
          (Truth()[static_cast<std::size_t>(s) + 1].Inverse() * factor.T_frame_sensor[static_cast<std::size_t>(s)])
              .Log();
    C.block<12, 12>(12 * k, 12 * k) += factor.C;
    C.block<12, 12>(12 * k, 12 * k).diagonal() += scatter;
    for (int l = 0; l < 3; ++l)
      C.block<12, 12>(12 * k, 12 * l).diagonal() +=
          std::min(factor.age_days, fusion.factors[static_cast<std::size_t>(l)].age_days) * walk;
  }
  const Eigen::MatrixXd W = C.inverse(), covariance = (J.transpose() * W * J).inverse();
  return {covariance * J.transpose() * W * y, covariance};
}

TEST(RandomWalk, PosesAreThoseOfLeastSquaresOverAllVisitsAtOnce) {
  Random random(8);
  SessionFusion fusion = ThreeVisits(random);
  const AtOnce wanted = LeastSquaresAtOnce(fusion);
  const auto inverse = Settle(fusion);
  ASSERT_TRUE(inverse);
  const Eigen::VectorXd sigma = wanted.covariance.diagonal().cwiseSqrt();
  for (int s = 0; s < 2; ++s) {
    const Vector6d told =
        (Truth()[static_cast<std::size_t>(s) + 1].Inverse() * fusion.T_ref[static_cast<std::size_t>(s)]).Log();
    EXPECT_LT((told - wanted.place.segment<6>(6 * s)).cwiseQuotient(sigma.segment<6>(6 * s)).cwiseAbs().maxCoeff(),
              1e-3);
  }
  EXPECT_LT((sigma.cwiseInverse().asDiagonal() * (*inverse - wanted.covariance) * sigma.cwiseInverse().asDiagonal())
                .cwiseAbs()
                .maxCoeff(),
            1e-3);
}

// What errs alike on every visit moves the poses by just that.
TEST(RandomWalk, GainsOfAllVisitsAddUpToOne) {
  Random random(9);
  SessionFusion fusion = ThreeVisits(random);
  const auto inverse = Settle(fusion);
  ASSERT_TRUE(inverse);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(12, 12);
  for (const Eigen::MatrixXd& gain : GainsOf(fusion, *inverse).of_sessions) sum += gain;
  EXPECT_LT((sum - Eigen::MatrixXd::Identity(12, 12)).cwiseAbs().maxCoeff(), 1e-3);
}

// Errors of visits, and the walk: nothing else is in what the poses are told by.
TEST(RandomWalk, GainsAndWalkMakeUpTheCovariance) {
  Random random(10);
  SessionFusion fusion = ThreeVisits(random);
  const auto inverse = Settle(fusion);
  ASSERT_TRUE(inverse);
  const Gains gains = GainsOf(fusion, *inverse);
  Eigen::MatrixXd sum = gains.by_walk;
  for (std::size_t k = 0; k < fusion.factors.size(); ++k)
    sum += gains.of_sessions[k] * WithScatter(fusion, fusion.factors[k]) * gains.of_sessions[k].transpose();
  const Eigen::VectorXd scale = inverse->diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((scale.asDiagonal() * (sum - *inverse) * scale.asDiagonal()).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_GT(gains.by_walk(0, 0), 0.1 * (*inverse)(0, 0));
}

// What was pushed long ago says less of where a sensor is now, however sure it was.
TEST(RandomWalk, AnEdgeOfLongAgoFades) {
  Random random(16);
  SessionFusion fusion = ThreeVisits(random);
  EdgeFactor edge{kFixed, 0, Truth()[1] * Se3::Exp(1e-2 * Vector6d::UnitX()), 1e12 * Matrix6d::Identity()};
  const auto pulled_by = [&](double age_days) {
    SessionFusion with = fusion;
    edge.age_days = age_days;
    with.edges = {edge};
    EXPECT_TRUE(Settle(with));
    return (Truth()[1].Inverse() * with.T_ref[0]).Log().x();
  };
  EXPECT_GT(pulled_by(0.0), 9.9e-3);
  EXPECT_LT(pulled_by(60.0), 5e-3);
}

TEST(RandomWalk, DaysBetweenVisitsCountUpToALimit) {
  constexpr std::int64_t kDay_ns = 86'400'000'000'000;
  SessionFusion fusion;
  VisitDates dates;
  const std::vector<int> days = {1000, 993, 980, 200, 193};  // parked for two years in between
  for (std::size_t k = 0; k < days.size(); ++k) {
    SessionFactor factor;
    factor.session = SessionNamed(static_cast<int>(k));
    fusion.factors.push_back(factor);
    fusion.sessions.push_back(factor.session);
    if (k != 2) dates.sessions[factor.session] = {days[k] * kDay_ns};  // one tells no date
  }
  for (const int day : {1007, 996, 100, 0}) {
    EdgeFactor edge;
    edge.edge = EdgeId(std::string(60, 'e') + std::to_string(1000 + day));
    if (day > 0) dates.edges[edge.edge] = {day * kDay_ns};
    fusion.edges.push_back(edge);
  }
  TakeAges(dates, fusion);
  std::vector<double> ages, of_edges;
  for (const SessionFactor& factor : fusion.factors) ages.push_back(factor.age_days);
  for (const EdgeFactor& edge : fusion.edges) of_edges.push_back(edge.age_days);
  EXPECT_EQ(ages, (std::vector<double>{0, 7, 7, 7 + kWalkedDaysMax, 14 + kWalkedDaysMax}));
  EXPECT_EQ(of_edges, (std::vector<double>{0, 4, 14 + 2 * kWalkedDaysMax, 0}));
  EXPECT_EQ(DaysUntilNext(fusion), (14 + kWalkedDaysMax) / 4);
}

// A robot whose sensors take a step from each visit to the next.
TEST(RandomWalk, NextVisitLiesInTheRegionTold) {
  constexpr double kStep = 2e-4;
  Random random(17);
  int inside = 0, asked = 0;
  for (int k = 0; k < 120; ++k) {
    Robot robot;
    VisitDates dates;
    std::vector<Se3> places = Truth();
    for (int week = 0; week < 14; ++week) {
      robot.Add(Drawn(week, places, CovarianceOf(1e-4, 1e-4), random));
      dates.sessions[robot.estimates.back().session] = {week * kWeek_ns};
      places = Scattered(places, kStep, kStep, random);
    }
    std::reverse(robot.estimates.begin(), robot.estimates.end());
    GraphSolution solution = Solve(GraphOf(robot.edges, kBase));
    FuseSessions(robot.edges, {}, kBase, robot.estimates, solution, {}, dates);
    for (std::size_t s = 1; s < 3; ++s, ++asked) {
      const SensorPose& pose = solution.poses[s];
      const Vector6d e = (pose.T_ref_sensor.Inverse() * places[s]).Log();
      inside += e.dot(pose.covariance.ldlt().solve(e)) <= HotellingLimit(static_cast<int>(pose.dof) + 1) ? 1 : 0;
    }
  }
  EXPECT_GE(inside, asked * 91 / 100);
  EXPECT_LE(inside, asked * 99 / 100);
}

// Weekly visits, the left sensor further by 0.1 mm and 0.1 mrad each week along one axis.
Robot Creeping(std::map<SessionId, Stamp>& captured_at) {
  Random random(11);
  Robot robot;
  for (int week = 0; week < 32; ++week) {
    std::vector<Se3> places = Truth();
    places[1] = places[1] * Se3::Exp(week * 1e-4 * (Vector6d() << 1, 0, 0, 0, 1, 0).finished());
    robot.Add(Drawn(week, places, CovarianceOf(1e-4, 1e-4), random));
    captured_at[robot.estimates.back().session] = {week * kWeek_ns};
  }
  std::reverse(robot.estimates.begin(), robot.estimates.end());
  return robot;
}

// Of the creeping sensor's pose as against its place on the newest visit.
Vector6d ErrorAtNewest(const GraphSolution& solution) {
  const Se3 newest = Truth()[1] * Se3::Exp(31 * 1e-4 * (Vector6d() << 1, 0, 0, 0, 1, 0).finished());
  return (solution.poses[1].T_ref_sensor.Inverse() * newest).Log();
}

TEST(RandomWalk, ASensorThatCreepsIsToldWhereItWentLast) {
  std::map<SessionId, Stamp> captured_at;
  const Robot robot = Creeping(captured_at);
  GraphSolution solution = Solve(GraphOf(robot.edges, kBase));
  FuseSessions(robot.edges, {}, kBase, robot.estimates, solution, {}, {captured_at, {}});
  const Vector6d e = ErrorAtNewest(solution);
  EXPECT_LT(e.dot(solution.poses[1].covariance.ldlt().solve(e)), ChiSquareQuantile(0.95, 6));
  EXPECT_LT(e.head<3>().norm(), 6e-4);
  EXPECT_GT(solution.poses[1].fused->walk_m_per_sqrt_day, 1e-5);
  EXPECT_LT(solution.poses[2].fused->walk_m_per_sqrt_day, 1e-5);
}

// By 0.3 mm and 0.3 mrad each quarter: eight visits tell it.
TEST(RandomWalk, FewVisitsTellWhatGoesOnByMoreThanTheyErr) {
  constexpr double kStep = 3e-4;
  Random random(18);
  int inside = 0;
  double off_m = 0.0;  // of the place on the newest visit
  for (int k = 0; k < 100; ++k) {
    Robot robot;
    VisitDates dates;
    const auto places_on = [&](int visit) {
      std::vector<Se3> places = Truth();
      places[1] = places[1] * Se3::Exp(visit * kStep * (Vector6d() << 1, 0, 0, 0, 1, 0).finished());
      return places;
    };
    for (int visit = 0; visit < 8; ++visit) {
      robot.Add(Drawn(visit, places_on(visit), CovarianceOf(1e-4, 1e-4), random));
      dates.sessions[robot.estimates.back().session] = {13 * visit * kWeek_ns};
    }
    std::reverse(robot.estimates.begin(), robot.estimates.end());
    GraphSolution solution = Solve(GraphOf(robot.edges, kBase));
    FuseSessions(robot.edges, {}, kBase, robot.estimates, solution, {}, dates);
    const SensorPose& pose = solution.poses[1];
    const Vector6d e = (pose.T_ref_sensor.Inverse() * places_on(8)[1]).Log();
    inside += e.dot(pose.covariance.ldlt().solve(e)) <= ChiSquareQuantile(0.95, 6) ? 1 : 0;
    off_m += 0.01 * (pose.T_ref_sensor.Inverse() * places_on(7)[1]).p_m.norm();
  }
  EXPECT_GE(inside, 90);
  EXPECT_LT(off_m, 1.5 * kStep);  // the mean place is 3.5 steps behind
}

TEST(RandomWalk, NothingWalksOverDaysThatAreNotTold) {
  std::map<SessionId, Stamp> captured_at;
  const GraphSolution solution = Creeping(captured_at).Fused();
  EXPECT_EQ(solution.poses[1].fused->walk_m_per_sqrt_day, 0.0);
  EXPECT_NEAR(ErrorAtNewest(solution).head<3>().norm(), 15.5e-4, 2e-4);  // the mean place: which is why days are told
}

}  // namespace
}  // namespace rigcal::graph
