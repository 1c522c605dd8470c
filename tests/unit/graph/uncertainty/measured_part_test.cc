// What is known of sensors whose edges leave directions open, and between two of them.
#include <gmock/gmock.h>

#include <Eigen/Dense>

#include "server/graph/solve/observability.h"
#include "server/graph/uncertainty/graph_jackknife.h"
#include "server/graph/uncertainty/joint_poses.h"
#include "tests/unit/graph/fixture.h"

namespace rigcal::graph {
namespace {

constexpr double kInformation = 1e6;

Matrix6d BlindAlong(int axis) {
  Matrix6d Omega = kInformation * Matrix6d::Identity();
  Omega(axis, axis) = 0.0;
  return Omega;
}

// Sensors 0, 1, 2 all tied to one another; 3 hangs on 0 by an edge that does not see one axis; 4 is fixed to 3, 0.4 m
// away and turned.
RandomRig OpenRig(int axis) {
  RandomRig rig = MakeRig(5, 4, 21);
  rig.graph.edges.clear();
  for (std::size_t k = 0; k < 3; ++k)
    rig.graph.edges.push_back(MakeEdge(k, k, (k + 1) % 3, rig.truth[k].Inverse() * rig.truth[(k + 1) % 3],
                                       kInformation * Matrix6d::Identity()));
  rig.truth[4] = rig.truth[3] * Se3::Exp((Vector6d() << 0.4, 0, 0, 0, 0.3, 0.9).finished());
  rig.graph.edges.push_back(MakeEdge(3, 0, 3, rig.truth[3], BlindAlong(axis)));
  rig.graph.edges.push_back(
      MakeEdge(4, 3, 4, rig.truth[3].Inverse() * rig.truth[4], kInformation * Matrix6d::Identity()));
  return rig;
}

// The same rig with an edge that sees that axis alone, and says next to nothing of it: every pose is known.
Graph Completed(Graph graph, const RandomRig& rig, int axis) {
  Matrix6d weak = Matrix6d::Zero();
  weak(axis, axis) = 1.0;
  graph.edges.push_back(MakeEdge(9, 0, 3, rig.truth[3], weak));
  return graph;
}

double RelativeDistance(const Matrix6d& C, const Matrix6d& expected) { return (C - expected).norm() / expected.norm(); }

TEST(MeasuredPart, HasTheCovarianceOfTheRestAndNothingAlongWhatIsOpen) {
  for (int axis = 0; axis < 6; ++axis) {
    const RandomRig rig = OpenRig(axis);
    const GraphSolution solution = Solve(rig.graph), whole = Solve(Completed(rig.graph, rig, axis));
    EXPECT_FALSE(solution.poses[2].measured_part);
    for (const std::size_t sensor : {3U, 4U}) {
      const SensorPose& pose = solution.poses[sensor];
      EXPECT_FALSE(pose.known);
      EXPECT_EQ(pose.covariance, Matrix6d::Zero());
      ASSERT_TRUE(pose.measured_part && whole.poses[sensor].known) << axis;
      EXPECT_FALSE(pose.measured_part->by_jackknife);
      EXPECT_LT(Distance(pose.measured_part->T_ref_sensor, rig.truth[sensor]), 1e-9);
      const FreeBasis open = BasisOf(pose.unobservable_basis);
      EXPECT_LT((pose.measured_part->covariance * open).norm(), 1e-15);
      EXPECT_GT(whole.poses[sensor].covariance.diagonal().maxCoeff(), 0.1);  // what the weak edge says
      EXPECT_LT(
          RelativeDistance(pose.measured_part->covariance, CovarianceAcross(whole.poses[sensor].covariance, open)),
          1e-6)
          << axis << " " << sensor;
    }
  }
}

TEST(MeasuredPart, IsNoneWhereNothingWasMeasuredOrAskedFor) {
  RandomRig rig = OpenRig(2);
  SolveOptions quick;
  quick.marginals = false;
  EXPECT_FALSE(Solve(rig.graph, quick).poses[3].measured_part);
  rig.graph.sensors.push_back(Name(5));  // nothing ties it
  EXPECT_FALSE(Solve(rig.graph).poses[5].measured_part);
}

TEST(MeasuredPart, ByBlocksIsTheJackknifes) {
  constexpr int kAxis = 2;
  RandomRig rig = OpenRig(kAxis);
  std::mt19937 random(5);
  BlocksByEdge blocks;
  for (GraphEdge& edge : rig.graph.edges) {
    edge.session = SessionId(std::string(64, 'a'));
    for (int i = 0; i < 9; ++i) {
      Vector6d d = RandomVector(random, 1e-3, 1e-3);
      if (edge.rank < 6) d(kAxis) = 0.0;
      blocks[edge.id].blocks.push_back({std::to_string(i), d});
    }
    blocks[edge.id].dof = 8;
  }
  const Graph completed = Completed(rig.graph, rig, kAxis);
  GraphSolution solution = Solve(rig.graph), whole = Solve(completed);
  const Matrix6d analytic = solution.poses[4].measured_part->covariance;
  ApplyJackknifeCovariance(rig.graph, JackknifeGraph(rig.graph, solution, blocks), solution);
  ApplyJackknifeCovariance(completed, JackknifeGraph(completed, whole, blocks), whole);
  for (const std::size_t sensor : {3U, 4U}) {
    const SensorPose& pose = solution.poses[sensor];
    EXPECT_FALSE(pose.known || pose.by_jackknife);
    ASSERT_TRUE(pose.measured_part && pose.measured_part->by_jackknife && whole.poses[sensor].by_jackknife);
    EXPECT_LT(RelativeDistance(pose.measured_part->covariance,
                               CovarianceAcross(whole.poses[sensor].covariance, BasisOf(pose.unobservable_basis))),
              1e-6);
  }
  EXPECT_GT(RelativeDistance(solution.poses[4].measured_part->covariance, analytic), 0.1);
}

// Open in the same way they are known to each other, and to nobody else.
TEST(MeasuredPart, SensorsThatMoveAsOneAreKnownToEachOther) {
  const RandomRig rig = OpenRig(2);
  const GraphSolution solution = Solve(rig.graph);
  const RelativePose between = Relative(rig.graph, solution, Name(3), Name(4)).value();
  EXPECT_TRUE(between.unobservable_basis.empty());
  EXPECT_LT(Distance(between.T_A_B, rig.truth[3].Inverse() * rig.truth[4]), 1e-9);
  EXPECT_LT(RelativeDistance(between.covariance, Matrix6d::Identity() / kInformation), 1e-6);
}

TEST(MeasuredPart, BetweenTwoSensorsTellsWhatIsOpenOfTheirPose) {
  constexpr int kAxis = 5;
  const RandomRig rig = OpenRig(kAxis);
  const Graph completed = Completed(rig.graph, rig, kAxis);
  const GraphSolution solution = Solve(rig.graph), whole = Solve(completed);
  for (const auto& [a, b] : {std::pair(1U, 4U), std::pair(4U, 1U), std::pair(0U, 3U), std::pair(3U, 2U)}) {
    const RelativePose open = Relative(rig.graph, solution, Name(a), Name(b)).value();
    ASSERT_EQ(open.unobservable_basis.size(), 1U) << a << b;
    EXPECT_LT(Distance(open.T_A_B, rig.truth[a].Inverse() * rig.truth[b]), 1e-9);
    const Matrix6d C = Relative(completed, whole, Name(a), Name(b))->covariance;
    EXPECT_LT(RelativeDistance(open.covariance, CovarianceAcross(C, BasisOf(open.unobservable_basis))), 1e-6) << a << b;
    // The axis of the largest uncertainty is what the weak edge alone tells.
    const Vector6d direction = open.unobservable_basis[0].normalized();
    EXPECT_GT(direction.dot(C * direction), 0.99 * C.trace());
  }
}

TEST(MeasuredPart, HasNoPlaceAmongPosesThatAreKeptWhole) {
  const RandomRig rig = OpenRig(1);
  const GraphSolution solution = Solve(rig.graph);
  const JointPoses kept = JointPosesOf(rig.graph, solution, {});
  EXPECT_EQ(kept.T_ref_sensor.size(), 3U);
  EXPECT_FALSE(RelativeOf(kept, Name(0), Name(3)));
  EXPECT_TRUE(RelativeOf(kept, Name(0), Name(2)));
}

}  // namespace
}  // namespace rigcal::graph
