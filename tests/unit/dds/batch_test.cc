#include <gmock/gmock.h>

#include "storage/edges/edges.h"
#include "storage/sessions/sessions.h"
#include "tests/unit/dds/fixture.h"
#include "tests/unit/idl/sample_edge.h"

namespace rigcal::dds {
namespace {

using testing::HasSubstr;
using wire::BatchItem;
using wire::Receipt;
using wire::ReceiptState;

using BatchTest = ServiceTest;

std::vector<BatchItem> MakeBatch(std::size_t count) {
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < count; ++i) {
    edges.push_back(wire::SampleEdge(0.5 * static_cast<double>(i / 2)));  // each content twice
    edges.back().T_a_b.q.normalize();
  }
  return wire::SampleBatch(edges);
}

TEST_F(BatchTest, StoresEveryEdgeInAnyOrderAndAgain) {
  const auto batch = MakeBatch(40);
  const std::string subject = batch.front().batch.str();
  Client client = MakeClient("mapper-01");
  for (auto item = batch.rbegin(); item != batch.rend(); ++item) client.SendEdge(*item);
  const Receipt closed = client.AwaitState(subject, ReceiptState::kClosed);
  for (std::size_t i = 0; i < batch.size(); ++i) EXPECT_TRUE(closed.held[i]) << i;
  storage::Store store = Must(storage::Store::Open(folder_.path()));
  const auto stored = Must(storage::LoadEdges(store, RobotId("mapper-01"), true));
  ASSERT_EQ(stored.size(), 40u);
  const Edge loaded = *Must(storage::LoadEdge(store, batch[7].edge.id));
  EXPECT_EQ(loaded.T_a_b.p_m, batch[7].edge.T_a_b.p_m);
  EXPECT_EQ(loaded.uncertainty.Omega, batch[7].edge.uncertainty.Omega);
  EXPECT_EQ(loaded.uncertainty.blocks.size(), 3u);
  ASSERT_FALSE(Work().empty());
  EXPECT_EQ(Work().front().str(), "mapper-01");

  client.SendEdge(batch[3]);  // one item is enough to ask
  const Receipt again =
      client.Await(subject, [&](const Receipt& one) { return one.sequence_number > closed.sequence_number; });
  EXPECT_EQ(again.state, ReceiptState::kClosed);
  EXPECT_EQ(Must(storage::LoadEdges(store, RobotId("mapper-01"), false)).size(), 40u);
}

TEST_F(BatchTest, ResumesAfterARestart) {
  const auto batch = MakeBatch(6);
  const std::string subject = batch.front().batch.str();
  {
    Client client = MakeClient("mapper-01");
    client.SendEdge(batch[0]);
    client.SendEdge(batch[4]);
    client.Await(subject, [](const Receipt& one) { return one.held[0] && one.held[4]; });
  }
  StopServer();
  StartServer();
  Client client = MakeClient("mapper-01");
  client.SendEdge(batch[0]);
  const Receipt receipt = client.AwaitState(subject, ReceiptState::kReceiving);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(receipt.held[i], i == 0 || i == 4);
  for (const std::size_t i : {1, 2, 3, 5}) client.SendEdge(batch[i]);
  client.AwaitState(subject, ReceiptState::kClosed);
}

TEST_F(BatchTest, AStrangersEdgeIsRefusedAndNotStored) {
  const auto batch = MakeBatch(2);
  Client stranger = MakeClient("stranger");
  stranger.SendEdge(batch[0]);
  const Receipt refused = stranger.AwaitState(batch[0].batch.str(), ReceiptState::kRefused);
  EXPECT_THAT(refused.error->what, HasSubstr("robot/stranger"));
  storage::Store store = Must(storage::Store::Open(folder_.path()));
  EXPECT_TRUE(Must(storage::LoadEdges(store, RobotId("mapper-01"), false)).empty());
}

TEST_F(BatchTest, AnEdgeOfTheFutureIsRefusedAndNotStored) {
  Edge edge = wire::SampleEdge();
  edge.T_a_b.q.normalize();
  edge.measured_at = Stamp{SystemClock().Now().ns + 3 * 86'400'000'000'000};
  const auto batch = wire::SampleBatch({edge});
  Client client = MakeClient("mapper-01");
  client.SendEdge(batch[0]);
  const Receipt refused = client.AwaitState(batch[0].batch.str(), ReceiptState::kRefused);
  EXPECT_THAT(refused.error->what, HasSubstr("left - right: measured_at "));
  storage::Store store = Must(storage::Store::Open(folder_.path()));
  EXPECT_TRUE(Must(storage::LoadEdges(store, RobotId("mapper-01"), false)).empty());
}

TEST_F(BatchTest, AnotherCountForAKnownBatchIsRefused) {
  auto batch = MakeBatch(3);
  Client client = MakeClient("mapper-01");
  client.SendEdge(batch[0]);
  client.AwaitState(batch[0].batch.str(), ReceiptState::kReceiving);
  batch[1].count = 4;
  client.SendEdge(batch[1]);
  client.AwaitState(batch[1].batch.str(), ReceiptState::kRefused);
  for (BatchItem item : MakeBatch(3)) client.SendEdge(item);
  client.AwaitState(batch[0].batch.str(), ReceiptState::kClosed);
}

}  // namespace
}  // namespace rigcal::dds
