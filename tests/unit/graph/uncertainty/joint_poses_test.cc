// What a revision keeps of its poses says of every two sensors what deriving it again would.
#include "server/graph/uncertainty/joint_poses.h"

#include <gmock/gmock.h>

#include "tests/unit/graph/fixture.h"

namespace rigcal::graph {
namespace {

void ExpectSame(const RelativePose& x, const RelativePose& y, const std::string& what) {
  EXPECT_LT((x.T_A_B.Inverse() * y.T_A_B).Log().norm(), 1e-12) << what;
  EXPECT_LT((x.covariance - y.covariance).norm(), 1e-9 * y.covariance.norm() + 1e-30) << what;
}

TEST(JointPoses, OfAGraphWithoutBlocksAreTheAnalyticOnes) {
  const RandomRig rig = MakeRig(7, 15, 3, 0.001, 0.0005);
  const GraphSolution solution = Solve(rig.graph);
  const JointPoses poses = JointPosesOf(rig.graph, solution, {});
  ASSERT_EQ(poses.covariances.size(), 1u);
  for (const SensorId& a : rig.graph.sensors)
    for (const SensorId& b : rig.graph.sensors)
      ExpectSame(RelativeOf(poses, a, b).value(), Relative(rig.graph, solution, a, b).value(), a.str() + " " + b.str());
}

TEST(JointPoses, OfAGraphWithBlocksAreTheJackknifes) {
  RandomRig rig = MakeRig(6, 12, 4, 0.001, 0.0005);
  std::mt19937 random(5);
  BlocksByEdge blocks;
  for (GraphEdge& edge : rig.graph.edges) {
    edge.session = SessionId(std::string(64, 'a'));
    for (int i = 0; i < 9; ++i) blocks[edge.id].blocks.push_back({std::to_string(i), RandomVector(random, 1e-4, 1e-4)});
    blocks[edge.id].dof = 8;
  }
  GraphSolution solution = Solve(rig.graph);
  const GraphJackknife jackknife = JackknifeGraph(rig.graph, solution, blocks);
  ASSERT_TRUE(jackknife.available);
  const JointPoses poses = JointPosesOf(rig.graph, solution, jackknife);
  for (const SensorId& a : rig.graph.sensors)
    for (const SensorId& b : rig.graph.sensors)
      ExpectSame(RelativeOf(poses, a, b).value(), RelativeByJackknife(jackknife, solution, a, b).value(),
                 a.str() + " " + b.str());
}

// The fused sessions' covariance comes first; a sensor that they do not have is told by the graph's.
TEST(JointPoses, FusedSensorsAreToldByTheirOwnCovariance) {
  const RandomRig rig = MakeRig(5, 9, 6, 0.001, 0.0005);
  GraphSolution solution = Solve(rig.graph);
  std::vector<SensorId> free;
  for (const SensorId& sensor : rig.graph.sensors)
    if (sensor != rig.graph.reference) free.push_back(sensor);
  solution.fused.sensors = {free[0], free[1]};
  solution.fused.covariance = 4e-8 * Eigen::MatrixXd::Identity(12, 12);
  const JointPoses poses = JointPosesOf(rig.graph, solution, {});
  ASSERT_EQ(poses.covariances.size(), 2u);
  EXPECT_LT((RelativeOf(poses, rig.graph.reference, free[1])->covariance - 4e-8 * Matrix6d::Identity()).norm(), 1e-15);
  ExpectSame(RelativeOf(poses, free[0], free[2]).value(), Relative(rig.graph, solution, free[0], free[2]).value(),
             "mixed");
}

// More sensors than a revision keeps the covariance of, and more pairs than are worked out at once.
TEST(JointPoses, PairsOfManySensorsAreToldAsAQueryTellsThem) {
  const RandomRig rig = MakeRig(kJointPosesMax + 6, 200, 8, 0.001, 0.0005);
  const GraphSolution solution = Solve(rig.graph);
  const JointPoses poses = JointPosesOf(rig.graph, solution, {});
  ASSERT_TRUE(poses.covariances.empty());
  std::vector<SensorPair> pairs = {{SensorId("nobody"), rig.graph.reference}};
  for (std::size_t i = 1; i < rig.graph.sensors.size(); ++i)
    pairs.push_back({rig.graph.sensors[i - 1], rig.graph.sensors[i]});
  const PairCovariances covariances = CovariancesOfPairs(pairs, poses, rig.graph, solution, {});
  EXPECT_EQ(covariances.size(), pairs.size() - 1);
  for (const auto& [pair, covariance] : covariances) {
    const Matrix6d wanted = Relative(rig.graph, solution, pair.a, pair.b)->covariance;
    EXPECT_LT((covariance - wanted).norm(), 1e-7 * wanted.norm()) << pair.a.str() << " " << pair.b.str();
  }
}

TEST(JointPoses, PairsOfFewSensorsAreTakenFromWhatIsKept) {
  const RandomRig rig = MakeRig(5, 9, 6, 0.001, 0.0005);
  const GraphSolution solution = Solve(rig.graph);
  const JointPoses poses = JointPosesOf(rig.graph, solution, {});
  const SensorPair pair{rig.graph.sensors[1], rig.graph.sensors[3]};
  const PairCovariances covariances = CovariancesOfPairs({pair}, poses, rig.graph, solution, {});
  ASSERT_EQ(covariances.size(), 1u);
  EXPECT_EQ(covariances.at(pair), RelativeOf(poses, pair.a, pair.b)->covariance);
}

TEST(JointPoses, WhatIsNotKnownHasNoAnswer) {
  const RandomRig rig = MakeRig(4, 5, 7, 0.001, 0.0005);
  GraphSolution solution = Solve(rig.graph);
  for (SensorPose& pose : solution.poses)
    if (pose.sensor == rig.graph.sensors.back()) pose.known = false;
  const JointPoses poses = JointPosesOf(rig.graph, solution, {});
  EXPECT_FALSE(RelativeOf(poses, rig.graph.sensors.front(), rig.graph.sensors.back()));
  EXPECT_FALSE(RelativeOf(poses, SensorId("nobody"), rig.graph.reference));
}

}  // namespace
}  // namespace rigcal::graph
