// Sessions that were refined in parts which nothing in them ties together.
#include <gtest/gtest.h>

#include "server/model/graph/connected.h"
#include "tests/unit/graph/fusion/drawn_visits.h"

namespace rigcal::graph {
namespace {

const SensorId kRearA("rear_a"), kRearB("rear_b");

Se3 T_a_b() { return Pose(0.3, -0.2); }
Se3 T_base_rear_a() { return Pose(-0.7, 3.0); }

Edge EdgeBetween(const SessionId& session, const SensorId& a, const SensorId& b, const Se3& T_a_b, double sigma) {
  Edge edge = GoodEdge(session, 0, 1, T_a_b, sigma, sigma);
  edge.frame_a = a, edge.frame_b = b;
  edge.id = EstimatedEdgeId(edge.robot, session.empty() ? SessionNamed(99) : session, edge.method, a, b);
  return edge;
}

// Two poses against one of them, drawn by a covariance of 0.1 mm and 0.1 mrad.
SessionEstimate Island(int k, const Se3& T_a_b, Random& random) {
  SessionEstimate island;
  island.reference = kRearA;
  island.covariance = 1e-8 * Matrix6d::Identity();
  const Vector6d e = random.Of(island.covariance);
  island.poses = {{kRearA, {}, 0.0}, {kRearB, T_a_b * Se3::Exp(e), 200.0}};
  island.session = SessionNamed(k);
  return island;
}

// Visits of base, left and right, and of two sensors behind; an edge that was pushed ties them.
struct RobotInParts {
  Robot robot;
  Random random{21};

