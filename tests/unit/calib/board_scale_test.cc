// A tracker's metres tell how large the squares of a camera's board are.
#include <gmock/gmock.h>

#include <cmath>

#include "server/calib/motion/hand_eye_work.h"
#include "tests/unit/calib/virtual_motion.h"

namespace rigcal::calib {
namespace {

using testing::HasSubstr;

constexpr PoseNoise kTracker{0.0005, 0.0009};
constexpr double kTrue_m = 0.09;

VirtualView ViewOfTrueBoard(double sigma_px) {
  VirtualView view;
  view.board.square_m = kTrue_m;
  view.sigma_px = sigma_px;
  return view;
}

struct Visit {
  VirtualBody body;
  HandEyeProblem problem;  // a: the tracker, b: the camera
};

// The board is said to have squares of `said_m`.
Visit VisitOf(double said_m, unsigned seed, double sigma_px = 0.1, const PoseNoise& tracker = kTracker) {
  const VirtualView view = ViewOfTrueBoard(sigma_px);
  Visit visit{Looking(view, 25, 0.25, 0.12, seed), {}};
  visit.problem = TrackerAndCamera(visit.body, view, tracker, 0, seed);
  visit.problem.b.board->square_m = said_m;
  return visit;
}

std::optional<BoardScale> ScaleOf(const HandEyeProblem& problem) {
  const auto result = EstimateHandEye(problem);
  EXPECT_TRUE(result) << result.error().what;
  return result ? result->estimate.board_scale : std::nullopt;
}

TEST(BoardScale, IsExactOnExactMotionWhicheverSideTheCameraIs) {
  for (const double said_m : {0.065, 0.085, 0.09, 0.12}) {
    Visit visit = VisitOf(said_m, 1, 0.0, {});
    for (int side = 0; side < 2; ++side) {
      const auto scale = ScaleOf(visit.problem);
      ASSERT_TRUE(scale) << said_m;
      EXPECT_NEAR(scale->ratio, kTrue_m / said_m - 1, 1e-4) << said_m << " " << side;
      std::swap(visit.problem.a, visit.problem.b);
    }
  }
}

// (R_A - I) t_X = s R_X t_B - t_A of the motions between all captures, R_X known: t_X and s by least squares.
double ClosedFormScale(const VirtualBody& body, const HandEyeProblem& problem) {
  const auto camera = EstimateCamera({problem.b.sensor, *problem.b.board, problem.b.views});
  std::vector<std::pair<Se3, Se3>> poses;
  for (const TimedPose& row : problem.a.poses)
    if (const auto board = camera->T_cam_board.find(row.capture); board != camera->T_cam_board.end())
      poses.emplace_back(row.T_world_body, board->second.Inverse());
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < poses.size(); ++i)
    for (std::size_t j = i + 1; j < poses.size(); ++j) {
      const Se3 A = poses[i].first.Inverse() * poses[j].first, B = poses[i].second.Inverse() * poses[j].second;
      Eigen::Matrix<double, 3, 4> M;
      M << A.R() - Eigen::Matrix3d::Identity(), -body.X.R() * B.p_m;
      normal += M.transpose() * M;
      right -= M.transpose() * A.p_m;
    }
  return normal.ldlt().solve(right)[3];
}

TEST(BoardScale, AgreesWithTheClosedFormAndTheTruth) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    const Visit visit = VisitOf(0.085, seed);
    const auto scale = ScaleOf(visit.problem);
    ASSERT_TRUE(scale);
    EXPECT_LT(scale->sigma_ratio, 0.004);
    EXPECT_NEAR(scale->ratio, kTrue_m / 0.085 - 1, 5 * scale->sigma_ratio);
    EXPECT_NEAR(scale->ratio, ClosedFormScale(visit.body, visit.problem) - 1, 5 * scale->sigma_ratio);
  }
}

