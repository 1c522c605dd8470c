#include "server/graph/solve/observability.h"

#include <gmock/gmock.h>

#include "server/graph/solve/start_poses.h"
#include "tests/unit/graph/fixture.h"

namespace rigcal::graph {
namespace {

// Full information except for the given axes of frame b.
Matrix6d Blind(std::initializer_list<int> axes) {
  Matrix6d Omega = 1e6 * Matrix6d::Identity();
  for (const int axis : axes) Omega(axis, axis) = 0.0;
  return Omega;
}

// Three sensors known fully, 3 hangs on sensor 0 by a deficient edge.
RandomRig RigWithDeficientEdge(const Matrix6d& Omega) {
  RandomRig rig = MakeRig(4, 7, 50, 0.001, 0.001, false);
  std::erase_if(rig.graph.edges, [](const GraphEdge& e) { return e.frame_a == Name(3) || e.frame_b == Name(3); });
  for (std::size_t k = 0; k < 3; ++k)  // a triangle, whatever the random pairs were
    rig.graph.edges.push_back(
        MakeEdge(60 + k, k, (k + 1) % 3, rig.truth[k].Inverse() * rig.truth[(k + 1) % 3], 1e6 * Matrix6d::Identity()));
  rig.graph.edges.push_back(MakeEdge(70, 0, 3, rig.truth[3], Omega));
  return rig;
}

TEST(GraphObservability, AFreeAxisMakesTheSensorUnknownAndIsNamed) {
  const std::array<std::string, 6> names = {"translation along x", "translation along y", "translation along z",
                                            "rotation about x",    "rotation about y",    "rotation about z"};
  for (int axis = 0; axis < 6; ++axis) {
    const RandomRig rig = RigWithDeficientEdge(Blind({axis}));
    const GraphSolution solution = Solve(rig.graph);
    EXPECT_TRUE(solution.converged);
    EXPECT_TRUE(solution.poses[2].known);
    EXPECT_GT(solution.poses[2].covariance(0, 0), 0.0);
    EXPECT_FALSE(solution.poses[3].known);
    EXPECT_EQ(solution.poses[3].covariance, Matrix6d::Zero());
    ASSERT_TRUE(solution.poses[3].measured_part);
    EXPECT_LT((solution.poses[3].measured_part->covariance - Matrix6d(1e-12 * Blind({axis}))).norm(), 1e-12);
    ASSERT_EQ(solution.poses[3].unobservable_basis.size(), 1U);
    EXPECT_LT((solution.poses[3].unobservable_basis[0] - Vector6d::Unit(axis)).norm(), 1e-6) << axis;
    EXPECT_TRUE(solution.poses[2].unobservable_basis.empty());
    ASSERT_EQ(solution.diagnoses.size(), 1U);
    EXPECT_EQ(solution.diagnoses[0].code, "not_observable");
    EXPECT_EQ(solution.diagnoses[0].what, "the pose of sensor 3 is not fully determined: its edges leave free " +
                                              names[static_cast<std::size_t>(axis)] + " (in the axes of 3)");
    const int full_edges = static_cast<int>(rig.graph.edges.size()) - 1;
    EXPECT_EQ(solution.dof, 6 * full_edges + 5 - (6 * 3 - 1));
  }
}

Vector6d ResidualOf(const GraphSolution& solution, const EdgeId& id) {
  for (const EdgeResidual& residual : solution.residuals)
    if (residual.edge == id) return residual.e;
  ADD_FAILURE() << "no residual of " << id.str();
  return Vector6d::Zero();
}

// Turned on the spot: nothing is known along the axis z, nor about it, 0.3 m away.
TEST(GraphObservability, WhatAnEdgeLeavesOpenIsNoDisagreement) {
  Eigen::Matrix<double, 6, 2> open = Eigen::Matrix<double, 6, 2>::Zero();
  open(tangent::kZ, 0) = 1;
  open(tangent::kX, 1) = 0.3, open(tangent::kRz, 1) = 1;
  open.col(1).normalize();
  RandomRig rig = RigWithDeficientEdge(Blind({}));
  const GraphSolution without = Solve(rig.graph);
  const Vector6d off = 0.3 * open.col(0) + 0.02 * open.col(1);
  rig.graph.edges.push_back(MakeEdge(71, 0, 1, without.poses[1].T_ref_sensor * Se3::Exp(Vector6d(-off)),
                                     1e6 * (Matrix6d::Identity() - open * open.transpose())));
  const GraphSolution solution = Solve(rig.graph);
  EXPECT_LT(ResidualOf(solution, rig.graph.edges.back().id).norm(), 0.01);  // of second order in the 0.02
  const auto count = static_cast<double>(without.residuals.size());
  EXPECT_NEAR(solution.after.total, without.after.total * count / (count + 1), 1e-4 / count);
  EXPECT_LT(solution.before.total, 1e-3);
  rig.graph.edges.back().Omega = 1e-3 * Matrix6d::Identity();  // says something of every direction, if little
  EXPECT_GT(ResidualOf(Solve(rig.graph), rig.graph.edges.back().id).norm(), 0.29);
}

// A deficient edge takes nothing from what the others say, and adds nothing to sensors it cannot reach.
TEST(GraphObservability, KnownSensorsKeepTheirUncertainty) {
  const RandomRig rig = RigWithDeficientEdge(Blind({2, 5}));
  Graph without = rig.graph;
  without.edges.pop_back();
  const GraphSolution a = Solve(rig.graph), b = Solve(without);
  for (std::size_t v = 1; v < 3; ++v) {
    EXPECT_LT((a.poses[v].covariance - b.poses[v].covariance).norm(), 1e-9 * b.poses[v].covariance.norm());
    EXPECT_LT(Distance(a.poses[v].T_ref_sensor, b.poses[v].T_ref_sensor), 1e-10);
  }
}

TEST(GraphObservability, ASecondEdgeThatSeesTheAxisMakesItKnown) {
  RandomRig rig = RigWithDeficientEdge(Blind({2}));
  rig.graph.edges.push_back(MakeEdge(71, 1, 3, rig.truth[1].Inverse() * rig.truth[3], Blind({0})));
  const GraphSolution solution = Solve(rig.graph);
  EXPECT_TRUE(solution.poses[3].known);
  EXPECT_TRUE(solution.diagnoses.empty());
  EXPECT_LT(Distance(solution.poses[3].T_ref_sensor, rig.truth[3]), 0.01);
}

// Two edges with the same blind axis, turned against each other by 2 mrad of noise, seem to see it: they do not.
TEST(GraphObservability, NoiseDoesNotInventInformation) {
  RandomRig rig = RigWithDeficientEdge(Blind({2}));
  Vector6d noise = Vector6d::Zero();
  noise(tangent::kRx) = 0.002;
  rig.graph.edges.push_back(MakeEdge(71, 1, 3, rig.truth[1].Inverse() * rig.truth[3] * Se3::Exp(noise), Blind({2})));
  const GraphSolution solution = Solve(rig.graph);
  EXPECT_FALSE(solution.poses[3].known);
  ASSERT_FALSE(solution.diagnoses.empty());
  EXPECT_THAT(solution.diagnoses[0].what, testing::HasSubstr("leave free translation along z"));
}

// Sensors tied rigidly to one that is not observable are not observable either; the direction is told in their own
// axes.
TEST(GraphObservability, WhatHangsOnAFreeSensorIsFreeToo) {
  RandomRig rig = RigWithDeficientEdge(Blind({0}));
  rig.graph.sensors.push_back(Name(4));
  Se3 T_3_4;
  T_3_4.q = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ());  // x of 3 is -y of 4
  rig.graph.edges.push_back(MakeEdge(72, 3, 4, T_3_4, 1e6 * Matrix6d::Identity()));
  const GraphSolution solution = Solve(rig.graph);
  EXPECT_FALSE(solution.poses[4].known);
  ASSERT_EQ(solution.diagnoses.size(), 2U);
  EXPECT_THAT(solution.diagnoses[1].what, testing::HasSubstr("sensor 4 is not fully determined: its edges leave free "
                                                             "translation along y"));
  const auto relative = Relative(rig.graph, solution, Name(0), Name(4));
  ASSERT_TRUE(relative.has_value());
  EXPECT_THAT(relative->unobservable_basis, testing::SizeIs(1));
}

TEST(GraphObservability, BytesDoNotDependOnTheOrderOfEdges) {
  RandomRig rig = RigWithDeficientEdge(Blind({0, 1, 5}));
  const GraphSolution first = Solve(rig.graph);
  std::mt19937 random(51);
  for (int round = 0; round < 5; ++round) {
    std::shuffle(rig.graph.edges.begin(), rig.graph.edges.end(), random);
    EXPECT_TRUE(SameBytes(first, Solve(rig.graph)));
  }
}

TEST(GraphObservability, DirectionsAreNamedInWords) {
  FreeBasis basis(6, 1);
  basis << 0.6, 0.8, 0.0, 0.0, 0.0, 0.0;
  EXPECT_EQ(NameDirections(basis), "translation along (0.60, 0.80, 0.00)");
  basis << 0.0, 0.0, 0.5, 0.0, 0.0, 1.0;
  EXPECT_EQ(NameDirections(basis), "rotation about z coupled with translation along z");
  FreeBasis two(6, 2);
  two.setZero();
  two(tangent::kX, 0) = two(tangent::kRz, 0) = two(tangent::kX, 1) = 1.0;
  two(tangent::kRz, 1) = -1.0;
  EXPECT_EQ(NameDirections(two), "rotation about z and translation along x");
}

// The basis is metres and radians whatever the size of the rig: 4 m long edges, rotation about an axis 2 m away.
TEST(GraphObservability, TheBasisIsInMetresAndRadians) {
  RandomRig rig = RigWithDeficientEdge(Blind({5}));
  for (GraphEdge& edge : rig.graph.edges) edge.T_a_b.p_m *= 4.0;
  rig.graph.sensors.push_back(Name(4));
  Se3 T_3_4;
  T_3_4.p_m.x() = 2.0;  // turning 3 about its z moves 4 along its y, 2 m for each radian
  rig.graph.edges.push_back(MakeEdge(72, 3, 4, T_3_4, 1e6 * Matrix6d::Identity()));
  const Problem problem = MakeProblem(rig.graph);
  const Observability observability = Observe(problem, SpanningTreePoses(problem));
  ASSERT_EQ(observability.nullity, 1);
  const auto vertex = static_cast<std::size_t>(problem.vertex_of_sensor[4]);
  const FreeBasis& basis = observability.free_of_vertex[vertex];
  ASSERT_EQ(basis.cols(), 1);
  EXPECT_NEAR(basis(tangent::kY, 0) / basis(tangent::kRz, 0), 2.0, 1e-9);
  EXPECT_NEAR(basis(tangent::kX, 0), 0.0, 1e-9);
  const std::vector<Vector6d> said = Solve(rig.graph).poses[4].unobservable_basis;
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0](tangent::kRz), 1.0);
  EXPECT_NEAR(said[0](tangent::kY), 2.0, 1e-6);
}

