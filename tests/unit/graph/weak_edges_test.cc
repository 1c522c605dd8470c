// Which weak pairs of lidars take no part beside better edges.
#include "server/graph/solve/weak_edges.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "server/base/digests/sha256.h"
#include "server/model/edges/weak_edge.h"

namespace rigcal::graph {
namespace {

Edge BetterEdge(const std::string& a, const std::string& b) {
  Edge edge;
  edge.id = EdgeId(Sha256Of(a + b).str());
  edge.frame_a = SensorId(a), edge.frame_b = SensorId(b);
  edge.uncertainty = FromInformation(4.0 * Matrix6d::Identity(), UncertaintySource::kGiven, 12);
  edge.state = EdgeState::kGood;
  return edge;
}

// Of a session, by clouds that overlap by so much, or seen in so many directions.
Edge LidarPair(const std::string& a, const std::string& b, double overlap_ratio, int rank = 6) {
  Edge edge = BetterEdge(a, b);
  edge.session = SessionId("visit");
  edge.method = "lidar_lidar";
  edge.figures["overlap_ratio"] = overlap_ratio;
  edge.uncertainty.rank = rank;
  return edge;
}

std::size_t Beside(std::vector<Edge> edges, const std::map<EdgeId, Stamp>& measured_at = {}) {
  const std::set<EdgeId> beside = WeakBesideBetter(edges, measured_at);
  std::reverse(edges.begin(), edges.end());
  EXPECT_EQ(WeakBesideBetter(edges, measured_at), beside);
  EXPECT_EQ(WithoutEdges(edges, beside).size() + beside.size(), edges.size());
  return beside.size();
}

TEST(WeakEdges, TakeNoPartWhereAPathOfBetterOnesHoldsBothSensors) {
  const Edge ab = BetterEdge("a", "b"), bc = BetterEdge("b", "c");
  EXPECT_EQ(Beside({ab, bc, LidarPair("a", "c", 0.31)}), 1u);
  EXPECT_EQ(Beside({ab, bc, LidarPair("a", "c", 0.9, 4)}), 1u);
  EXPECT_EQ(Beside({ab, bc, LidarPair("a", "c", 0.45)}), 0u);
  EXPECT_EQ(Beside({ab, bc, LidarPair("c", "d", 0.31)}), 0u) << "nothing better ties d";
  EXPECT_EQ(Beside({LidarPair("a", "b", 0.31), LidarPair("b", "c", 0.31), LidarPair("a", "c", 0.31)}), 0u);
}

TEST(WeakEdges, ArePairsOfLidarsOfSessions) {
  const Edge ab = BetterEdge("a", "b"), bc = BetterEdge("b", "c");
  Edge pushed = LidarPair("a", "c", 0.31), by_motion = LidarPair("a", "c", 0.9, 5);
  pushed.session = SessionId();
  by_motion.method = "tracker_camera";
  EXPECT_EQ(Beside({ab, bc, pushed}), 0u);
  EXPECT_EQ(Beside({ab, bc, by_motion}), 0u) << "what it sees it sees as well as it says";
  Edge failed = LidarPair("a", "c", 0.31);
  failed.state = EdgeState::kFailed;
  EXPECT_TRUE(WhyWeak(failed).empty());
}

TEST(WeakEdges, AreHeldByNoneThatSeesAPartOrWasAssumed) {
  Edge part = BetterEdge("b", "c"), assumed = BetterEdge("b", "c");
  part.uncertainty.rank = 3;
  assumed.uncertainty.source = UncertaintySource::kAssumed;
  EXPECT_EQ(Beside({BetterEdge("a", "b"), part, LidarPair("a", "c", 0.3)}), 0u);
  EXPECT_EQ(Beside({BetterEdge("a", "b"), assumed, LidarPair("a", "c", 0.3)}), 0u);
}

// What nothing better was measured after may tell that a sensor was moved since.
TEST(WeakEdges, ThatAreNewerThanAllBetterOnesCount) {
  const Edge ab = BetterEdge("a", "b"), bc = BetterEdge("b", "c"), weak = LidarPair("a", "c", 0.31);
  EXPECT_EQ(Beside({ab, bc, weak}, {{ab.id, {5}}, {bc.id, {7}}, {weak.id, {5}}}), 1u);
  EXPECT_EQ(Beside({ab, bc, weak}, {{ab.id, {5}}, {bc.id, {7}}, {weak.id, {6}}}), 0u);
  EXPECT_EQ(Beside({ab, bc, weak}, {{weak.id, {1}}}), 0u) << "the others have no date";
}

TEST(WeakEdges, SayWhy) {
  EXPECT_EQ(WhyWeak(LidarPair("a", "c", 0.307)), "31 % of one cloud lie where the other has points");
  EXPECT_EQ(WhyWeak(LidarPair("a", "c", 0.9, 4)), "it sees 4 of 6 directions");
  EXPECT_EQ(WhyWeak(LidarPair("a", "c", 0.4)), "");
}

}  // namespace
}  // namespace rigcal::graph
