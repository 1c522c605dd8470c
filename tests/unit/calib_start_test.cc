#include <gmock/gmock.h>

#include "server/calib/pair_start.h"
#include "tests/unit/calib_virtual_pair.h"

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

TEST(Consensus, IsEmptyWithoutCandidates) {
  EXPECT_FALSE(ConsensusOf({}));
  EXPECT_FALSE(ConsensusOf({{{Se3()}, {}}}));
}

}  // namespace
}  // namespace rigcal::calib
