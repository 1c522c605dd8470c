// Whether a sensor was moved between two visits.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/graph/fusion/drawn_visits.h"

namespace rigcal::graph {
namespace {

struct MoveBetween {
  const char* name;
  std::size_t sensor;
  int visits, first_after;
  double scatter_m;
};
class MovedBetweenVisits : public testing::TestWithParam<MoveBetween> {};

TEST_P(MovedBetweenVisits, IsNamedWithTheSessions) {
  const MoveBetween& given = GetParam();
  Random random(9);
  std::vector<Se3> after = Truth();
  const Se3 step = Se3::Exp((Vector6d() << 0.004, 0.003, 0, 0, 0.005, 0).finished());
  if (given.sensor == 0)
    for (std::size_t s = 1; s < 3; ++s) after[s] = step.Inverse() * after[s];
  else
    after[given.sensor] = after[given.sensor] * step;
  Robot robot;
  for (int k = 0; k < given.visits; ++k)
    robot.Add(Drawn(k, Scattered(k < given.first_after ? Truth() : after, given.scatter_m, given.scatter_m / 2, random),
                    CovarianceOf(1e-4, 1e-4), random));
  std::reverse(robot.estimates.begin(), robot.estimates.end());  // the newest first
  const GraphSolution solution = robot.Fused();
  ASSERT_FALSE(solution.fused.moved.empty());
  const SensorMovedBetween& moved = solution.fused.moved.front();
  EXPECT_EQ(moved.sensor, kSensors[given.sensor]);
  EXPECT_EQ(moved.last_before, SessionNamed(given.first_after - 1));
  EXPECT_EQ(moved.first_after, SessionNamed(given.first_after));
  EXPECT_NEAR(moved.step.head<3>().norm(), 0.005, 0.001);
}

INSTANTIATE_TEST_SUITE_P(
    Moves, MovedBetweenVisits,
    testing::Values(MoveBetween{"second_of_two", 1, 2, 1, 0.0}, MoveBetween{"reference", 0, 2, 1, 0.0},
                    MoveBetween{"second_of_three", 2, 3, 1, 2e-4}, MoveBetween{"newest_of_three", 2, 3, 2, 2e-4},
                    MoveBetween{"reference_of_three", 0, 3, 1, 2e-4}, MoveBetween{"second_of_four", 1, 4, 1, 2e-4},
                    MoveBetween{"second_of_five", 1, 5, 1, 2e-4}, MoveBetween{"newest_of_six", 2, 6, 5, 2e-4},
                    MoveBetween{"middle_of_six", 1, 6, 3, 2e-4}),
    [](const auto& one) { return one.param.name; });

TEST(MovedBetween, ScatterOfVisitsAccusesNobody) {
  Random random(10);
  int accused = 0;
  for (int robot = 0; robot < 100; ++robot)
    accused +=
        Visits(2 + robot % 7, Truth(), 3e-4, 1.7e-4, CovarianceOf(1e-4, 1e-4), random).Fused().fused.moved.empty() ? 0
                                                                                                                   : 1;
  EXPECT_LE(accused, 1);
}

// Nothing tells yet what these scatter by: by what the visits themselves err by most of them would have moved.
TEST(MovedBetween, ScatterOfTwoVisitsAccusesNobody) {
  Random random(11);
  int accused = 0;
  for (int robot = 0; robot < 400; ++robot)
    accused += Visits(2, Truth(), 5e-4, 3.5e-4, CovarianceOf(2e-4, 1.7e-4), random).Fused().fused.moved.empty() ? 0 : 1;
  EXPECT_LE(accused, 1);
}

// A mount that gives along one axis only: what six numbers would show of the scatter is what one shows.
TEST(MovedBetween, ScatterOfVisitsAlongOneAxisAccusesNobody) {
  Random random(28);
  int accused = 0;
  constexpr int kRobots = 750;
  const Eigen::Vector3d along = Eigen::Vector3d(1, -1, 1).normalized();  // as of a camera that is mounted tilted
  for (int robot = 0; robot < kRobots; ++robot) {
    Robot one;
    for (int k = 0; k < 4 + robot % 5; ++k) {
      std::vector<Se3> places = Truth();
      places[1] =
          places[1] * Se3::Exp((Vector6d() << 2e-3 * random.Normal(1)[0] * along, Eigen::Vector3d::Zero()).finished());
      one.Add(Drawn(k, places, CovarianceOf(1e-4, 1e-4), random));
    }
    accused += one.Fused().fused.moved.empty() ? 0 : 1;
  }
  EXPECT_LE(accused, kRobots / 200);  // 34 of 1,500 where all axes are taken to scatter alike
}

}  // namespace
}  // namespace rigcal::graph
