// What the experiments rest on: the linear prediction against graphs that are solved, poses composed along edges
// against moved edges, and a page that is the same for any number of threads.
#include <gtest/gtest.h>

#include <cmath>

#include "client/sim/rig/random.h"
#include "client/sim/rig/rig_yaml.h"
#include "server/math/covariance.h"
#include "tests/paper/experiment_json.h"
#include "tests/paper/paths.h"
#include "tests/paper/plots.h"
#include "tests/unit/graph/random.h"

namespace rigcal::paper {
namespace {

using Eigen::VectorXd;

// Edges at the truth, moved by d.
Graph Moved(const graph::RandomRig& rig, const VectorXd& d) {
  Graph graph = rig.graph;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    GraphEdge& edge = graph.edges[k];
    const Se3 &T_a = rig.truth[std::stoul(edge.frame_a.str())], &T_b = rig.truth[std::stoul(edge.frame_b.str())];
    edge.T_a_b = T_a.Inverse() * T_b * Se3::Exp(d.segment<6>(6 * static_cast<Eigen::Index>(k)));
  }
  return graph;
}

VectorXd SmallErrors(std::size_t edges) {
  sim::Random random(7);
  VectorXd d(6 * static_cast<Eigen::Index>(edges));
  for (double& value : d) value = 1e-6 * random.Normal();
  return d;
}

TEST(PaperLinearGraph, PosesAndErrorsAreThoseOfTheSolver) {
  const graph::RandomRig rig = graph::MakeRig(7, 15, 3);
  const VectorXd d = SmallErrors(15);
  const Graph graph = Moved(rig, d);
  const LinearGraph linear(graph, rig.truth);
  const VectorXd x = linear.Gain(WeightsOf(graph)) * d;
  const GraphSolution solution = graph::Solve(graph);
  for (std::size_t v = 1; v < 7; ++v) {
    const Vector6d error = (rig.truth[v].Inverse() * solution.poses[v].T_ref_sensor).Log();
    EXPECT_LT((error - x.segment<6>(6 * static_cast<Eigen::Index>(v - 1))).norm(), 1e-10) << v;
  }
  const double after = (linear.ResidualMap(WeightsOf(graph)) * d).squaredNorm() / 15;
  const double before = (linear.ResidualMap(TreeWeights(graph)) * d).squaredNorm() / 15;
  EXPECT_NEAR(solution.after.total, after, 1e-4 * after);
  EXPECT_NEAR(solution.before.total, before, 1e-4 * before);
}

TEST(PaperLinearGraph, SpreadIsThatOfDrawnSums) {
  const graph::RandomRig rig = graph::MakeRig(4, 6, 5);
  const Eigen::MatrixXd columns =
      LinearGraph(rig.graph, rig.truth).ResidualMap(WeightsOf(rig.graph)) * IndependentColumns(rig.graph);
  const Spread spread = SpreadOf(columns);
  constexpr int kDraws = 4000;
  sim::Random random(11);
  double sum = 0;
  for (int i = 0; i < kDraws; ++i) {
    VectorXd z(columns.cols());
    for (double& value : z) value = random.Normal();
    sum += (columns * z).squaredNorm();
  }
  const Interval interval = IntervalOf(kDraws * spread.dof);
  EXPECT_GT(sum / kDraws / spread.mean, interval.low);
  EXPECT_LT(sum / kDraws / spread.mean, interval.high);
  EXPECT_LT(interval.high - interval.low, 0.3);
}

Edge EdgeBetween(const char* a, const char* b, const Se3& T_a_b, const char* method) {
  Edge edge;
  edge.frame_a = SensorId(a);
  edge.frame_b = SensorId(b);
  edge.T_a_b = T_a_b;
  edge.method = method;
  edge.state = EdgeState::kGood;
  return edge;
}

TEST(PaperPaths, ErrorsOfEdgesAddUpAsTheComposedPoseMoves) {
  sim::Random random(3);
  const auto pose = [&] { return Se3::Exp(0.7 * random.Normals<6>()); };
  std::vector<Edge> edges = {EdgeBetween("a", "b", pose(), "x"), EdgeBetween("c", "b", pose(), "x"),
                             EdgeBetween("c", "d", pose(), "x"), EdgeBetween("a", "b", pose(), "y")};
  const std::vector<SensorId> sensors = {SensorId("a"), SensorId("b"), SensorId("c"), SensorId("d")};
  const auto path = FindPath(edges, sensors, {"y", "x", "x"});
  ASSERT_TRUE(path);
  const Se3 T = Compose(edges, *path);
  EXPECT_LT((T.Inverse() * edges[3].T_a_b * edges[1].T_a_b.Inverse() * edges[2].T_a_b).Log().norm(), 1e-12);
  const VectorXd d = SmallErrors(4);
  const Vector6d expected = ErrorMap(edges, *path) * d;
  for (std::size_t k = 0; k < edges.size(); ++k)
    edges[k].T_a_b = edges[k].T_a_b * Se3::Exp(d.segment<6>(6 * static_cast<Eigen::Index>(k)));
  EXPECT_LT(((T.Inverse() * Compose(edges, *path)).Log() - expected).norm(), 1e-9);
  EXPECT_GT(expected.norm(), 1e-7);
  EXPECT_FALSE(FindPath(edges, {SensorId("a"), SensorId("d")}));
  edges[1].state = EdgeState::kFailed;
  EXPECT_FALSE(FindPath(edges, sensors));
}

// Enough to connect all sensors, with a route and a pair of two methods among them.
std::vector<SensorPair> FewPairs() {
  std::vector<SensorPair> pairs;
  for (const auto& [a, b] :
       {std::pair("front_left", "front_right"), std::pair("left_front", "left_back"),
        std::pair("right_front", "right_back"), std::pair("up_left", "up_right"), std::pair("front_left", "left_front"),
        std::pair("left_front", "right_front"), std::pair("left_front", "up_left"), std::pair("left_front", "back"),
        std::pair("left_front", "lidar_vertical"), std::pair("left_front", "lidar_horizontal"),
        std::pair("lidar_vertical", "lidar_horizontal"), std::pair("left_front", "body"),
        std::pair("left_back", "body")})
    pairs.push_back({SensorId(a), SensorId(b)});
  return pairs;
}

// A small visit, as text.
std::string Document(int threads) {
  const auto rig = sim::LoadRig("mars-mapper");
  EXPECT_TRUE(rig);
  std::vector<Visit> visits;
  sim::Options options;
  options.captures = 12;
  options.tilt_rms_rad = 0.17;  // so few captures must be of very different directions
  VisitOptions how{2, threads, FewPairs()};
  auto visit = MakeVisit(*rig, options, how);
  EXPECT_TRUE(visit) << (visit ? "" : Sentence(visit.error()));
  if (!visit) return {};
  visits.push_back(std::move(*visit));
  const auto global = RunGlobalExperiment(visits, 20, 1);
  EXPECT_TRUE(global) << (global ? "" : Sentence(global.error()));
  if (!global) return {};
  const ChainExperiment chain = RunChainExperiment(visits);
  const MethodExperiment method = RunMethodExperiment(visits);
  std::string text = nlohmann::json{FiguresOf(*global), FiguresOf(chain), FiguresOf(method)}.dump();
  for (const PageFile& file : PageFiles("", {GlobalSection(*global), ChainSection(chain), MethodSection(method)}))
    text += file.text;
  return text;
}

TEST(PaperExperiment, IsTheSameForAnyNumberOfThreadsAndNeedsNothingFromElsewhere) {
  const std::string one = Document(1);
  EXPECT_EQ(one, Document(3));
  EXPECT_NE(one.find("E<sub>global</sub>"), std::string::npos);
  for (const char* foreign : {"<script", "href=\"http", "src=", "url(", "style=", "nan", "-inf"})
    EXPECT_EQ(one.find(foreign), std::string::npos) << foreign;
}

TEST(PaperPage, TextIsNotMarkup) { EXPECT_EQ(Escaped("a < b & c"), "a &lt; b &amp; c"); }

// What is asked for is all that is estimated.
TEST(PaperVisit, OnlyThePairsAskedForAreEstimated) {
  const auto rig = sim::LoadRig("mars-mapper");
  ASSERT_TRUE(rig);
  sim::Options options;
  options.captures = 12;
  VisitOptions how;
  how.only = {{SensorId("front_left"), SensorId("front_right")}};
  const auto visit = MakeVisit(*rig, options, how);
  ASSERT_TRUE(visit);
  ASSERT_EQ(visit->edges.size(), 1u);
  EXPECT_EQ(visit->edges[0].method, "stereo");
  ASSERT_EQ(visit->other_method.size(), 1u);
  EXPECT_EQ(visit->other_method[0].method, "non_overlapping");
  options.scale_ratio = 99;
  EXPECT_FALSE(MakeVisit(*rig, options, how));
}

TEST(PaperPlots, ValuesThatAreEqualOrZeroHaveAnAxis) {
  for (const double value : {0.0, 1.0, 1e-9})
    for (const Scale scale : {Scale::kLinear, Scale::kLogarithmic}) {
      const std::string svg = PlotStrips("t", "u", {{"a", "b"}}, {{"s", "#000", {{value, value}}, {value}}}, scale);
      EXPECT_EQ(svg.find("nan"), std::string::npos) << value;
      EXPECT_EQ(svg.find("inf"), std::string::npos) << value;
      EXPECT_NE(svg.find("<circle"), std::string::npos);
    }
}

}  // namespace
}  // namespace rigcal::paper
