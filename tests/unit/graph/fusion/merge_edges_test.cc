// Older edges of a pair as one: the whole history's answer at the cost of the newest.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "server/graph/fusion/merged_edge.h"
#include "server/graph/uncertainty/graph_jackknife.h"
#include "tests/unit/graph/fusion/drawn_pairs.h"

namespace rigcal::graph {
namespace {

struct History {
  std::vector<Edge> edges;
  std::map<EdgeId, Stamp> measured_at;
};

enum class Kind { kBlocks, kMixed, kPlain };

class Weeks {
 public:
  Weeks(double sigma, Kind kind) : sigma_(sigma), kind_(kind) {
    for (const char* sensor : {"a", "b", "c", "d"}) T_world_[SensorId(sensor)] = Se3::Exp(Normals(0.5));
  }

  // One edge of each pair, `week` weeks after the first.
  void Add(int week, History& history) {
    for (std::size_t pair = 0; pair < kPairs.size(); ++pair) {
      Edge edge = Measured(SensorId(kPairs[pair].first), SensorId(kPairs[pair].second),
                           (week + static_cast<int>(pair)) % 2 == 0);
      edge.id = PushedEdgeId(kRobot, ContentDigest(edge), 0);
      history.measured_at[edge.id] = Stamp{1'000'000'000LL * (1 + week)};
      history.edges.push_back(std::move(edge));
    }
  }

  Edge Measured(const SensorId& a, const SensorId& b, bool blocks) {
    Edge edge;
    edge.robot = kRobot;
    edge.frame_a = a, edge.frame_b = b;
    edge.method = "stereo";
    edge.state = EdgeState::kGood;
    edge.T_a_b = T_world_[a].Inverse() * T_world_[b] * Se3::Exp(Normals(sigma_));
    Matrix6d root;
    for (int i = 0; i < 6; ++i) root.col(i) = Normals(sigma_);
    edge.uncertainty = *FromCovariance(root * root.transpose() + sigma_ * sigma_ * Matrix6d::Identity(),
                                       UncertaintySource::kJackknife, 15);
    if (kind_ == Kind::kBlocks || (kind_ == Kind::kMixed && blocks)) AddBlocks(edge.uncertainty);
    return edge;
  }

 private:
  void AddBlocks(Uncertainty& uncertainty) {
    for (int k = 0; k < 16; ++k) uncertainty.blocks.push_back({std::to_string(k), Normals(sigma_ / 4)});
    const Vector6d board = Normals(sigma_ / 3), lens = Normals(sigma_ / 3);
    uncertainty.contributions = {{"board", board * board.transpose(), {board}}, {"lens", lens * lens.transpose()}};
  }
  Vector6d Normals(double sigma) {
    return Vector6d::NullaryExpr([&] { return sigma * std::normal_distribution<double>()(random_); });
  }

  double sigma_;
  Kind kind_;
  std::mt19937 random_{7};
  std::map<SensorId, Se3> T_world_;
};

struct Answer {
  GraphSolution solution;
  std::map<std::pair<std::string, std::string>, Matrix6d> relative;
};

Answer AnswerOf(const std::vector<Edge>& edges) {
  const Graph graph = GraphOf(edges, SensorId("a"));
  Answer answer{Solve(graph), {}};
  const GraphJackknife jackknife = JackknifeGraph(graph, answer.solution, BlocksOf(edges));
  ApplyJackknifeCovariance(graph, jackknife, answer.solution);
  if (!jackknife.available) return answer;
  for (const auto& [a, b] : {std::pair("b", "c"), std::pair("b", "d")})
    answer.relative[{a, b}] = RelativeByJackknife(jackknife, answer.solution, SensorId(a), SensorId(b))->covariance;
  return answer;
}

std::vector<Edge> WithMerged(const std::vector<MergedEdge>& merged, std::vector<Edge> edges) {
  for (const MergedEdge& one : merged) edges.push_back(EdgeOf(one, kRobot));
  return edges;
}

void Take(const Merge& merge, std::vector<Edge>& edges) {
  std::erase_if(edges, [&](const Edge& edge) {
    return std::find(merge.taken.begin(), merge.taken.end(), edge.id) != merge.taken.end();
  });
}

// One week more, of which `window` keeps the newest.
void AddWeek(int week, Weeks& weeks, History& history, std::vector<MergedEdge>& merged, std::vector<Edge>& window) {
  const std::size_t before = history.edges.size();
  weeks.Add(week, history);
  window.insert(window.end(), history.edges.begin() + static_cast<std::ptrdiff_t>(before), history.edges.end());
  const Merge merge = MergeOlderEdges(merged, window, history.measured_at);
  merged = merge.merged;
  Take(merge, window);
}

// Largest difference of poses, in sigmas, and of covariances, relative to their largest entry.
void ExpectSame(const Answer& whole, const Answer& window, double sigmas, double ratio) {
  ASSERT_EQ(whole.solution.poses.size(), window.solution.poses.size());
  for (std::size_t s = 1; s < whole.solution.poses.size(); ++s) {
    const SensorPose &x = whole.solution.poses[s], &y = window.solution.poses[s];
    const Vector6d d = (x.T_ref_sensor.Inverse() * y.T_ref_sensor).Log();
    const Vector6d sigma = x.covariance.diagonal().cwiseSqrt();
    EXPECT_LT(d.cwiseQuotient(sigma).cwiseAbs().maxCoeff(), sigmas) << x.sensor.str();
    EXPECT_LT((x.covariance - y.covariance).cwiseAbs().maxCoeff(), ratio * x.covariance.cwiseAbs().maxCoeff());
  }
  for (const auto& [pair, C] : whole.relative)
    EXPECT_LT((C - window.relative.at(pair)).cwiseAbs().maxCoeff(), ratio * C.cwiseAbs().maxCoeff());
}

class MergedHistory : public testing::TestWithParam<Kind> {};

TEST_P(MergedHistory, AnswersAsTheWholeOneWhereTheModelIsLinear) {
  Weeks weeks(1e-9, GetParam());
  History history;
  for (int week = 0; week < 100; ++week) weeks.Add(week, history);
  const Merge merge = MergeOlderEdges({}, history.edges, history.measured_at);
  std::vector<Edge> kept = history.edges;
  Take(merge, kept);
  ASSERT_EQ(kept.size(), kPairs.size() * kEdgesKeptOfPair);
  ExpectSame(AnswerOf(history.edges), AnswerOf(WithMerged(merge.merged, kept)), 1e-5, 1e-6);
}

TEST_P(MergedHistory, OfTenYearsIsWithinAHundredthOfASigma) {
  Weeks weeks(2e-4, GetParam());
  History history;
  std::vector<Edge> window;
  std::vector<MergedEdge> merged;
  for (int week = 0; week < 520; ++week) {
    AddWeek(week, weeks, history, merged, window);
    ASSERT_LE(window.size(), kPairs.size() * kEdgesKeptOfPair);
  }
  ExpectSame(AnswerOf(history.edges), AnswerOf(WithMerged(merged, window)), 0.01, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Kinds, MergedHistory, testing::Values(Kind::kBlocks, Kind::kMixed, Kind::kPlain));

TEST(MergeEdges, WeekByWeekAndAllAtOnceAreTheSame) {
  Weeks weeks(2e-4, Kind::kBlocks);
  History history;
  std::vector<MergedEdge> merged;
  std::vector<Edge> window;
  for (int week = 0; week < 30; ++week) AddWeek(week, weeks, history, merged, window);
  std::vector<Edge> reversed(history.edges.rbegin(), history.edges.rend());
  const Merge at_once = MergeOlderEdges({}, reversed, history.measured_at);
  ASSERT_EQ(at_once.merged.size(), merged.size());
  for (std::size_t k = 0; k < merged.size(); ++k)
    EXPECT_EQ(EdgeOf(at_once.merged[k], kRobot).id, EdgeOf(merged[k], kRobot).id);
}

class WrongEdge : public testing::TestWithParam<std::size_t> {};

// The oldest too: merging does not begin with it.
TEST_P(WrongEdge, ContradictsStaysAndIsTold) {
  Weeks weeks(2e-4, Kind::kBlocks);
  History history;
  for (int week = 0; week < 12; ++week) weeks.Add(week, history);
  Edge& wrong = history.edges[GetParam() * kPairs.size()];
  wrong.T_a_b = wrong.T_a_b * Se3::Exp(Vector6d::Constant(0.01));
  const Merge merge = MergeOlderEdges({}, history.edges, history.measured_at);
  EXPECT_EQ(merge.taken.size(), kPairs.size() * 4 - 1);
  EXPECT_EQ(std::find(merge.taken.begin(), merge.taken.end(), wrong.id), merge.taken.end());
  EXPECT_EQ(merge.merged[0].count, 3);
}

INSTANTIATE_TEST_SUITE_P(Weeks, WrongEdge, testing::Values(0, 2));

// What an edge says along a direction that it does not see is nothing, and contradicts nobody.
TEST(MergeEdges, WholeEdgesAgreeWithThoseThatLeaveADirectionOpen) {
  Weeks weeks(2e-4, Kind::kPlain);
  History history;
  for (int week = 0; week < 12; ++week) weeks.Add(week, history);
  for (std::size_t k = 0; k < history.edges.size(); k += 2) {
    Edge& edge = history.edges[k];
    Matrix6d Omega = edge.uncertainty.Omega;
    Omega.row(2).setZero(), Omega.col(2).setZero();
    edge.uncertainty = FromInformation(Omega, UncertaintySource::kGiven, 0);
    Vector6d away = Vector6d::Zero();
    away[2] = 0.3;
    edge.T_a_b = edge.T_a_b * Se3::Exp(away);
  }
  EXPECT_EQ(MergeOlderEdges({}, history.edges, history.measured_at).taken.size(), kPairs.size() * 4);
}

TEST(MergeEdges, WhatFailedOrBelongsToASessionStays) {
  Weeks weeks(2e-4, Kind::kPlain);
  History history;
  for (int week = 0; week < 12; ++week) weeks.Add(week, history);
  for (Edge& edge : history.edges)
    if (edge.frame_a == SensorId("a"))
      edge.state = EdgeState::kFailed;
    else if (edge.frame_a == SensorId("b"))
      edge.session = SessionId("s1");
  const Merge merge = MergeOlderEdges({}, history.edges, history.measured_at);
  ASSERT_EQ(merge.merged.size(), 1u);
  EXPECT_EQ(merge.merged[0].frame_a.str(), "c");
  EXPECT_EQ(merge.merged[0].count, 4);
}

TEST(MergeEdges, DirectionsThatNoEdgeSeesStayOpen) {
  Weeks weeks(2e-4, Kind::kPlain);
  History history;
  for (int week = 0; week < 12; ++week) weeks.Add(week, history);
  for (Edge& edge : history.edges) {
    Matrix6d Omega = edge.uncertainty.Omega;
    Omega.row(2).setZero(), Omega.col(2).setZero();
    edge.uncertainty = FromInformation(Omega, UncertaintySource::kGiven, 0);
  }
  for (const MergedEdge& one : MergeOlderEdges({}, history.edges, history.measured_at).merged) {
    const Edge edge = EdgeOf(one, kRobot);
    EXPECT_EQ(edge.uncertainty.rank, 5);
    EXPECT_TRUE(Validate(edge));
  }
}

}  // namespace
}  // namespace rigcal::graph