// A sensor held by two deficient edges that complete each other stays known beside one that is free.
TEST(GraphObservability, NoiseOnFreeSensorsDoesNotTaintHeldOnes) {
  RandomRig rig = RigWithDeficientEdge(Blind({2}));
  std::mt19937 random(52);
  rig.graph.sensors.push_back(Name(4));
  const Se3 T_0_4 = Se3::Exp(RandomVector(random, 0.5, 0.5));
  const auto noisy = [&] { return Se3::Exp(RandomVector(random, 0.001, 0.002)); };
  rig.graph.edges.push_back(MakeEdge(80, 0, 4, T_0_4 * noisy(), Blind({0})));
  rig.graph.edges.push_back(MakeEdge(81, 1, 4, rig.truth[1].Inverse() * T_0_4 * noisy(), Blind({1})));
  rig.graph.edges.push_back(MakeEdge(82, 4, 3, T_0_4.Inverse() * rig.truth[3] * noisy(), Blind({2})));
  const GraphSolution solution = Solve(rig.graph);
  EXPECT_TRUE(solution.converged);
  EXPECT_FALSE(solution.poses[3].known);
  EXPECT_TRUE(solution.poses[4].known);
  EXPECT_LT(Distance(solution.poses[4].T_ref_sensor, T_0_4), 0.02);
}

