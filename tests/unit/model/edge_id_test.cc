// The byte layout is checked against digests made without our code, and by what must and must not change.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "server/base/digests/sha256.h"
#include "server/model/edges/edge.h"
#include "server/model/field_hash.h"

namespace rigcal {
namespace {

using Eigen::Quaterniond;

Edge SomeEdge() {
  Edge edge;
  edge.robot = RobotId("mapper-01");
  edge.frame_a = SensorId("left");
  edge.frame_b = SensorId("right");
  edge.T_a_b = Se3{{0.1, -0.2, 0.0}, Quaterniond(0.6, 0.0, 0.8, 0.0)};
  edge.uncertainty = FromInformation(Matrix6d::Identity(), UncertaintySource::kGiven, 0);
  edge.method = "given";
  edge.state = EdgeState::kGood;
  return edge;
}

std::string LittleEndian(std::uint64_t number) {
  std::string bytes;
  for (int shift = 0; shift < 64; shift += 8) bytes.push_back(static_cast<char>((number >> shift) & 0xff));
  return bytes;
}

TEST(FieldHash, LayoutIsAsDocumented) {
  const std::string bytes = LittleEndian(4) + "kind" + LittleEndian(2) + "ab" + LittleEndian(258) +
                            std::string("\0\0\0\0\0\0\xf0\x3f", 8) + std::string(8, '\0');
  FieldHash hash("kind");
  EXPECT_EQ(hash.Text("ab").Number(258).Real(1.0).Real(-0.0).Finish(), Sha256Of(bytes));
}

TEST(FieldHash, BordersOfFieldsCount) {
  EXPECT_NE(FieldHash("k").Text("ab").Text("c").Finish(), FieldHash("k").Text("a").Text("bc").Finish());
}

TEST(ContentDigest, SignsOfZeroAndQuaternionDoNotCount) {
  const Edge edge = SomeEdge();
  Edge same = edge;
  same.T_a_b.p_m.z() = -0.0;
  same.T_a_b.q.coeffs() = -same.T_a_b.q.coeffs();
  EXPECT_EQ(ContentDigest(same), ContentDigest(edge));
  Edge half_turn = edge, other_way = edge;
  half_turn.T_a_b.q = Quaterniond(0, 1, 0, 0);
  other_way.T_a_b.q = Quaterniond(-0.0, -1, 0, 0);
  EXPECT_EQ(ContentDigest(half_turn), ContentDigest(other_way));
}

TEST(ContentDigest, EverythingThatIsMeasuredCounts) {
  const std::vector<std::function<void(Edge&)>> changes = {
      [](Edge& e) { std::swap(e.frame_a, e.frame_b); },
      [](Edge& e) { e.method = "stereo"; },
      [](Edge& e) { e.T_a_b.p_m.x() = std::nextafter(0.1, 1.0); },
      [](Edge& e) { e.T_a_b.q = e.T_a_b.q.conjugate(); },
      [](Edge& e) { e.uncertainty.Omega(5, 5) = 2; },
      [](Edge& e) { e.uncertainty.Omega(0, 1) = 0.5; },
      [](Edge& e) { e.uncertainty.Omega(1, 0) = 0.5; },
      [](Edge& e) { e.uncertainty.dof = 3; },
      [](Edge& e) { e.uncertainty.jackknife_ratio = 0.5; },
      [](Edge& e) { e.measured_at = Stamp{1}; },
      [](Edge& e) { e.measured_at = Stamp{2}; },
      [](Edge& e) { e.uncertainty.source = UncertaintySource::kAssumed; },
      [](Edge& e) {
        e.uncertainty.blocks = {{"001", Vector6d::Zero()}};
      },
      [](Edge& e) {
        e.uncertainty.blocks = {{"001", Vector6d::Unit(2)}};
      },
      [](Edge& e) {
        e.uncertainty.contributions = {{"board", Matrix6d::Identity()}};
      }};
  std::set<Digest> digests = {ContentDigest(SomeEdge())};
  for (const auto& change : changes) {
    Edge edge = SomeEdge();
    change(edge);
    digests.insert(ContentDigest(edge));
  }
  EXPECT_EQ(digests.size(), changes.size() + 1);
}

TEST(EdgeId, EstimatedOnesDependOnEveryPart) {
  const SessionId session(std::string(64, 'a')), other(std::string(64, 'b'));
  const auto id = [&](const char* robot, const SessionId& s, const char* method, const char* a, const char* b) {
    return EstimatedEdgeId(RobotId(robot), s, method, SensorId(a), SensorId(b));
  };
  const std::set<EdgeId> ids = {id("r", session, "stereo", "a", "b"), id("q", session, "stereo", "a", "b"),
                                id("r", other, "stereo", "a", "b"),   id("r", session, "hand_eye", "a", "b"),
                                id("r", session, "stereo", "b", "a"), id("r", session, "stereo", "a", "c")};
  EXPECT_EQ(ids.size(), 6U);
  EXPECT_EQ(id("r", session, "stereo", "a", "b"), id("r", session, "stereo", "a", "b"));
  EXPECT_TRUE(EdgeId::Parse(ids.begin()->str()).has_value());
}

std::vector<Edge> Batch() {
  std::vector<Edge> edges(4, SomeEdge());  // 0 and 2 are equal, 1 and 3 are not
  edges[1].T_a_b.p_m.x() = 0.5;
  edges[3].frame_b = SensorId("top");
  AssignPushedIds(edges);
  return edges;
}

TEST(PushedIds, EqualEdgesGetDifferentIds) {
  std::set<EdgeId> ids;
  for (const Edge& edge : Batch()) ids.insert(edge.id);
  EXPECT_EQ(ids.size(), 4U);
}

TEST(PushedIds, OrderOfTheFileDoesNotMatter) {
  std::vector<Edge> edges = Batch();
  const BatchId batch = BatchIdOf(RobotId("mapper-01"), edges);
  std::set<EdgeId> before, after;
  for (const Edge& edge : edges) before.insert(edge.id);
  std::reverse(edges.begin(), edges.end());
  AssignPushedIds(edges);
  for (const Edge& edge : edges) after.insert(edge.id);
  EXPECT_EQ(before, after);
  EXPECT_EQ(BatchIdOf(RobotId("mapper-01"), edges), batch);
}

TEST(PushedIds, AnotherRobotHasOtherIds) {
  std::vector<Edge> edges = Batch();
  const EdgeId id = edges[0].id;
  for (Edge& edge : edges) edge.robot = RobotId("mapper-02");
  AssignPushedIds(edges);
  EXPECT_NE(edges[0].id, id);
  EXPECT_NE(BatchIdOf(RobotId("mapper-01"), edges), BatchIdOf(RobotId("mapper-02"), edges));
}

// Stored ids must never change: this one was computed with Python's struct and hashlib from the documented layout.
TEST(ContentDigest, IsTheOneOfTheDocumentedLayout) {
  EXPECT_EQ(ContentDigest(SomeEdge()).str(), "c30155f16ae768e38aa3a63c509df41fe753f5ed05ae95a1db3b67f5cdb9c805");
  EXPECT_EQ(PushedEdgeId(RobotId("mapper-01"), ContentDigest(SomeEdge()), 2).str(),
            "622cfc6de82da80f771f3cfdf1ca4fac913ad088251eaf05aabb7e35db62e469");
}

}  // namespace
}  // namespace rigcal
