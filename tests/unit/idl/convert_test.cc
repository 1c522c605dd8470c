#include "idl/convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "tests/unit/idl/sample_edge.h"

namespace rigcal::wire {
namespace {

using ::testing::HasSubstr;

BatchItem SampleItem() {
  Edge edge = SampleEdge();
  edge.T_a_b.q.normalize();
  return SampleBatch({edge}).front();
}

TEST(CopyText, NeverCuts) {
  char to[5] = "";
  ASSERT_TRUE(CopyText("abcd", to, sizeof to, "field"));
  EXPECT_STREQ(to, "abcd");
  const Status refused = CopyText("abcde", to, sizeof to, "field");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("field"));
  EXPECT_FALSE(CopyText(std::string("a\0b", 3), to, sizeof to, "field"));
  EXPECT_STREQ(to, "abcd");
}

TEST(ReceiptConversion, KeepsEverything) {
  Receipt receipt;
  receipt.robot = RobotId("mapper-01");
  receipt.subject_id = std::string(64, 'a');
  receipt.state = ReceiptState::kReceiving;
  receipt.incarnation = 7;
  receipt.sequence_number = 8;
  receipt.window_bytes = 9;
  receipt.written_bytes = 10;
  receipt.held = {true, false, false, true, false, false, false, false, true, false, false};
  receipt.busy = {{3, 1 << 20}, {4, 5}};
  receipt.error = Error{ErrorCode::kConflict, "what", "cure"};
  const auto owned = ToReceipt(receipt);
  ASSERT_TRUE(owned);
  const auto back = FromReceipt(owned->sample);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->robot, receipt.robot);
  EXPECT_EQ(back->subject_id, receipt.subject_id);
  EXPECT_EQ(back->state, receipt.state);
  EXPECT_EQ(back->incarnation, 7u);
  EXPECT_EQ(back->sequence_number, 8u);
  EXPECT_EQ(back->window_bytes, 9u);
  EXPECT_EQ(back->written_bytes, 10u);
  ASSERT_GE(back->held.size(), receipt.held.size());
  for (std::size_t i = 0; i < back->held.size(); ++i) EXPECT_EQ(back->held[i], i == 0 || i == 3 || i == 8) << i;
  ASSERT_EQ(back->busy.size(), 2u);
  EXPECT_EQ(back->busy[0].payload_idx, 3u);
  EXPECT_EQ(back->busy[0].offset_bytes, 1u << 20);
  EXPECT_EQ(back->busy[1].offset_bytes, 5u);
  ASSERT_TRUE(back->error);
  EXPECT_EQ(back->error->code, ErrorCode::kConflict);
  EXPECT_EQ(back->error->what, "what");
  EXPECT_EQ(back->error->cure, "cure");
}

TEST(ReceiptConversion, PutsBitsLowestFirst) {
  Receipt receipt;
  receipt.robot = RobotId("r");
  receipt.subject_id = std::string(64, '0');
  receipt.held = {false, true, false, false, false, false, false, false, true};
  const auto owned = ToReceipt(receipt);
  ASSERT_TRUE(owned);
  ASSERT_EQ(owned->sample.held._length, 2u);
  EXPECT_EQ(owned->sample.held._buffer[0], 0x02);
  EXPECT_EQ(owned->sample.held._buffer[1], 0x01);
}

TEST(ReceiptConversion, RefusesAStateItDoesNotKnow) {
  Receipt receipt;
  receipt.robot = RobotId("r");
  receipt.subject_id = std::string(64, '0');
  auto owned = ToReceipt(receipt);
  ASSERT_TRUE(owned);
  std::strcpy(owned->sample.state, "dreaming");
  const auto back = FromReceipt(owned->sample);
  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().code, ErrorCode::kUnsupported);
  std::strcpy(owned->sample.state, "\x1b[2J");
  EXPECT_THAT(FromReceipt(owned->sample).error().what, HasSubstr(R"("\x1b[2J")"));
}

TEST(EdgeConversion, KeepsEveryNumberBitByBit) {
  const BatchItem item = SampleItem();
  const auto owned = ToPairwiseResult(item);
  ASSERT_TRUE(owned) << owned.error().what;
  const auto back = FromPairwiseResult(owned->sample);
  ASSERT_TRUE(back) << back.error().what;
  EXPECT_EQ(back->batch, item.batch);
  EXPECT_EQ(back->idx, item.idx);
  EXPECT_EQ(back->count, item.count);
  const Edge &edge = back->edge, &sent = item.edge;
  EXPECT_EQ(edge.id, sent.id);
  EXPECT_EQ(edge.robot, sent.robot);
  EXPECT_EQ(edge.frame_a, sent.frame_a);
  EXPECT_EQ(edge.frame_b, sent.frame_b);
  EXPECT_EQ(edge.T_a_b.p_m, sent.T_a_b.p_m);
  EXPECT_EQ(edge.T_a_b.q.coeffs(), sent.T_a_b.q.coeffs());
  EXPECT_EQ(edge.uncertainty.Omega, sent.uncertainty.Omega);
  EXPECT_EQ(edge.uncertainty.covariance, sent.uncertainty.covariance);
  EXPECT_EQ(edge.uncertainty.rank, 6);
  EXPECT_EQ(edge.uncertainty.dof, 11);
  EXPECT_EQ(edge.uncertainty.jackknife_ratio, 0.1 + 0.2);
  EXPECT_EQ(edge.uncertainty.source, UncertaintySource::kJackknife);
  EXPECT_EQ(edge.method, "given");
  EXPECT_EQ(edge.measured_at, sent.measured_at);
  EXPECT_EQ(edge.state, EdgeState::kGood);
  ASSERT_EQ(edge.uncertainty.blocks.size(), 3u);
  EXPECT_EQ(edge.uncertainty.blocks[2].block_id, "capture-2");
  EXPECT_EQ(edge.uncertainty.blocks[2].d, sent.uncertainty.blocks[2].d);
  ASSERT_EQ(edge.uncertainty.contributions.size(), 1u);
  EXPECT_EQ(edge.uncertainty.contributions[0].name, "board size");
  EXPECT_EQ(edge.uncertainty.contributions[0].covariance, sent.uncertainty.contributions[0].covariance);
}

