// Older sessions as one edge per pair: the whole history's answer at the cost of the newest, though pairs of a session
// share captures.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "server/graph/fusion/merged_edge.h"
#include "server/graph/uncertainty/graph_jackknife.h"
#include "server/model/edges/weak_edge.h"
#include "tests/unit/graph/fusion/drawn_pairs.h"

namespace rigcal::graph {
namespace {

constexpr int kCaptures = 16;

// Sessions of four sensors. What a sensor saw in a capture errs alike in all its pairs; not every pair has every
// capture, and one pair of some sessions has none.
class Sessions {
 public:
  // `pairs`: of kPairs the first so many. `visit`: how the poses of a visit scatter besides, in sigmas.
  explicit Sessions(double sigma, std::size_t pairs = kPairs.size(), double visit = 0.0)
      : sigma_(sigma), pairs_(pairs), visit_(visit) {
    for (const char* sensor : {"a", "b", "c", "d"}) T_world_[sensor] = Se3::Exp(Normals(0.5));
  }

  void Add(int week) {
    const SessionId session("s" + std::to_string(1000 + week));
    std::map<std::string, std::vector<Vector6d>> of_sensor;
    for (const char* sensor : {"a", "b", "c", "d"})
      for (int k = 0; k < kCaptures; ++k) of_sensor[sensor].push_back(Normals(sigma_ / 4));
    for (std::size_t pair = 0; pair < pairs_; ++pair) {
      const auto& [a, b] = kPairs[pair];
      Edge edge = Measured(session, a, b);
      if (pair != 4 || week % 3 != 0)
        AddBlocks(of_sensor.at(a), of_sensor.at(b), static_cast<int>(pair), edge.uncertainty);
      Store(edge, week);
    }
    Edge failed;
    failed.frame_a = SensorId("a"), failed.frame_b = SensorId("d");
    failed.method = "stereo", failed.session = session;
    Store(failed, week);
  }

  std::vector<Edge> edges;
  std::map<EdgeId, Stamp> measured_at;

 private:
  void Store(Edge edge, int week) {
    edge.id = EstimatedEdgeId(kRobot, edge.session, edge.method, edge.frame_a, edge.frame_b);
    measured_at[edge.id] = Stamp{1'000'000'000LL * (1 + week)};
    edges.push_back(std::move(edge));
  }
  Edge Measured(const SessionId& session, const std::string& a, const std::string& b) {
    Edge edge;
    edge.robot = kRobot;
    edge.session = session;
    edge.frame_a = SensorId(a), edge.frame_b = SensorId(b);
    edge.method = "stereo";
    edge.state = EdgeState::kGood;
    edge.T_a_b = T_world_[a].Inverse() * T_world_[b] * Se3::Exp(Normals(sigma_)) * Se3::Exp(Normals(visit_ * sigma_));
    Matrix6d root;
    for (int i = 0; i < 6; ++i) root.col(i) = Normals(sigma_);
    edge.uncertainty = *FromCovariance(root * root.transpose() + sigma_ * sigma_ * Matrix6d::Identity(),
                                       UncertaintySource::kJackknife, 15);
    return edge;
  }
  void AddBlocks(const std::vector<Vector6d>& of_a, const std::vector<Vector6d>& of_b, int missing,
                 Uncertainty& uncertainty) {
    for (int k = 0; k < kCaptures; ++k)
      if (k != missing)
        uncertainty.blocks.push_back(
            {std::to_string(k), of_b[static_cast<std::size_t>(k)] - of_a[static_cast<std::size_t>(k)]});
    const Vector6d board = Normals(sigma_ / 3), lens = Normals(sigma_ / 3);
    uncertainty.contributions = {{"board", board * board.transpose(), {board}}, {"lens", lens * lens.transpose()}};
  }
  Vector6d Normals(double sigma) {
    return Vector6d::NullaryExpr([&] { return sigma * std::normal_distribution<double>()(random_); });
  }

  double sigma_;
  std::size_t pairs_;
  double visit_;
  std::mt19937 random_{11};
  std::map<std::string, Se3> T_world_;
};

struct Window {
  std::vector<MergedEdge> merged;
  std::vector<Edge> edges;

