#include <gtest/gtest.h>

#include <algorithm>

#include "client/wire/edge_outlet.h"

namespace rigcal::client {
namespace {

std::vector<Edge> Edges(int count) {
  std::vector<Edge> edges;
  for (int i = 0; i < count; ++i) {
    Edge edge;
    edge.robot = RobotId("r");
    edge.frame_a = SensorId("a");
    edge.frame_b = SensorId("b" + std::to_string(i));
    edge.method = "given";
    edge.state = EdgeState::kGood;
    edge.uncertainty = FromInformation(Matrix6d::Identity(), UncertaintySource::kGiven, 0);
    edges.push_back(edge);
  }
  AssignPushedIds(edges);
  return edges;
}

// The ids in the order in which they are sent.
std::vector<std::string> SentIds(const EdgesToPush& batch) {
  std::vector<std::string> ids;
  for (const std::uint32_t idx : batch.send_order) ids.push_back(batch.edges[idx].id.str());
  return ids;
}

TEST(EdgeBatch, AnItemsIndexIsTheRankOfItsIdWhateverTheFilesOrder) {
  const std::vector<Edge> edges = Edges(20);
  std::vector<Edge> reversed(edges.rbegin(), edges.rend());
  const EdgesToPush forward = EdgesOf(RobotId("r"), edges, std::nullopt);
  const EdgesToPush backward = EdgesOf(RobotId("r"), reversed, std::nullopt);
  EXPECT_EQ(forward.id, backward.id);
  for (std::size_t i = 0; i < edges.size(); ++i) EXPECT_EQ(forward.edges[i].id, backward.edges[i].id);
  EXPECT_TRUE(std::is_sorted(forward.edges.begin(), forward.edges.end(),
                             [](const Edge& x, const Edge& y) { return x.id < y.id; }));
}

TEST(EdgeBatch, SentInTheFilesOrderUnlessShuffled) {
  const std::vector<Edge> edges = Edges(50);
  std::vector<std::string> file;
  for (const Edge& edge : edges) file.push_back(edge.id.str());
  EXPECT_EQ(SentIds(EdgesOf(RobotId("r"), edges, std::nullopt)), file);
  auto shuffled = SentIds(EdgesOf(RobotId("r"), edges, 1));
  EXPECT_NE(shuffled, file);
  EXPECT_EQ(shuffled, SentIds(EdgesOf(RobotId("r"), edges, 1)));
  EXPECT_NE(shuffled, SentIds(EdgesOf(RobotId("r"), edges, 2)));
  std::sort(shuffled.begin(), shuffled.end());
  std::sort(file.begin(), file.end());
  EXPECT_EQ(shuffled, file);
}

}  // namespace
}  // namespace rigcal::client