TEST(EdgeConversion, OfNoDateThereIsNone) {
  Edge undated = SampleItem().edge;
  undated.measured_at.reset();
  const auto items = SampleBatch({undated});
  const auto owned = ToPairwiseResult(items.front());
  ASSERT_TRUE(owned);
  EXPECT_EQ(owned->sample.measured_ns, 0);
  const auto back = FromPairwiseResult(owned->sample);
  ASSERT_TRUE(back) << back.error().what;
  EXPECT_FALSE(back->edge.measured_at);
}

// Error on one axis, looked for at that index of the C struct.
TEST(EdgeConversion, PutsEachAxisAtItsIndex) {
  BatchItem item = SampleItem();
  const auto owned = ToPairwiseResult(item);
  ASSERT_TRUE(owned);
  const rigcal_wire_PairwiseResult& sample = owned->sample;
  EXPECT_EQ(sample.p_m[1], -2.5);
  EXPECT_EQ(sample.q_xyzw[3], item.edge.T_a_b.q.w());
  EXPECT_EQ(sample.q_xyzw[1], item.edge.T_a_b.q.y());
  EXPECT_EQ(sample.information[6 * 4 + 4], 104.0);                // ry
  EXPECT_EQ(sample.information[6 * 5 + 1], 0.5 * 5 + 0.125 * 1);  // row rz, column y
  EXPECT_EQ(sample.blocks._buffer[1].d[3], 13.5);
  EXPECT_EQ(sample.contributions._buffer[0].covariance[6 * 2 + 2], 3e-6);
}

TEST(EdgeConversion, TellsEqualEdgesOfABatchApart) {
  const Edge edge = SampleItem().edge;
  const auto items = SampleBatch({edge, edge, edge});
  for (const BatchItem& item : items) {
    const auto owned = ToPairwiseResult(item);
    ASSERT_TRUE(owned);
    const auto back = FromPairwiseResult(owned->sample);
    ASSERT_TRUE(back) << back.error().what;
    EXPECT_EQ(back->edge.id, item.edge.id);
  }
}

struct Spoiled {
  const char* name;
  const char* in_what;
  std::function<void(rigcal_wire_PairwiseResult&)> spoil;
};

class EdgeRefusal : public testing::TestWithParam<Spoiled> {};

TEST_P(EdgeRefusal, NamesTheField) {
  auto owned = ToPairwiseResult(SampleItem());
  ASSERT_TRUE(owned);
  GetParam().spoil(owned->sample);
  const auto back = FromPairwiseResult(owned->sample);
  ASSERT_FALSE(back);
  EXPECT_THAT(back.error().what, HasSubstr(GetParam().in_what));
  EXPECT_FALSE(back.error().cure.empty());
}

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
INSTANTIATE_TEST_SUITE_P(
    All, EdgeRefusal,
    testing::Values(Spoiled{"pose", "p_m", [](auto& s) { s.p_m[2] = kNaN; }},
                    Spoiled{"quaternion", "q_xyzw", [](auto& s) { s.q_xyzw[0] = INFINITY; }},
                    Spoiled{"norm", "norm", [](auto& s) { s.q_xyzw[3] += 1e-3; }},
                    Spoiled{"information", "information", [](auto& s) { s.information[7] = kNaN; }},
                    Spoiled{"indefinite", "information", [](auto& s) { s.information[0] = -100.0; }},
                    Spoiled{"rank", "rank", [](auto& s) { s.rank = 5; }},
                    Spoiled{"content", "id", [](auto& s) { s.p_m[0] += 1; }},
                    Spoiled{"occurrence", "id", [](auto& s) { s.occurrence_idx = 1; }},
                    Spoiled{"robot", "robot", [](auto& s) { std::strcpy(s.robot_id, "../x"); }},
                    Spoiled{"other_robot", "id", [](auto& s) { std::strcpy(s.robot_id, "mapper-02"); }},
                    Spoiled{"batch", "batch", [](auto& s) { s.batch_id[3] = 'X'; }},
                    Spoiled{"index", "item 1", [](auto& s) { s.batch_idx = 1; }},
                    Spoiled{"source", "source", [](auto& s) { std::strcpy(s.source, "guess"); }},
                    Spoiled{"frames", "left", [](auto& s) { std::strcpy(s.frame_b, "left"); }},
                    Spoiled{"method", "method", [](auto& s) { std::strcpy(s.method, "<b>"); }},
                    Spoiled{"ratio", "jackknife_ratio", [](auto& s) { s.jackknife_ratio = kNaN; }},
                    Spoiled{"ratio_beyond_one", "jackknife_ratio", [](auto& s) { s.jackknife_ratio = 1.5; }},
                    Spoiled{"blocks", "blocks", [](auto& s) { s.blocks._buffer[0].d[5] = kNaN; }},
                    Spoiled{"contribution", "contributions",
                            [](auto& s) { s.contributions._buffer[0].covariance[1] = kNaN; }}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace rigcal::wire
