#include <gmock/gmock.h>

#include "server/calib/stereo/pair_start.h"
#include "tests/unit/calib/virtual_pair.h"

namespace rigcal::calib {
namespace {

// Every capture offers the true poses and a wrong one; two captures offer wrong ones only.
TEST(Consensus, FindsThePairAmongWrongPoses) {
  const VirtualPair pair;
  std::vector<PoseCandidates> captures;
  const std::vector<Se3> boards = TiltedBoards(8);
  for (std::size_t k = 0; k < boards.size(); ++k) {
    const Se3 wrong = boards[k] * Se3::Exp(0.5 * Vector6d::Unit(3 + static_cast<int>(k % 3)));
    PoseCandidates candidates{{wrong, boards[k]}, {pair.T_a_b.Inverse() * boards[k]}};
    if (k < 2) candidates.T_a_board = {wrong};
    captures.push_back(candidates);
  }
  const auto T_a_b = ConsensusOf(captures);
  ASSERT_TRUE(T_a_b);
  EXPECT_LT((T_a_b->Matrix() - pair.T_a_b.Matrix()).norm(), 1e-9);
}

// Half of the captures say one pose, half another; one says a third.
TEST(Consensus, RivalsAreThoseWithAboutAsManyVotes) {
  const VirtualPair pair;
  const Se3 other = pair.T_a_b * Se3::Exp(0.8 * Vector6d::Unit(4)),
            lonely = pair.T_a_b * Se3::Exp(1.6 * Vector6d::Unit(4));
  std::vector<PoseCandidates> captures;
  const std::vector<Se3> boards = TiltedBoards(9);
  for (std::size_t k = 0; k < boards.size(); ++k) {
    const Se3& T_a_b = k == 8 ? lonely : k % 2 == 0 ? pair.T_a_b : other;
    captures.push_back({{boards[k]}, {T_a_b.Inverse() * boards[k]}});
  }
  const auto T_a_b = ConsensusOf(captures);
  ASSERT_TRUE(T_a_b);
  const std::vector<Se3> rivals = RivalsOf(captures, *T_a_b, 3);
  ASSERT_EQ(rivals.size(), 1U);
  const double distance_m = MedianDistance_m(captures);
  EXPECT_LT(std::min(Discrepancy(*T_a_b, pair.T_a_b, distance_m), Discrepancy(rivals[0], pair.T_a_b, distance_m)),
            1e-6);
  EXPECT_LT(std::min(Discrepancy(*T_a_b, other, distance_m), Discrepancy(rivals[0], other, distance_m)), 1e-6);
  EXPECT_TRUE(RivalsOf(captures, *T_a_b, 0).empty());
}

TEST(Consensus, IsEmptyWithoutCandidates) {
  EXPECT_FALSE(ConsensusOf({}));
  EXPECT_FALSE(ConsensusOf({{{Se3()}, {}}}));
}

}  // namespace
}  // namespace rigcal::calib
