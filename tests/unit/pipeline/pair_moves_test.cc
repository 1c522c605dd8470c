// Which sensor was moved, as changes of pairs tell.
#include "server/pipeline/sessions/pair_moves.h"

#include <gtest/gtest.h>

#include <random>

#include "server/formats/revision/session_estimate.h"

namespace rigcal::pipeline {
namespace {

constexpr int kCaptures = 30;

// As a mean of captures, the later ones off by `step`.
Edge PairOf(const char* a, const char* b, const Vector6d& step, int from, std::mt19937& random) {
  Edge edge;
  edge.frame_a = SensorId(a), edge.frame_b = SensorId(b);
  edge.state = EdgeState::kGood;
  edge.method = "lidar_lidar";
  edge.T_a_b = Se3::Exp((Vector6d() << 0.3, -0.2, 0.1, 0.4, 1.2, -0.3).finished());
  std::vector<Vector6d> errors;
  Vector6d mean = Vector6d::Zero();
  for (int i = 0; i < kCaptures; ++i) {
    Vector6d error = Vector6d::NullaryExpr([&] { return 1e-3 * std::normal_distribution<double>()(random); });
    if (i >= from) error += step;
    mean += error / kCaptures;
    errors.push_back(error);
  }
  for (int i = 0; i < kCaptures; ++i)
    edge.uncertainty.blocks.push_back(
        {std::to_string(100 + i), (mean - errors[static_cast<std::size_t>(i)]) / (kCaptures - 1)});
  return edge;
}

TEST(PairMoves, TheSensorThatChangedPairsHaveInCommonWasMoved) {
  std::mt19937 random(3);
  const Vector6d still = Vector6d::Zero(), moved = EachAxis(0.02, 0.01);  // of b
  const Edge with_c = PairOf("b", "c", still, kCaptures, random);
  const std::vector<Edge> edges = {
      PairOf("a", "b", moved, 15, random),
      PairOf("b", "c", -Adjoint(with_c.T_a_b.Inverse()) * moved, 15, random),
      PairOf("a", "c", still, kCaptures, random),
  };
  SessionEstimate estimate;
  AddMovesOfPairs(edges, {}, estimate);
  ASSERT_EQ(estimate.moved.size(), 1u);
  EXPECT_EQ(estimate.moved[0].sensor.str(), "b");
  EXPECT_TRUE(estimate.moved[0].or_sensor.empty());
  EXPECT_EQ(estimate.moved[0].last_before.str(), "114");
  EXPECT_EQ(estimate.moved[0].first_after.str(), "115");
  EXPECT_LT((estimate.moved[0].step - moved).norm(), 0.005);
  ASSERT_EQ(estimate.by_pairs.size(), 3u);
  EXPECT_LT(estimate.by_pairs[2].move.m, 0.01);
}

TEST(PairMoves, OfOnePairEitherMayHaveBeenMoved) {
  std::mt19937 random(4);
  SessionEstimate estimate;
  AddMovesOfPairs({PairOf("a", "b", EachAxis(0.02, 0.01), 12, random), Edge{}}, {}, estimate);
  ASSERT_EQ(estimate.moved.size(), 1u);
  EXPECT_EQ(estimate.moved[0].sensor.str(), "b");
  EXPECT_EQ(estimate.moved[0].or_sensor.str(), "a");
}

// Of 120 captures a block holds three; their names have dashes.
TEST(PairMoves, CapturesOfBlocksAreNamed) {
  std::mt19937 random(6);
  Edge edge = PairOf("a", "b", EachAxis(0.02, 0.01), 15, random);
  std::vector<CaptureId> captures;
  for (int i = 0; i < 120; ++i) captures.emplace_back("day-" + std::to_string(1000 + i));
  for (int i = 0; i < kCaptures; ++i)
    edge.uncertainty.blocks[static_cast<std::size_t>(i)].block_id =
        "day-" + std::to_string(1000 + 3 * i) + "-day-" + std::to_string(1002 + 3 * i);
  SessionEstimate estimate;
  AddMovesOfPairs({edge}, captures, estimate);
  ASSERT_EQ(estimate.moved.size(), 1u);
  EXPECT_EQ(estimate.moved[0].last_before.str(), "day-1042");
  EXPECT_EQ(estimate.moved[0].first_after.str(), "day-1047");
}

// Of a hand-eye pair blocks are stretches of time: what is told can be stored.
TEST(PairMoves, OfStretchesOfTimeIsStored) {
  std::mt19937 random(8);
  Edge edge = PairOf("odo", "gnss", EachAxis(0.02, 0.01), 15, random);
  edge.method = "hand_eye";
  for (int i = 0; i < kCaptures; ++i)
    edge.uncertainty.blocks[static_cast<std::size_t>(i)].block_id = "part " + std::to_string(i + 1);
  SessionEstimate estimate;
  estimate.session = SessionId(std::string(64, '1'));
  estimate.reference = SensorId("odo");
  AddMovesOfPairs({edge}, {}, estimate);
  ASSERT_EQ(estimate.moved.size(), 1u);
  EXPECT_TRUE(estimate.by_pairs.empty());
  const auto read = formats::ReadSessionEstimate(formats::WriteSessionEstimate(estimate));
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->moved[0].first_after.str(), "part-16");
}

// Two that were moved apart: no third is named for certain.
TEST(PairMoves, OfTwoThatWereMovedEachPairTells) {
  std::mt19937 random(9);
  const Edge still = PairOf("b", "c", Vector6d::Zero(), kCaptures, random);
  const Vector6d of_a = EachAxis(0.02, 0.01), of_b = EachAxis(-0.03, 0.02);
  const std::vector<Edge> edges = {
      PairOf("a", "b", of_b - Adjoint(still.T_a_b.Inverse()) * of_a, 15, random),
      PairOf("a", "c", -Adjoint(still.T_a_b.Inverse()) * of_a, 15, random),
      PairOf("b", "c", -Adjoint(still.T_a_b.Inverse()) * of_b, 15, random),
  };
  SessionEstimate estimate;
  AddMovesOfPairs(edges, {}, estimate);
  ASSERT_EQ(estimate.moved.size(), 3u);
  for (const SensorMovedWithin& one : estimate.moved) EXPECT_FALSE(one.or_sensor.empty());
}

TEST(PairMoves, NobodyWasWhereNothingChanged) {
  std::mt19937 random(5);
  SessionEstimate estimate;
  AddMovesOfPairs({PairOf("a", "b", Vector6d::Zero(), 12, random)}, {}, estimate);
  EXPECT_TRUE(estimate.moved.empty());
  SessionEstimate of_none;
  AddMovesOfPairs({}, {}, of_none);
  EXPECT_TRUE(of_none.by_pairs.empty());
}

// Refined with a and b, of which a smaller move than `smallest_m` would not have been told; c and d are known by their
// pairs only.
SessionEstimate RefinedOfAandB(double smallest_m = 0.002) {
  SessionEstimate estimate;
  for (const char* sensor : {"a", "b"})
    estimate.poses.push_back({SensorId(sensor), Se3(), 0.0, SmallestMove{smallest_m, smallest_m, 30}});
  return estimate;
}

TEST(PairMoves, OfARefinedSessionPairsTellOfSensorsThatTookNoPart) {
  std::mt19937 random(12);
  const Vector6d moved = EachAxis(0.02, 0.01);
  SessionEstimate estimate = RefinedOfAandB();
  AddMovesOfPairs({PairOf("a", "b", moved, 15, random), PairOf("c", "d", moved, 15, random)}, {}, estimate);
  ASSERT_EQ(estimate.moved.size(), 1u) << "the refinement looked at a and b";
  EXPECT_EQ(estimate.moved[0].sensor.str(), "d");
  EXPECT_EQ(estimate.moved[0].or_sensor.str(), "c");
  ASSERT_EQ(estimate.by_pairs.size(), 2u);
  EXPECT_EQ(estimate.by_pairs[0].sensor.str(), "c");
}

// What two refinements looked at by themselves may have moved against each other as a whole.
TEST(PairMoves, OfTwoIslandsEitherMayHaveBeenMoved) {
  std::mt19937 random(18);
  const Vector6d moved = EachAxis(0.02, 0.01);
  SessionEstimate estimate = RefinedOfAandB(), island;
  for (const char* sensor : {"c", "d"})
    island.poses.push_back({SensorId(sensor), Se3(), 0.0, SmallestMove{0.002, 0.002, 30}});
  estimate.islands = {island};
  AddMovesOfPairs({PairOf("a", "c", moved, 15, random), PairOf("c", "d", moved, 15, random)}, {}, estimate);
  ASSERT_EQ(estimate.moved.size(), 1u) << "one refinement looked at c and d";
  EXPECT_EQ(estimate.moved[0].sensor.str(), "c");
  EXPECT_EQ(estimate.moved[0].or_sensor.str(), "a");
  EXPECT_TRUE(estimate.by_pairs.empty());
}

TEST(PairMoves, OfTwoTheOneThatTheRefinementLookedAtIsCleared) {
  std::mt19937 random(13);
  const Vector6d moved = EachAxis(0.02, 0.01);
  for (const auto& [first, second] : {std::pair("a", "c"), std::pair("c", "a")}) {
    SessionEstimate estimate = RefinedOfAandB();
    const Edge edge = PairOf(first, second, moved, 15, random);
    AddMovesOfPairs({edge}, {}, estimate);
    ASSERT_EQ(estimate.moved.size(), 1u);
    EXPECT_EQ(estimate.moved[0].sensor.str(), "c");
    EXPECT_TRUE(estimate.moved[0].or_sensor.empty());
    const Vector6d of_c = first == std::string("c") ? Vector6d(-Adjoint(edge.T_a_b) * moved) : moved;
    EXPECT_LT((estimate.moved[0].step - of_c).norm(), 0.005);
    ASSERT_EQ(estimate.by_pairs.size(), 1u);
    EXPECT_EQ(estimate.by_pairs[0].sensor.str(), "c");
  }
}

TEST(PairMoves, OneThatTheRefinementSawTooLittleOfIsNotCleared) {
  std::mt19937 random(15);
  SessionEstimate estimate = RefinedOfAandB(1.0);
  AddMovesOfPairs({PairOf("a", "c", EachAxis(0.02, 0.01), 15, random)}, {}, estimate);
  ASSERT_EQ(estimate.moved.size(), 1u);
  EXPECT_EQ(estimate.moved[0].sensor.str(), "c");
  EXPECT_EQ(estimate.moved[0].or_sensor.str(), "a");
}

// Captures that it did not see may be all on one side of the move.
TEST(PairMoves, OneThatTheRefinementSawInSomeCapturesIsNotCleared) {
  std::mt19937 random(17);
  SessionEstimate estimate = RefinedOfAandB();
  std::vector<CaptureId> captures;
  for (int i = 0; i < 40; ++i) captures.emplace_back(std::to_string(100 + i));  // of which a saw 30
  AddMovesOfPairs({PairOf("a", "c", EachAxis(0.02, 0.01), 15, random)}, captures, estimate);
  ASSERT_EQ(estimate.moved.size(), 1u);
  EXPECT_EQ(estimate.moved[0].or_sensor.str(), "a");
}

TEST(PairMoves, WeakPairsBesideBetterOnesTellOfNoMove) {
  std::mt19937 random(16);
  Edge weak = PairOf("c", "d", EachAxis(0.02, 0.01), 15, random), to_c = PairOf("a", "c", Vector6d::Zero(), 0, random),
       to_d = PairOf("a", "d", Vector6d::Zero(), 0, random);
  weak.figures["overlap_ratio"] = 0.3;
  int number = 0;
  for (Edge* edge : {&weak, &to_c, &to_d}) {
    edge->id = EdgeId(std::string(63, '0') + std::to_string(number++));
    edge->session = SessionId("visit");
    edge->uncertainty.rank = 6;
    edge->uncertainty.source = UncertaintySource::kJackknife;
  }
  SessionEstimate beside = RefinedOfAandB(), alone = RefinedOfAandB();
  AddMovesOfPairs({weak, to_c, to_d}, {}, beside);
  EXPECT_TRUE(beside.moved.empty());
  AddMovesOfPairs({weak}, {}, alone);
  EXPECT_EQ(alone.moved.size(), 1u);
}

TEST(PairMoves, ASensorThatTheRefinementFoundToHaveMovedAccusesNoOther) {
  std::mt19937 random(14);
  SessionEstimate estimate = RefinedOfAandB();
  estimate.moved.push_back({SensorId("a"), CaptureId("114"), CaptureId("115"), EachAxis(0.02, 0.01), 1e-9});
  AddMovesOfPairs({PairOf("a", "c", EachAxis(0.02, 0.01), 15, random)}, {}, estimate);
  EXPECT_EQ(estimate.moved.size(), 1u);
}

}  // namespace
}  // namespace rigcal::pipeline