// A robot on a flat floor: every edge leaves the height open, each along an axis of its own that is off by noise. What
// the axes seem to say together of the heights does not keep the rest from settling.
TEST(GraphObservability, ADirectionThatAllLeaveNearlyOpenDoesNotKeepTheRestFromSettling) {
  std::mt19937 random(53);
  Graph graph{Name(0), {}, {}};
  std::vector<Se3> truth;
  for (std::size_t v = 0; v < 10; ++v) {
    graph.sensors.push_back(Name(v));
    truth.push_back(
        v == 0 ? Se3()
               : Se3::Exp((Vector6d() << RandomVector(random, 0.5, 0).head<3>(), 0, 0, 0.6 * static_cast<double>(v))
                              .finished()));
  }
  for (std::size_t a = 0, k = 0; a < truth.size(); ++a)
    for (std::size_t b = a + 1; b < truth.size(); ++b)
      graph.edges.push_back(MakeEdge(
          k++, a, b, truth[a].Inverse() * truth[b] * Se3::Exp(RandomVector(random, 0.002, 0.002)), Blind({2})));
  const GraphSolution solution = Solve(graph);
  EXPECT_TRUE(solution.converged);
  EXPECT_LE(solution.iterations, 10);
  EXPECT_LT(solution.cost, 2 * 1e6 * 45 * 5 * 0.002 * 0.002);
  for (std::size_t v = 1; v < truth.size(); ++v) {
    EXPECT_FALSE(solution.poses[v].known) << v;
    ASSERT_EQ(solution.poses[v].unobservable_basis.size(), 1U) << v;
    EXPECT_LT((solution.poses[v].unobservable_basis[0] - Vector6d::Unit(2)).norm(), 0.02) << v;
    ASSERT_TRUE(solution.poses[v].measured_part) << v;
    const Vector6d off = (truth[v].Inverse() * solution.poses[v].measured_part->T_ref_sensor).Log();
    EXPECT_LT(off.head<2>().norm() + off.tail<3>().norm(), 0.01) << v;
  }
}

// A long chain of deficient edges is more than is judged: said so, sensor by sensor, and quickly.
TEST(GraphObservability, TooManyDeficientEdgesAreNotJudged) {
  Graph graph{Name(0), {Name(0)}, {}};
  Se3 T;
  T.p_m.x() = 1.0;
  for (std::size_t k = 0; k < 300; ++k) {
    graph.sensors.push_back(Name(k + 1));
    graph.edges.push_back(MakeEdge(k, k, k + 1, T, Blind({0})));
  }
  const GraphSolution solution = Solve(graph);
  EXPECT_FALSE(solution.poses[1].known);
  EXPECT_FALSE(solution.poses[1].measured_part);
  ASSERT_EQ(solution.diagnoses.size(), 300U);
  EXPECT_EQ(solution.diagnoses[0].code, "not_judged");
  EXPECT_THAT(solution.diagnoses[0].what, testing::HasSubstr("the pose of sensor 1 cannot be judged"));
}

}  // namespace
}  // namespace rigcal::graph