  void Visit(int k, const std::vector<Se3>& truth, const Se3& T_a_b) {
    robot.Add(Drawn(k, truth, CovarianceOf(1e-4, 1e-4), random));
    SessionEstimate& whole = robot.estimates.back();
    whole.made_by = "joint/20";
    whole.islands = {Island(k, T_a_b, random)};
    robot.edges.push_back(EdgeBetween(SessionNamed(k), kRearA, kRearB, T_a_b, 0.01));
  }
  // The newest as if it tied all of them.
  void MakeWhole() {
    SessionEstimate& whole = robot.estimates.back();
    const SessionEstimate island = whole.islands[0];
    whole.islands.clear();
    for (const RefinedPose& pose : island.poses)
      whole.poses.push_back({pose.sensor, T_base_rear_a() * pose.T_ref_sensor, 200.0});
    Eigen::MatrixXd C = 1e-8 * Eigen::MatrixXd::Identity(24, 24);
    C.topLeftCorner(12, 12) = whole.covariance;
    whole.covariance = C;
    Tie(whole.session);
  }
  void Tie(const SessionId& session) {
    robot.edges.push_back(EdgeBetween(session, kBase, kRearA, T_base_rear_a(), 2e-4));
  }
  // The newest visit first, as estimates go.
  [[nodiscard]] GraphSolution Fused() const {
    Robot newest_first = robot;
    std::reverse(newest_first.estimates.begin(), newest_first.estimates.end());
    newest_first.estimates = IslandsApart(newest_first.estimates);
    return newest_first.Fused();
  }
};

const SensorPose& PoseIn(const GraphSolution& solution, const SensorId& sensor) {
  return *std::find_if(solution.poses.begin(), solution.poses.end(),
                       [&](const SensorPose& pose) { return pose.sensor == sensor; });
}

TEST(Islands, FollowTheirSessionAsEstimatesOfIt) {
  RobotInParts one;
  one.Visit(0, Truth(), T_a_b());
  const auto apart = IslandsApart(one.robot.estimates);
  ASSERT_EQ(apart.size(), 2u);
  EXPECT_TRUE(apart[0].islands.empty());
  EXPECT_EQ(apart[1].session, SessionNamed(0));
  EXPECT_EQ(apart[1].made_by, "joint/20");
  EXPECT_EQ(apart[1].reference, kRearA);
}

TEST(Islands, AreFusedWithWhatTiesThem) {
  RobotInParts one;
  one.Visit(0, Truth(), T_a_b());
  one.Tie({});
  const GraphSolution solution = one.Fused();
  EXPECT_EQ(solution.fused.sessions, std::vector<SessionId>{SessionNamed(0)});
  EXPECT_EQ(solution.fused.made_by, std::vector<std::string>{"joint/20"});
  const SensorPose &a = PoseIn(solution, kRearA), &b = PoseIn(solution, kRearB);
  ASSERT_TRUE(a.fused && b.fused);
  const Se3 T_a_b_refined = one.robot.estimates[0].islands[0].poses[1].T_ref_sensor;
  EXPECT_LT((T_a_b_refined.Inverse() * a.T_ref_sensor.Inverse() * b.T_ref_sensor).Log().norm(), 1e-9);
  EXPECT_NEAR(a.covariance(0, 0), 4e-8, 1e-11);
}

// A pair of the session itself that ties two islands says what neither of them does.
TEST(Islands, ArePlacedByAPairOfTheSession) {
  RobotInParts one;
  one.Visit(0, Truth(), T_a_b());
  one.Tie(SessionNamed(0));
  const GraphSolution solution = one.Fused();
  ASSERT_FALSE(solution.fused.sessions.empty());
  EXPECT_LT((T_base_rear_a().Inverse() * PoseIn(solution, kRearA).T_ref_sensor).Log().norm(), 1e-9);
}

TEST(Islands, MovesBetweenVisitsAreFoundInEachOfThem) {
  const Se3 step = Se3::Exp((Vector6d() << 0.004, 0.003, 0, 0, 0.005, 0).finished());
  RobotInParts one;
  std::vector<Se3> after = Truth();
  after[1] = after[1] * step;
  for (int k = 0; k < 4; ++k) one.Visit(k, k < 2 ? Truth() : after, k < 3 ? T_a_b() : T_a_b() * step);
  one.Tie({});
  std::set<std::string> told;
  for (const SensorMovedBetween& moved : one.Fused().fused.moved)
    told.insert(moved.sensor.str() + " " + moved.first_after.str().substr(62));
  // Of two sensors by themselves the one against which the other is told may have moved as well.
  EXPECT_TRUE(told.contains("left 02"));
  EXPECT_TRUE(told.contains("rear_b 03") || told.contains("rear_a 03"));
  EXPECT_EQ(told.size(), 2u);
}

// What the newest visits tie, older ones may not, and the other way round.
struct TiedVisit {
  const char* name;
  int tied, visits, first_after;
  const char* moved;
};
class IslandsBesideWholeVisits : public testing::TestWithParam<TiedVisit> {};

TEST_P(IslandsBesideWholeVisits, MovesAreFoundAndDated) {
  const TiedVisit& given = GetParam();
  const bool is_rear = std::string(given.moved) == "rear_b";
  // Two sound mounts scatter by more than two visits of two sensors could tell from a smaller one.
  const double larger = is_rear && given.visits == 2 ? 3.0 : 1.0;
  const Se3 step = Se3::Exp(larger * (Vector6d() << 0.004, 0.003, 0, 0, 0.005, 0).finished());
  RobotInParts one;
  for (int k = 0; k < given.visits; ++k) {
    const bool after = k >= given.first_after;
    std::vector<Se3> truth = Truth();
    if (after && !is_rear) truth[1] = truth[1] * step;
    one.Visit(k, truth, after && is_rear ? T_a_b() * step : T_a_b());
    if (k == given.tied) one.MakeWhole();
  }
  one.Tie({});
  const auto moved = one.Fused().fused.moved;
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_TRUE(moved[0].sensor.str() == given.moved || (is_rear && moved[0].sensor == kRearA));
  EXPECT_EQ(moved[0].last_before, SessionNamed(given.first_after - 1));
  EXPECT_EQ(moved[0].first_after, SessionNamed(given.first_after));
}

INSTANTIATE_TEST_SUITE_P(
    Visits, IslandsBesideWholeVisits,
    testing::Values(TiedVisit{"first_of_ten", 0, 10, 5, "left"}, TiedVisit{"first_of_ten_rear", 0, 10, 5, "rear_b"},
                    TiedVisit{"last_of_six", 5, 6, 3, "left"}, TiedVisit{"last_of_six_rear", 5, 6, 3, "rear_b"},
                    TiedVisit{"first_of_two", 0, 2, 1, "left"}, TiedVisit{"first_of_two_rear", 0, 2, 1, "rear_b"},
                    TiedVisit{"second_of_two", 1, 2, 1, "left"}, TiedVisit{"second_of_two_rear", 1, 2, 1, "rear_b"}),
    [](const auto& one) { return one.param.name; });

TEST(Islands, WhoseReferenceIsNotFirstByNameAreDatedAlike) {
  const Se3 step = Se3::Exp((Vector6d() << 0.004, 0.003, 0, 0, 0.005, 0).finished());
  RobotInParts one;
  for (int k = 0; k < 6; ++k) {
    one.Visit(k, Truth(), k < 3 ? T_a_b() : T_a_b() * step);
    SessionEstimate& island = one.robot.estimates.back().islands[0];
    island.reference = kRearB;
    island.poses = {{kRearA, island.poses[1].T_ref_sensor.Inverse(), 200.0}, {kRearB, {}, 0.0}};
  }
  one.Tie({});
  const auto moved = one.Fused().fused.moved;
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_EQ(moved[0].last_before, SessionNamed(2));
  EXPECT_EQ(moved[0].first_after, SessionNamed(3));
}

// Nobody knows which of two that are told against each other scatters.
TEST(Islands, TheirReferenceIsAsUnsureAsWhatIsToldAgainstIt) {
  RobotInParts one;
  for (int k = 0; k < 8; ++k) {
    Vector6d off = Vector6d::Zero();
    off[0] = k % 2 == 0 ? 0.002 : -0.002;
    one.Visit(k, Truth(), T_a_b() * Se3::Exp(off));
  }
  one.Tie({});
  const GraphSolution solution = one.Fused();
  const SensorPose &a = PoseIn(solution, kRearA), &b = PoseIn(solution, kRearB);
  EXPECT_EQ(a.fused->sessions, 8);
  EXPECT_GT(a.covariance.trace(), 1e-6);
  EXPECT_GT(b.covariance.trace(), 1e-6);
}

TEST(Islands, WhatIsToldOfThemIsToldWithTheSession) {
  RobotInParts one;
  one.Visit(0, Truth(), T_a_b());
  SessionEstimate& whole = one.robot.estimates[0];
  whole.slants = {{SensorId("top"), 0.01, 0.001}};
  whole.islands[0].moved = {{kRearB, CaptureId("1"), CaptureId("2")}};
  whole.islands[0].bends = {{TargetId("board"), 0.001, 0.0001}};
  auto apart = IslandsApart(one.robot.estimates);
  EXPECT_EQ(apart[0].moved.size(), 1u);
  EXPECT_EQ(apart[0].bends.size(), 1u);
  EXPECT_TRUE(apart[1].moved.empty() && apart[1].bends.empty());
  whole.why_not = {{"invalid_input", "nothing ties the reference", ""}};
  apart = IslandsApart(one.robot.estimates);
  EXPECT_EQ(apart[0].moved.size(), 1u);
  EXPECT_EQ(apart[1].bends.size(), 1u);
}

TEST(Islands, ThatDidNotMoveAccuseNobody) {
  RobotInParts one;
  for (int k = 0; k < 4; ++k) one.Visit(k, Truth(), T_a_b());
  one.Tie({});
  EXPECT_TRUE(one.Fused().fused.moved.empty());
}

TEST(Connected, GroupsThatShareASensorAreOne) {
  const SensorId a("a"), b("b"), c("c"), d("d"), e("e");
  EXPECT_EQ(Connected({{d, e}, {a}, {b, c}, {}, {a, b}}), (std::vector<std::set<SensorId>>{{a, b, c}, {d, e}}));
  EXPECT_TRUE(Connected({}).empty());
}

}  // namespace
}  // namespace rigcal::graph