  void Take(const Merge& merge) {
    merged = merge.merged;
    const std::set<EdgeId> taken(merge.taken.begin(), merge.taken.end());
    std::erase_if(edges, [&](const Edge& edge) { return taken.contains(edge.id); });
  }
  [[nodiscard]] std::vector<Edge> All() const {
    std::vector<Edge> all = edges;
    for (const MergedEdge& one : merged) all.push_back(EdgeOf(one, kRobot));
    return all;
  }
};

struct Told {
  GraphSolution solution;
  GraphJackknife jackknife;
};

Told Tell(const std::vector<Edge>& edges) {
  const Graph graph = GraphOf(edges, SensorId("a"));
  Told told{Solve(graph), {}};
  told.jackknife = JackknifeGraph(graph, told.solution, BlocksOf(edges));
  EXPECT_TRUE(told.jackknife.available);
  return told;
}

// Poses in sigmas; the joint covariance, cross terms too, relative to its largest entry.
void ExpectSame(const Told& whole, const Told& window, double sigmas, double ratio) {
  for (std::size_t s = 1; s < whole.solution.poses.size(); ++s) {
    const SensorPose &x = whole.solution.poses[s], &y = window.solution.poses[s];
    const Vector6d sigma = x.covariance.diagonal().cwiseSqrt();
    EXPECT_LT((x.T_ref_sensor.Inverse() * y.T_ref_sensor).Log().cwiseQuotient(sigma).cwiseAbs().maxCoeff(), sigmas);
  }
  ASSERT_EQ(whole.jackknife.row_of_sensor, window.jackknife.row_of_sensor);
  EXPECT_LT((whole.jackknife.joint - window.jackknife.joint).cwiseAbs().maxCoeff(),
            ratio * whole.jackknife.joint.cwiseAbs().maxCoeff());
}

TEST(MergeSessions, AnswersAsTheWholeHistoryWhereTheModelIsLinear) {
  Sessions sessions(1e-9);
  for (int week = 0; week < 60; ++week) sessions.Add(week);
  Window window{{}, sessions.edges};
  window.Take(MergeOlderSessions({}, sessions.edges, sessions.measured_at));
  ASSERT_EQ(window.edges.size(), 6 * kSessionsKept);
  ASSERT_EQ(window.merged.size(), kPairs.size());
  EXPECT_LE(window.merged[0].scores.cols(), 30);
  ExpectSame(Tell(sessions.edges), Tell(window.All()), 1e-5, 1e-6);
}

TEST(MergeSessions, OfTenYearsIsWithinAHundredthOfASigma) {
  Sessions sessions(2e-4);
  Window window;
  for (int week = 0; week < 520; ++week) {
    const std::size_t before = sessions.edges.size();
    sessions.Add(week);
    window.edges.insert(window.edges.end(), sessions.edges.begin() + static_cast<std::ptrdiff_t>(before),
                        sessions.edges.end());
    window.Take(MergeOlderSessions(window.merged, window.edges, sessions.measured_at));
    ASSERT_LE(window.edges.size(), 6 * kSessionsKept);
  }
  ExpectSame(Tell(sessions.edges), Tell(window.All()), 0.01, 0.02);
}

TEST(MergeSessions, PairsOfAMergedSessionStillErrTogether) {
  Sessions sessions(1e-9);
  for (int week = 0; week < 30; ++week) sessions.Add(week);
  Window window{{}, sessions.edges};
  window.Take(MergeOlderSessions({}, sessions.edges, sessions.measured_at, 0));
  for (MergedEdge& one : window.merged) one.scores.resize(6, 0);
  const Told whole = Tell(sessions.edges), apart = Tell(window.All());
  EXPECT_GT((whole.jackknife.joint - apart.jackknife.joint).norm(), 0.1 * whole.jackknife.joint.norm());
}

TEST(MergeSessions, WeekByWeekAndAllAtOnceAreTheSame) {
  Sessions sessions(2e-4);
  Window window;
  for (int week = 0; week < 25; ++week) {
    const std::size_t before = sessions.edges.size();
    sessions.Add(week);
    window.edges.insert(window.edges.end(), sessions.edges.begin() + static_cast<std::ptrdiff_t>(before),
                        sessions.edges.end());
    window.Take(MergeOlderSessions(window.merged, window.edges, sessions.measured_at));
  }
  const std::vector<Edge> reversed(sessions.edges.rbegin(), sessions.edges.rend());
  const Merge at_once = MergeOlderSessions({}, reversed, sessions.measured_at);
  ASSERT_EQ(at_once.merged.size(), window.merged.size());
  for (std::size_t k = 0; k < window.merged.size(); ++k) {
    EXPECT_EQ(EdgeOf(at_once.merged[k], kRobot).id, EdgeOf(window.merged[k], kRobot).id);
    EXPECT_TRUE(at_once.merged[k].scores == window.merged[k].scores);
  }
}

TEST(MergeSessions, OneThatContradictsStaysWhole) {
  Sessions sessions(2e-4);
  for (int week = 0; week < 14; ++week) sessions.Add(week);
  for (const std::size_t week : {0UL, 3UL}) {
    std::vector<Edge> edges = sessions.edges;
    Edge& wrong = edges[6 * week + 1];
    wrong.T_a_b = wrong.T_a_b * Se3::Exp(Vector6d::Constant(0.01));
    const Merge merge = MergeOlderSessions({}, edges, sessions.measured_at);
    EXPECT_EQ(merge.taken.size(), 6 * 5u);
    for (const EdgeId& id : merge.taken) EXPECT_NE(id, wrong.id);
    for (const MergedEdge& one : merge.merged) EXPECT_EQ(one.count, 5);
  }
}

// Of the pair c - d the first `weak` weeks have clouds that hardly overlap.
std::vector<Edge> WithWeakWeeks(std::vector<Edge> edges, int weak) {
  int week = 0;
  for (Edge& edge : edges)
    if (edge.state == EdgeState::kGood && edge.frame_a.str() == "c" && edge.frame_b.str() == "d") {
      edge.method = "lidar_lidar";
      edge.figures["overlap_ratio"] = week++ < weak ? 0.31 : 0.9;
    }
  return edges;
}

const MergedEdge& OfPair(const Merge& merge, const std::string& a, const std::string& b) {
  return *std::find_if(merge.merged.begin(), merge.merged.end(),
                       [&](const MergedEdge& one) { return one.frame_a.str() == a && one.frame_b.str() == b; });
}

TEST(MergeSessions, WeakEdgesStayWeakAndAreLetGoForBetterOnes) {
  Sessions sessions(2e-4);
  for (int week = 0; week < 20; ++week) sessions.Add(week);
  const auto merged = [&](int weak) {
    return MergeOlderSessions({}, WithWeakWeeks(sessions.edges, weak), sessions.measured_at, 8);
  };
  const Merge all_weak = merged(20), none_weak = merged(0), begins_weak = merged(5);
  EXPECT_TRUE(OfPair(all_weak, "c", "d").weak);
  EXPECT_EQ(OfPair(all_weak, "c", "d").count, 12);
  EXPECT_FALSE(WhyWeak(EdgeOf(OfPair(all_weak, "c", "d"), kRobot)).empty());
  EXPECT_FALSE(OfPair(none_weak, "c", "d").weak);
  EXPECT_FALSE(OfPair(begins_weak, "c", "d").weak);
  EXPECT_EQ(OfPair(begins_weak, "c", "d").count, 7);
  EXPECT_EQ(OfPair(begins_weak, "b", "d").count, 12);
  EXPECT_EQ(begins_weak.taken.size(), none_weak.taken.size());
  EXPECT_TRUE(OfPair(MergeOlderSessions(all_weak.merged, {}, {}, 8), "c", "d").weak);
  const std::vector<Edge> later = WithWeakWeeks(sessions.edges, 20);
  const Merge then_weak =
      MergeOlderSessions(none_weak.merged, {later.end() - 8 * 6, later.end()}, sessions.measured_at, 0);
  EXPECT_EQ(OfPair(then_weak, "c", "d").count, 12);
  EXPECT_EQ(OfPair(then_weak, "b", "d").count, 20);
}

// It may be the only sign of a move.
TEST(MergeSessions, AWeakEdgeThatContradictsBetterOnesStays) {
  Sessions sessions(2e-4);
  for (int week = 0; week < 20; ++week) sessions.Add(week);
  std::vector<Edge> edges = WithWeakWeeks(sessions.edges, 0);
  Edge& wrong = edges[6 * 11 + 3];
  ASSERT_EQ(wrong.frame_a.str(), "c");
  wrong.figures["overlap_ratio"] = 0.31;
  wrong.T_a_b = wrong.T_a_b * Se3::Exp(Vector6d::Constant(0.01));
  const Merge merge = MergeOlderSessions({}, edges, sessions.measured_at, 8);
  EXPECT_EQ(std::count(merge.taken.begin(), merge.taken.end(), wrong.id), 0);
  EXPECT_EQ(OfPair(merge, "c", "d").count, 11);
}

// Week by week, b moved before the 20th and nobody told: its pairs contradict what is merged from then on.
TEST(MergeSessions, AfterAMoveThatNobodyToldStayFew) {
  Sessions sessions(2e-4);
  Window window;
  const Se3 moved = Se3::Exp(Vector6d::Constant(0.01));
  for (int week = 0; week < 80; ++week) {
    const std::size_t before = sessions.edges.size();
    sessions.Add(week);
    for (std::size_t k = before; week >= 20 && k < sessions.edges.size(); ++k) {
      Edge& edge = sessions.edges[k];
      if (edge.frame_a == SensorId("b")) edge.T_a_b = moved.Inverse() * edge.T_a_b;
      if (edge.frame_b == SensorId("b")) edge.T_a_b = edge.T_a_b * moved;
    }
    window.edges.insert(window.edges.end(), sessions.edges.begin() + static_cast<std::ptrdiff_t>(before),
                        sessions.edges.end());
    window.Take(MergeOlderSessions(window.merged, window.edges, sessions.measured_at));
    ASSERT_LE(window.edges.size(), 2 * 6 * kSessionsKept) << week;
  }
  // What was before the move holds still, and those of after it have made it less sure only.
  for (const MergedEdge& one : window.merged) {
    const auto first = std::find_if(sessions.edges.begin(), sessions.edges.end(),
                                    [&](const Edge& edge) { return PairOf(edge) == PairOf(EdgeOf(one, kRobot)); });
    const Vector6d off = (first->T_a_b.Inverse() * one.T_a_b).Log();
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-3);
    EXPECT_EQ(one.count, 64);
  }
}

TEST(MergeSessions, WhatIsPastLeavesWithItsSessionAndCountsForNoWindow) {
  Sessions sessions(2e-4);
  for (int week = 0; week < 12; ++week) sessions.Add(week);
  for (std::size_t k = 0; k < sessions.edges.size(); ++k)  // those of the eleventh session, and one edge of the first
    if (k / 6 == 10 || k == 0) sessions.edges[k].state = EdgeState::kFailed;
  const Merge merge = MergeOlderSessions({}, sessions.edges, sessions.measured_at);
  EXPECT_EQ(merge.taken.size(), 6 * 3u);
  for (const MergedEdge& one : merge.merged) EXPECT_EQ(one.count, one.frame_b == SensorId("b") ? 2 : 3);
}

// A robot of two sensors: fewer causes than blocks that count.
TEST(MergeSessions, OfOnePairKeepsItsBlocksAndWhatItsSessionsShare) {
  Sessions sessions(1e-9, 1);
  for (int week = 0; week < 40; ++week) sessions.Add(week);
  Window window{{}, sessions.edges};
  window.Take(MergeOlderSessions({}, sessions.edges, sessions.measured_at));
  ASSERT_EQ(window.merged.size(), 1u);
  EXPECT_EQ(BlocksOf(window.All()).size(), kSessionsKept + 1);
  ExpectSame(Tell(sessions.edges), Tell(window.All()), 1e-5, 1e-6);
}

// As a mount does that gives a little from visit to visit: that contradicts nobody.
TEST(MergeSessions, ThatScatterFromVisitToVisitAreMerged) {
  Sessions sessions(2e-4, kPairs.size(), 5.0);
  for (int week = 0; week < 30; ++week) sessions.Add(week);
  EXPECT_GE(MergeOlderSessions({}, sessions.edges, sessions.measured_at).taken.size(), 6 * 20u);
}

TEST(MergeSessions, ThatNeverHadAGoodEdgeLeaveTooAndTheLastWordOfAPairStays) {
  Sessions sessions(2e-4);
  for (int week = 0; week < 30; ++week) sessions.Add(week);
  for (Edge& edge : sessions.edges) edge.state = EdgeState::kFailed;
  std::erase_if(sessions.edges, [&](const Edge& edge) {  // of the last pair only the first three sessions tell
    return edge.frame_b == SensorId("d") && edge.frame_a == SensorId("b") &&
           sessions.measured_at.at(edge.id).ns > 3'500'000'000;
  });
  const std::size_t all = sessions.edges.size();
  const Merge merge = MergeOlderSessions({}, sessions.edges, sessions.measured_at);
  EXPECT_TRUE(merge.merged.empty());
  EXPECT_EQ(all - merge.taken.size(), 5 * kSessionsKept + 1);
}

TEST(MergeSessions, PushedEdgesAreLeftAlone) {
  Sessions sessions(2e-4);
  for (int week = 0; week < 12; ++week) sessions.Add(week);
  for (Edge& edge : sessions.edges) edge.session = SessionId();
  const Merge merge = MergeOlderSessions({}, sessions.edges, sessions.measured_at);
  EXPECT_TRUE(merge.taken.empty());
  EXPECT_TRUE(merge.merged.empty());
}

}  // namespace
}  // namespace rigcal::graph
