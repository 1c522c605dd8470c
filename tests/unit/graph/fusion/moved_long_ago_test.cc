// Whether a sensor was moved between two visits, where there were many since.
#include <gtest/gtest.h>

#include <algorithm>

#include "server/model/edges/past.h"
#include "tests/unit/graph/fusion/drawn_visits.h"

namespace rigcal::graph {
namespace {

constexpr int kVisitsFused = 32;
constexpr double kAside_m = 0.006;

std::vector<Se3> WithLeftAside() {
  std::vector<Se3> places = Truth();
  places[1] = places[1] * Se3::Exp((Vector6d() << 0, kAside_m, 0, 0, 0, 0).finished());
  return places;
}

// From visit `first_after` on the left one sits aside.
Robot MovedBefore(int first_after, int visits, double scatter_m = 2e-4) {
  Random random(31);
  Robot robot;
  for (int k = 0; k < visits; ++k)
    robot.Add(Drawn(k, Scattered(k < first_after ? Truth() : WithLeftAside(), scatter_m, scatter_m / 2, random),
                    CovarianceOf(1e-4, 1e-4), random));
  return robot;
}

std::vector<SensorMovedBetween> MovesOf(Robot robot) {
  std::reverse(robot.estimates.begin(), robot.estimates.end());  // the newest first
  const GraphSolution start = Solve(GraphOf(robot.edges, kBase));
  return FindMovesBetween({robot.edges, {}, kBase, start}, robot.estimates).moved;
}

void ExpectLeftMoved(const std::vector<SensorMovedBetween>& moves, int last_before, int first_after) {
  ASSERT_EQ(moves.size(), 1U);
  EXPECT_EQ(moves.front().sensor, kLeft);
  EXPECT_EQ(moves.front().last_before, SessionNamed(last_before));
  EXPECT_EQ(moves.front().first_after, SessionNamed(first_after));
  EXPECT_NEAR(moves.front().step.head<3>().norm(), kAside_m, 0.001);
}

TEST(MovedLongAgo, IsNamedHoweverManyVisitsCameSince) {
  for (int since = 1; since <= kVisitsFused - 10; ++since) {
    SCOPED_TRACE(std::to_string(since) + " visits since");
    ExpectLeftMoved(MovesOf(MovedBefore(10, 10 + since)), 9, 10);
  }
}

TEST(MovedLongAgo, IsNamedWhileOneVisitFromBeforeIsFused) {
  for (const int before : {5, 3, 2, 1}) {
    SCOPED_TRACE(std::to_string(before) + " visits before");
    ExpectLeftMoved(MovesOf(MovedBefore(before, kVisitsFused)), before - 1, before);
  }
  EXPECT_TRUE(MovesOf(MovedBefore(0, kVisitsFused)).empty());
}

// Few visits do not tell a step from such a scatter, more do.
TEST(MovedLongAgo, OfAMountThatScattersIsNamed) {
  const std::vector<SensorMovedBetween> moves = MovesOf(MovedBefore(10, kVisitsFused, 1e-3));
  ASSERT_EQ(moves.size(), 1U);
  EXPECT_EQ(moves.front().sensor, kLeft);
  EXPECT_EQ(moves.front().last_before, SessionNamed(9));
  EXPECT_NEAR(moves.front().step.head<3>().norm(), kAside_m, 0.0015);
}

// What is between tells nothing of it, and few visits in a row tell of it on both sides.
TEST(MovedLongAgo, OfASensorThatFewVisitsTellIsNamed) {
  Robot all = MovedBefore(17, kVisitsFused), robot;
  for (std::size_t k = 0; k < all.estimates.size(); ++k) {
    SessionEstimate& one = all.estimates[k];
    if (k % 8 == 0) {
      robot.Add(one);
      continue;
    }
    robot.edges.push_back(GoodEdge(one.session, 0, 2, one.poses[2].T_ref_sensor, 0.01, 0.01));
    std::erase_if(one.poses, [](const RefinedPose& pose) { return pose.sensor == kLeft; });
    one.covariance = Eigen::MatrixXd(one.covariance.bottomRightCorner(6, 6));
    robot.estimates.push_back(one);
  }
  ExpectLeftMoved(MovesOf(robot), 16, 24);
}

// The visits from before tell the rest against each other. Of two sensors nobody can tell which one was moved.
TEST(MovedLongAgo, IsNamedThoughTheReferenceWasRemountedSince) {
  Robot robot = MovedBefore(10, 20);
  for (Edge& edge : robot.edges)
    if (edge.frame_a == kBase && edge.session < SessionNamed(15))
      edge.state = EdgeState::kFailed, edge.diagnoses = {{std::string(kRemountedCode), "", ""}};
  const std::vector<SensorMovedBetween> moves = MovesOf(robot);
  ASSERT_EQ(moves.size(), 1U);
  EXPECT_NE(moves.front().sensor, kBase);
  EXPECT_EQ(moves.front().last_before, SessionNamed(9));
  EXPECT_EQ(moves.front().first_after, SessionNamed(10));
}

TEST(MovedLongAgo, ManyVisitsThatScatterAccuseNobody) {
  int accused = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    accused += MovesOf(Visits(kVisitsFused, Truth(), 3e-4, 1.7e-4, CovarianceOf(1e-4, 1e-4), random)).empty() ? 0 : 1;
  }
  EXPECT_LE(accused, 1);
}

// A mount that gives by millimetres, along one axis only as well: no step of its visits is a move.
TEST(MovedLongAgo, ALooseMountIsNotAMove) {
  int accused = 0;
  constexpr int kRobots = 200;
  const Eigen::Vector3d along = Eigen::Vector3d(1, -1, 1).normalized();
  for (unsigned seed = 0; seed < kRobots; ++seed) {
    Random random(seed);
    Robot robot;
    for (int k = 0; k < kVisitsFused; ++k) {
      const Eigen::Vector3d off = random.Normal(3), given = seed % 2 == 0 ? Eigen::Vector3d(off[0] * along) : off;
      std::vector<Se3> places = Truth();
      places[1] = places[1] * Se3::Exp((Vector6d() << 2e-3 * given, Eigen::Vector3d::Zero()).finished());
      robot.Add(Drawn(k, places, CovarianceOf(1e-4, 1e-4), random));
    }
    accused += MovesOf(robot).empty() ? 0 : 1;
  }
  EXPECT_LE(accused, kRobots / 200);
}

}  // namespace
}  // namespace rigcal::graph
