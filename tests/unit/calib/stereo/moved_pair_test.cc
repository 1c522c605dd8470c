// One of two cameras that was moved while captures were taken.
#include "server/calib/stereo/moved_pair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/calib/virtual_pair.h"

namespace rigcal::calib {
namespace {

constexpr double kNoise_px = 0.1, kLimit_px = 1.0;

Vector6d Step(double m, double rad) {
  Vector6d step;
  step << m, 0, 0, 0, rad, 0;
  return step;
}

// From capture `first_after` on camera b sits elsewhere.
StereoProblem MovedAt(std::size_t first_after, const Vector6d& step, int captures) {
  const VirtualPair before;
  VirtualPair after = before;
  after.T_a_b = before.T_a_b * Se3::Exp(step);
  const std::vector<Se3> boards = TiltedBoards(captures);
  StereoProblem problem = Photographed(before, boards, kNoise_px, 1);
  const StereoProblem then = Photographed(after, boards, kNoise_px, 2);
  for (std::size_t idx = first_after; idx < problem.captures.size(); ++idx) problem.captures[idx] = then.captures[idx];
  return problem;
}

StereoProblem WithLensesGiven(StereoProblem problem) {
  const VirtualPair pair;
  problem.camera_a.intrinsics = pair.a;
  problem.camera_b.intrinsics = pair.b;
  return problem;
}

TEST(MovedPair, IsFoundWithItsCapturesAndItsStep) {
  for (const std::size_t first_after : {6U, 13U, 23U}) {
    const Vector6d step = Step(0.012, 0.0175);
    const StereoProblem estimated = MovedAt(first_after, step, 30);
    for (const StereoProblem& problem : {estimated, WithLensesGiven(estimated)}) {
      const auto move = FindPairMove(problem, kLimit_px);
      ASSERT_TRUE(move) << first_after;
      EXPECT_EQ(move->last_before_idx, first_after - 1);
      EXPECT_EQ(move->first_after_idx, first_after);
      EXPECT_LT((move->step - step).head<3>().norm(), 1e-3);
      EXPECT_LT((move->step - step).tail<3>().norm(), 1e-3);
      EXPECT_LT(move->rms_px, 3 * kNoise_px);
    }
  }
}

// Names whose numbers have no leading zeros sort otherwise than they were taken; repeated captures contradict nothing.
TEST(MovedPair, IsLookedForInTheOrderInWhichCapturesWereTaken) {
  StereoProblem problem = MovedAt(9, Step(0.012, 0.0175), 24);
  for (std::size_t idx = 0; idx < problem.captures.size(); ++idx)
    problem.captures[idx].capture = CaptureId(std::to_string(idx + 1));
  std::sort(problem.captures.begin(), problem.captures.end(),
            [](const StereoCapture& x, const StereoCapture& y) { return x.capture < y.capture; });
  const auto move = FindPairMove(problem, kLimit_px);
  ASSERT_TRUE(move);
  EXPECT_EQ(problem.captures[move->last_before_idx].capture.str(), "9");
  EXPECT_EQ(problem.captures[move->first_after_idx].capture.str(), "10");
}

TEST(MovedPair, IsNotMadeOfBoardPosesThatARobotRepeats) {
  StereoProblem problem = MovedAt(15, Vector6d::Zero(), 15);
  const std::vector<StereoCapture> once = problem.captures;
  for (StereoCapture again : once) {
    again.capture = CaptureId("1" + again.capture.str());
    problem.captures.push_back(std::move(again));
  }
  EXPECT_FALSE(FindPairMove(problem, kLimit_px));
  EXPECT_EQ(EstimateEdge(problem).state, EdgeState::kGood);
}

// However far, so that all captures of one side are left out as contradicting those of the other.
TEST(MovedPair, FailsItsEdgeAndIsWhatIsSaidFirst) {
  for (const Vector6d& step : {Step(0.012, 0.0175), Step(0.05, 0.17)}) {
    const Edge edge = EstimateEdge(MovedAt(12, step, 30));
    ASSERT_EQ(edge.state, EdgeState::kFailed);
    EXPECT_EQ(edge.diagnoses.front().code, "moved_within");
    EXPECT_EQ(edge.figures.at("moved_after_idx"), 11);
    EXPECT_EQ(edge.figures.at("moved_from_idx"), 12);
    EXPECT_NEAR(edge.figures.at("moved_m"), step.head<3>().norm(), 1e-3);
    EXPECT_NEAR(edge.figures.at("moved_rad"), step.tail<3>().norm(), 1e-3);
  }
}

TEST(MovedPair, IsNotFoundWhereNothingMoved) {
  EXPECT_FALSE(FindPairMove(MovedAt(30, Vector6d::Zero(), 30), kLimit_px));
  EXPECT_FALSE(FindPairMove(MovedAt(3, Step(0.012, 0.0175), 9), kLimit_px)) << "too few captures for two poses";
}

// Boards first near, then far, before a lens that is given 5 % too long: as if that camera had been moved along its
// axis.
TEST(MovedPair, IsNotMadeOfLensesThatAreGivenWrong) {
  const VirtualPair pair;
  std::vector<Se3> boards;
  for (int i = 0; i < 24; ++i) {
    const double z_m = i < 12 ? 0.4 : 1.0, turn = 0.5 * i;
    boards.push_back(BoardAt(pair, {0.02 * std::cos(turn), 0.02 * std::sin(turn), z_m},
                             {0.5 * std::cos(2 * turn), 0.5 * std::sin(2 * turn), 0.1 * (i % 5)}));
  }
  StereoProblem problem = WithLensesGiven(Photographed(pair, boards, kNoise_px, 3));
  problem.camera_b.intrinsics->fx_px *= 1.05, problem.camera_b.intrinsics->fy_px *= 1.05;
  EXPECT_FALSE(FindPairMove(problem, kLimit_px));
  EXPECT_EQ(EstimateEdge(problem).figures.count("moved_m"), 0U);
}

// Pictures of other instants contradict each other at any time, not from one on.
TEST(MovedPair, IsNotMadeOfPicturesOfOtherInstants) {
  StereoProblem problem = MovedAt(30, Vector6d::Zero(), 30);
  for (std::size_t idx = 2; idx + 2 < problem.captures.size(); idx += 5)
    std::swap(problem.captures[idx].b, problem.captures[idx + 2].b);
  EXPECT_FALSE(FindPairMove(problem, kLimit_px));
  for (std::size_t idx = 15; idx + 1 < problem.captures.size(); ++idx)  // names that are off by one from the middle on
    problem.captures[idx].b = problem.captures[idx + 1].b;
  EXPECT_FALSE(FindPairMove(problem, kLimit_px));
}

}  // namespace
}  // namespace rigcal::calib
