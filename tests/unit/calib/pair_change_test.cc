// A change of a pair within its session by block vectors drawn here: a mean of captures that err as they may, each left
// out in its turn.
#include "server/calib/core/pair_change.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace rigcal::calib {
namespace {

using Errors = std::vector<Vector6d>;  // of each capture's own answer
using Draw = std::function<Errors(std::mt19937&)>;

constexpr std::size_t kCaptures = 40;
const Vector6d kSigma = EachAxis(0.004, 0.002);  // of a capture; of their mean 0.6 mm and 0.02 deg

std::vector<BlockVector> BlocksOf(const Errors& errors) {
  Vector6d sum = Vector6d::Zero();
  for (const Vector6d& error : errors) sum += error;
  const auto m = static_cast<double>(errors.size());
  std::vector<BlockVector> blocks;
  for (std::size_t i = 0; i < errors.size(); ++i)
    blocks.push_back({std::to_string(i), (sum - errors[i]) / (m - 1) - sum / m});
  return blocks;
}

Vector6d Normals(std::mt19937& random) {
  return kSigma.cwiseProduct(Vector6d::NullaryExpr([&] { return std::normal_distribution<double>()(random); }));
}

Errors Independent(std::mt19937& random) {
  Errors errors;
  for (std::size_t i = 0; i < kCaptures; ++i) errors.push_back(Normals(random));
  return errors;
}
// Student's t of three degrees of freedom, a factor for each capture.
Errors HeavyTailed(std::mt19937& random) {
  Errors errors = Independent(random);
  for (Vector6d& error : errors) error /= std::sqrt(std::chi_squared_distribution<double>(3)(random) / 3);
  return errors;
}
// Five captures in a row from one place err alike, but for a fifth of it.
Errors Bursts(std::mt19937& random) {
  Errors errors = Independent(random);
  for (std::size_t i = 0; i < kCaptures; ++i)
    if (i % 5 != 0) errors[i] = errors[i - i % 5] + 0.2 * errors[i];
  return errors;
}

// Ten captures at each of four stops, whose errors are as large as the captures' own.
Errors Stops(std::mt19937& random) {
  Errors errors = Independent(random);
  for (std::size_t i = 0; i < kCaptures; i += 10) {
    const Vector6d stop = Normals(random);
    for (std::size_t k = i; k < i + 10; ++k) errors[k] += stop;
  }
  return errors;
}
// Along x, by eight sigmas of a capture from the first to the last.
Errors Drift(std::mt19937& random) {
  Errors errors = Independent(random);
  for (std::size_t i = 0; i < kCaptures; ++i) errors[i][tangent::kX] += 0.032 * static_cast<double>(i) / kCaptures;
  return errors;
}
// The last captures tell little.
Errors WorseAtTheEnd(std::mt19937& random) {
  Errors errors = Independent(random);
  for (std::size_t i = kCaptures - 4; i < kCaptures; ++i) errors[i] *= 10;
  return errors;
}

class NothingMoved : public testing::TestWithParam<Draw> {};

TEST_P(NothingMoved, IsSeldomAccused) {
  std::mt19937 random(7);
  int accused = 0;
  for (int session = 0; session < 2000; ++session)
    accused += FindPairChange(BlocksOf(GetParam()(random)), 1).has_value() ? 1 : 0;
  EXPECT_LE(accused, 4);  // of 2,000 sessions one is expected
}

INSTANTIATE_TEST_SUITE_P(Errors, NothingMoved, testing::Values(Independent, HeavyTailed, Bursts));

struct Hard {
  Draw draw;
  int accused_max;  // of 500
};
class HardlyMoved : public testing::TestWithParam<Hard> {};

TEST_P(HardlyMoved, IsRarelyAccused) {
  std::mt19937 random(19);
  int accused = 0;
  for (int session = 0; session < 500; ++session)
    accused += FindPairChange(BlocksOf(GetParam().draw(random)), 1).has_value() ? 1 : 0;
  EXPECT_LE(accused, GetParam().accused_max);
}

INSTANTIATE_TEST_SUITE_P(Errors, HardlyMoved,
                         testing::Values(Hard{Stops, 50}, Hard{Drift, 25}, Hard{WorseAtTheEnd, 25}));

TEST(PairChange, IsFoundWithItsCaptureAndStep) {
  std::mt19937 random(11);
  for (const std::size_t at : {10UL, 20UL, 31UL}) {
    Errors errors = Independent(random);
    Vector6d step;
    step << 0.014, -0.01, 0.01, 0.01, 0.008, -0.012;  // 20 mm and 1 deg
    for (std::size_t i = at; i < kCaptures; ++i) errors[i] += step;
    std::vector<BlockVector> blocks = BlocksOf(errors);
    std::reverse(blocks.begin(), blocks.end());
    const auto change = FindPairChange(blocks, 3);
    ASSERT_TRUE(change) << at;
    EXPECT_EQ(change->last_before, std::to_string(at - 1));
    EXPECT_EQ(change->first_after, std::to_string(at));
    const Vector6d off = change->step - step;
    EXPECT_LT(off.dot(change->information * off), 40.0);  // of six numbers and a scatter of 38
  }
}

TEST(PairChange, TheSmallestThatIsToldIsTold) {
  std::mt19937 random(13);
  int found = 0;
  constexpr int kSessions = 200;
  for (int session = 0; session < kSessions; ++session) {
    Errors errors = Independent(random);
    const SmallestMove told = SmallestPairChange(BlocksOf(errors), 1);
    EXPECT_LT(told.m, 0.03);
    for (std::size_t i = kCaptures / 2; i < kCaptures; ++i) errors[i][tangent::kX] += told.m;
    found += FindPairChange(BlocksOf(errors), 1).has_value() ? 1 : 0;
  }
  EXPECT_GE(found, 0.9 * kSessions);
}

TEST(PairChange, IsNotToldOfFewCapturesNorOfOpenDirections) {
  std::mt19937 random(17);
  Errors few = Independent(random);
  few.resize(kBlocksForChange - 1);
  for (std::size_t i = 6; i < few.size(); ++i) few[i] += Vector6d::Constant(0.1);
  EXPECT_FALSE(FindPairChange(BlocksOf(few), 1));
  EXPECT_EQ(SmallestPairChange(BlocksOf(few), 1).m, kAnyMove_m);
  Errors open = Independent(random);
  for (Vector6d& error : open) error[tangent::kRz] = 0.0;
  EXPECT_FALSE(FindPairChange(BlocksOf(open), 1));
  EXPECT_EQ(SmallestPairChange(BlocksOf(open), 1).rad, kAnyMove_rad);
  for (std::size_t i = 20; i < kCaptures; ++i) open[i][tangent::kX] += 0.03;
  EXPECT_TRUE(FindPairChange(BlocksOf(open), 1));
  EXPECT_FALSE(FindPairChange({}, 1));
}

}  // namespace
}  // namespace rigcal::calib
