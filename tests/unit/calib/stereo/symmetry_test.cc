// Boards that look alike when turned: each camera numbers their corners as it likes.
#include <gmock/gmock.h>

#include <cstring>

#include "tests/unit/calib/virtual_pair.h"

namespace rigcal::calib {
namespace {

using testing::HasSubstr;

double PoseDifference(const Se3& T, const Se3& S) { return (T.Matrix() - S.Matrix()).cwiseAbs().maxCoeff(); }

VirtualPair PairWithBoard(int cols, int rows) {
  VirtualPair pair;
  pair.board.cols = cols;
  pair.board.rows = rows;
  return pair;
}

int TurnOf(std::size_t k, int symmetry) {
  return static_cast<int>((k * k + k / 2) % static_cast<std::size_t>(symmetry));
}

// Camera b numbers the board of capture k as if turned by TurnOf(k).
StereoProblem Turned(const VirtualPair& pair, const std::vector<Se3>& boards, double sigma_px, unsigned seed) {
  StereoProblem problem = Photographed(pair, boards, sigma_px, seed);
  const int symmetry = SymmetryOf(pair.board);
  for (std::size_t k = 0; k < problem.captures.size(); ++k)
    problem.captures[k].b = SeenFrom(*problem.captures[k].b, pair.board, TurnOf(k, symmetry));
  return problem;
}

void ExpectRecovered(const VirtualPair& pair) {
  const StereoProblem problem = Turned(pair, TiltedBoards(12), 0, 0);
  const auto estimate = Estimate(problem);
  ASSERT_TRUE(estimate) << estimate.error().what;
  EXPECT_LT(PoseDifference(estimate->T_a_b, pair.T_a_b), 1e-7);
  const int symmetry = SymmetryOf(pair.board);
  for (std::size_t k = 0; k < 12; ++k) {
    const auto found = estimate->turn_b.find(problem.captures[k].capture);
    const int turn = found == estimate->turn_b.end() ? 0 : found->second;
    EXPECT_EQ((turn + TurnOf(k, symmetry)) % symmetry, 0) << k;
  }
}

TEST(Symmetry, HalfTurnsPerCaptureAreFound) {
  ExpectRecovered(PairWithBoard(7, 5));
  ExpectRecovered(PairWithBoard(8, 6));
}

TEST(Symmetry, QuarterTurnsPerCaptureAreFound) { ExpectRecovered(PairWithBoard(6, 6)); }

TEST(Symmetry, AnOddSquareBoardTurnsByHalves) { ExpectRecovered(PairWithBoard(7, 7)); }

TEST(Symmetry, TheJackknifeKeepsTheTurns) {
  const VirtualPair pair = PairWithBoard(7, 5);
  const StereoProblem turned = Turned(pair, TiltedBoards(12), 0.2, 5),
                      plain = Photographed(pair, TiltedBoards(12), 0.2, 5);
  const Edge edge = EstimateEdge(turned), other = EstimateEdge(plain);
  ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses.at(0).what;
  ASSERT_EQ(other.state, EdgeState::kGood);
  EXPECT_LT(PoseDifference(edge.T_a_b, other.T_a_b), 1e-8);
  ASSERT_EQ(edge.uncertainty.blocks.size(), 12U);
  for (std::size_t k = 0; k < 12; ++k)
    EXPECT_LT((edge.uncertainty.blocks[k].d - other.uncertainty.blocks[k].d).norm(), 1e-8) << k;
}

TEST(Symmetry, AWarmStartKeepsTheTurns) {
  const StereoProblem problem = Turned(PairWithBoard(7, 5), TiltedBoards(12), 0.2, 5);
  const auto cold = Estimate(problem);
  ASSERT_TRUE(cold);
  const auto warm = Estimate(problem, &*cold);
  ASSERT_TRUE(warm) << warm.error().what;
  EXPECT_EQ(cold->turn_b, warm->turn_b);
  EXPECT_LT(PoseDifference(cold->T_a_b, warm->T_a_b), 1e-9);
}

TEST(Symmetry, ARepeatedCaptureIsSeenThroughItsTurn) {
  const VirtualPair pair = PairWithBoard(7, 5);
  std::vector<Se3> boards = TiltedBoards(10);
  boards.push_back(boards[4]);
  const auto estimate = Estimate(Turned(pair, boards, 0.1, 5));
  ASSERT_TRUE(estimate);
  EXPECT_THAT(estimate->residuals[10].note, HasSubstr("shows the same as 004"));
}

// A board that is only spun about its own normal: half a turn of it in b is another pose of b.
std::vector<Se3> SpunBoards(const VirtualPair& pair) {
  Se3 resting = BoardAt(pair, {0.05, 0.01, 0.5}, {0.3, 0.2, 0});
  const Eigen::Vector3d centre = CentreOf(pair.board);
  std::vector<Se3> boards;
  for (int k = 0; k < 8; ++k) {
    Se3 spin;
    spin.q = Eigen::AngleAxisd(0.15 * k, Eigen::Vector3d::UnitZ());
    spin.p_m = centre - spin.R() * centre;
    boards.push_back(resting * spin);
  }
  return boards;
}

StereoProblem Spun(int cols, int rows) {
  const VirtualPair pair = PairWithBoard(cols, rows);
  StereoProblem problem = Turned(pair, SpunBoards(pair), 0.2, 5);
  problem.camera_a.intrinsics = pair.a;
  problem.camera_b.intrinsics = pair.b;
  return problem;
}

TEST(Symmetry, ABoardThatOnlySpinsIsAmbiguous) {
  const Edge edge = EstimateEdge(Spun(7, 5));
  ASSERT_EQ(edge.state, EdgeState::kFailed);
  ASSERT_FALSE(edge.diagnoses.empty());
  EXPECT_EQ(edge.diagnoses[0].code, "ambiguous_board") << edge.diagnoses[0].what;
  EXPECT_THAT(edge.diagnoses[0].what, HasSubstr("target 'board' (7 x 5) looks the same turned by 180 deg"));
  EXPECT_THAT(edge.diagnoses[0].what, HasSubstr("8 captures fit 2 different poses"));
  EXPECT_THAT(edge.diagnoses[0].cure, HasSubstr("nominal poses"));
}

TEST(Symmetry, RoundingDoesNotDecideExactData) {
  const VirtualPair pair = PairWithBoard(7, 5);
  StereoProblem problem = Turned(pair, SpunBoards(pair), 0, 0);
  problem.camera_a.intrinsics = pair.a;
  problem.camera_b.intrinsics = pair.b;
  EXPECT_EQ(EstimateEdge(problem).diagnoses.at(0).code, "ambiguous_board");
}

TEST(Symmetry, AnEvenSquareBoardThatOnlySpinsFitsFourPoses) {
  const Edge edge = EstimateEdge(Spun(6, 6));
  ASSERT_EQ(edge.state, EdgeState::kFailed);
  EXPECT_EQ(edge.diagnoses.at(0).code, "ambiguous_board") << edge.diagnoses[0].what;
  EXPECT_THAT(edge.diagnoses[0].what, HasSubstr("turned by 90 deg, and its 8 captures fit 4 different poses"));
}

TEST(Symmetry, ABoardWithOneOddCountIsNot) { EXPECT_EQ(EstimateEdge(Spun(9, 6)).state, EdgeState::kGood); }

TEST(Symmetry, NominalPosesDecide) {
  for (const int rows : {5, 7}) {
    StereoProblem problem = Spun(7, rows);
    problem.camera_a.T_ref_nominal = Se3();
    // Off by 5 degrees and 3 cm.
    problem.camera_b.T_ref_nominal = VirtualPair().T_a_b * Se3::Exp((Vector6d() << 0.03, 0, 0, 0, 0.087, 0).finished());
    const auto estimate = Estimate(problem);
    ASSERT_TRUE(estimate) << estimate.error().what;
    EXPECT_LT(PoseDifference(estimate->T_a_b, VirtualPair().T_a_b), 0.01);
  }
}

TEST(Symmetry, ANominalPoseInTheMiddleDoesNot) {
  StereoProblem problem = Spun(7, 5);
  const Se3 T_a_board = SpunBoards(PairWithBoard(7, 5))[0];
  // A quarter of a turn about the board's normal lies between the two.
  Se3 quarter;
  quarter.q = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d centre = CentreOf(problem.board);
  quarter.p_m = centre - quarter.R() * centre;
  problem.camera_a.T_ref_nominal = Se3();
  problem.camera_b.T_ref_nominal = T_a_board * quarter * T_a_board.Inverse() * VirtualPair().T_a_b;
  EXPECT_EQ(EstimateEdge(problem).diagnoses.at(0).code, "ambiguous_board");
}

TEST(Symmetry, OneSensorsNominalPoseIsNotEnough) {
  StereoProblem problem = Spun(7, 5);
  problem.camera_b.T_ref_nominal = VirtualPair().T_a_b;
  EXPECT_EQ(EstimateEdge(problem).diagnoses.at(0).code, "ambiguous_board");
}

TEST(Symmetry, TheSameInputGivesTheSameBits) {
  const StereoProblem problem = Turned(PairWithBoard(6, 6), TiltedBoards(9), 0.2, 5);
  const Edge first = EstimateEdge(problem), second = EstimateEdge(problem);
  ASSERT_EQ(first.state, EdgeState::kGood);
  EXPECT_EQ(std::memcmp(&first.T_a_b.p_m, &second.T_a_b.p_m, sizeof first.T_a_b.p_m), 0);
  EXPECT_EQ(first.uncertainty.Omega, second.uncertainty.Omega);
}

}  // namespace
}  // namespace rigcal::calib