TEST(BoardScale, APairWhoseBoardIsOfAnotherSizeFailsForIt) {
  const Edge edge = EstimateHandEyeEdge(VisitOf(0.085, 3).problem);
  ASSERT_EQ(edge.state, EdgeState::kFailed);
  EXPECT_EQ(edge.diagnoses.front().code, "board_size_suspected");
  EXPECT_THAT(edge.diagnoses.front().what, HasSubstr("% larger than given: the motions of body and camera agree with"));
  EXPECT_THAT(edge.diagnoses.front().cure, HasSubstr("the camera's focal length or the tracker's scale is wrong"));
  EXPECT_EQ(edge.figures.at("board_square_m"), 0.085);
  EXPECT_NEAR(edge.figures.at("board_scale_ratio"), kTrue_m / 0.085 - 1,
              5 * edge.figures.at("board_scale_sigma_ratio"));
}

// Sigma is a tenth to a fifth of a per cent, so that a hundredth is five of them and more: chance accuses none of 200.
TEST(BoardScale, ABoardOfTheSizeGivenIsNotAccused) {
  int told = 0, accused = 0;
  double squares = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const HandEyeProblem problem = VisitOf(kTrue_m, 1000 + seed, 0.1, {0.001, 0.001}).problem;
    const auto scale = ScaleOf(problem);
    if (!scale) continue;
    ++told;
    squares += std::pow(scale->ratio / scale->sigma_ratio, 2);
    accused += scale->Contradicts(*problem.b.board) ? 1 : 0;
  }
  EXPECT_GE(told, 190);
  EXPECT_LE(accused, 1);
  EXPECT_NEAR(squares / told, 1.0, 0.5);
}

// A focal length that is given too long lengthens the camera's way along its view alone.
TEST(BoardScale, AWrongFocalLengthIsNotTheBoards) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    HandEyeProblem problem = VisitOf(kTrue_m, seed).problem;
    problem.b.sensor.intrinsics->fx_px *= 1.03;
    problem.b.sensor.intrinsics->fy_px *= 1.03;
    const auto scale = ScaleOf(problem);
    ASSERT_TRUE(scale);
    EXPECT_FALSE(scale->Contradicts(*problem.b.board)) << seed << " " << scale->ratio << " " << scale->sigma_ratio;
  }
}

TEST(BoardScale, WhatWasGivenAsUncertainIsNoContradiction) {
  Target board = ViewOfTrueBoard(0.1).board;
  const BoardScale larger{0.03, 0.001};
  EXPECT_TRUE(larger.Contradicts(board));
  board.square_sigma_m = 0.02 * board.square_m;
  EXPECT_FALSE(larger.Contradicts(board));
  EXPECT_FALSE((BoardScale{0.008, 0.001}.Contradicts(ViewOfTrueBoard(0.1).board))) << "too little to matter";
  EXPECT_FALSE((BoardScale{0.03, 0.01}.Contradicts(ViewOfTrueBoard(0.1).board))) << "by chance";
}

TEST(BoardScale, IsNotAskedOfTwoCamerasOrOfFewCaptures) {
  const VirtualView view = ViewOfTrueBoard(0.1);
  EXPECT_FALSE(ScaleOf(TwoCameras(Looking(view, 25, 0.25, 0.12, 2), view, true, 2)));
  HandEyeProblem few = VisitOf(0.085, 2).problem;
  few.b.views.resize(8);
  EXPECT_FALSE(ScaleOf(few));
}

// Turned about one line, the camera's way is as long as it is far from that line: which nobody knows.
TEST(BoardScale, IsNotToldByTurnsOnTheSpot) {
  const VirtualView view = ViewOfTrueBoard(0.1);
  VirtualBody body = Looking(view, 25, 0.0, 0.0, 4);
  const Se3 middle = body.T_world_a.front();
  for (std::size_t k = 0; k < body.T_world_a.size(); ++k) {
    const Eigen::Vector3d pivot(0.1, 0, -0.3);
    Se3 turn;
    turn.q = Eigen::AngleAxisd(0.3 * std::sin(1.3 * static_cast<double>(k)), Eigen::Vector3d::UnitY());
    turn.p_m = pivot - turn.q * pivot;
    body.T_world_a[k] = middle * turn;
  }
  const auto scale = ScaleOf(TrackerAndCamera(body, view, kTracker, 0, 4));
  EXPECT_FALSE(scale && scale->Contradicts(view.board)) << scale->ratio << " " << scale->sigma_ratio;
}

}  // namespace
}  // namespace rigcal::calib
