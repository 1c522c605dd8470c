#include "server/graph/fusion/random_walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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
  const double of_8 = MedianWalk_m2(8, 1e-4, 3e-4, 0.0) * 7 * kWeek_days,
               of_32 = MedianWalk_m2(32, 1e-4, 3e-4, 0.0) * 31 * kWeek_days;
  EXPECT_LT(of_8, 0.6 * 9e-8);
  EXPECT_LT(of_32, 0.2 * 9e-8);
  EXPECT_LT(of_32, 0.5 * of_8);
}

TEST(RandomWalk, IsNoneOfFewVisitsOrOfOneDay) {
  Random random(4);
  EXPECT_EQ(WalkOf(DrawnResiduals(5, 1e-4, 0.0, 1e-3, random)).per_day, VisitVariance());
  EXPECT_EQ(WalkOf({}).per_day, VisitVariance());
  std::vector<VisitResidual> one_day = DrawnResiduals(10, 1e-4, 0.0, 1e-3, random);
  for (VisitResidual& visit : one_day) visit.age_days = 3.0;
  EXPECT_EQ(WalkOf(one_day).per_day, VisitVariance());
}

TEST(RandomWalk, VisitsThatSayNothingOrErrByNothingMakeNoNumbersThatAreNone) {
  std::vector<VisitResidual> exact(6, {Vector6d::Zero(), Matrix6d::Zero(), 0.0});
  for (std::size_t k = 0; k < exact.size(); ++k) exact[k].age_days = static_cast<double>(k);
  EXPECT_EQ(WalkOf(exact).per_day, VisitVariance());
  exact[2].e = Vector6d::Ones();
  EXPECT_TRUE(std::isfinite(WalkOf(exact).per_day.translation_m2));
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
  for (const Eigen::MatrixXd& gain : GainsOf(fusion, *inverse)) sum += gain;
  EXPECT_LT((sum - Eigen::MatrixXd::Identity(12, 12)).cwiseAbs().maxCoeff(), 1e-3);
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
  FuseSessions(robot.edges, {}, kBase, robot.estimates, solution, {}, captured_at);
  const Vector6d e = ErrorAtNewest(solution);
  EXPECT_LT(e.dot(solution.poses[1].covariance.ldlt().solve(e)), ChiSquareQuantile(0.95, 6));
  EXPECT_LT(e.head<3>().norm(), 6e-4);
  EXPECT_GT(solution.poses[1].fused->walk_m_per_sqrt_day, 1e-5);
  EXPECT_LT(solution.poses[2].fused->walk_m_per_sqrt_day, 1e-5);
}

TEST(RandomWalk, NothingWalksOverDaysThatAreNotTold) {
  std::map<SessionId, Stamp> captured_at;
  const GraphSolution solution = Creeping(captured_at).Fused();
  EXPECT_EQ(solution.poses[1].fused->walk_m_per_sqrt_day, 0.0);
  EXPECT_NEAR(ErrorAtNewest(solution).head<3>().norm(), 15.5e-4, 2e-4);  // the mean place: which is why days are told
}

}  // namespace
}  // namespace rigcal::graph
