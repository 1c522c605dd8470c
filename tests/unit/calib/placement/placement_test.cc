// Where to hold the board next: against what is worked out by hand, dense algebra and geometry.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "server/calib/placement/next_placement.h"
#include "server/calib/placement/pair_ties.h"

namespace rigcal::calib::placement {
namespace {

Target Board() {
  Target board;
  board.id = TargetId("board");
  board.cols = 9, board.rows = 6;
  board.square_m = 0.08;
  return board;
}

PlannedCamera CameraAt(const char* name, double x_m, double yaw_rad) {
  PlannedCamera camera;
  camera.id = SensorId(name);
  camera.intrinsics.head<4>() << 450, 450, 319.5, 239.5;
  camera.width_px = 640, camera.height_px = 480;
  camera.corner_sigma_px = 0.2;
  camera.T_ref_camera = Se3{{x_m, 0, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()))};
  camera.boards = {0};
  return camera;
}

PlannedRig Pair() { return {{CameraAt("left", 0, 0), CameraAt("right", 0.3, 0)}, 0, {Board()}}; }

std::vector<int> AllCorners(const Target& board) {
  std::vector<int> idx(TargetPoints(board).size());
  for (std::size_t i = 0; i < idx.size(); ++i) idx[i] = static_cast<int>(i);
  return idx;
}

PlannedCapture Taken(const PlannedRig& rig, std::size_t camera, const Stand& stand) {
  PlannedCapture capture = CaptureAt(rig, 0, camera, PoseOf(stand, rig.boards[0]));
  for (PlannedLook& look : capture.looks) look.corner_idx = AllCorners(rig.boards[0]);
  return capture;
}

TEST(Stand, IsWhatWasSaidOfThePose) {
  const Stand stand{-0.4, 0.2, 1.7, 0.5, -0.3, 1.4};
  const Stand again = StandOf(PoseOf(stand, Board()), Board());
  EXPECT_NEAR(again.right_rad, stand.right_rad, 1e-12);
  EXPECT_NEAR(again.up_rad, stand.up_rad, 1e-12);
  EXPECT_NEAR(again.distance_m, stand.distance_m, 1e-12);
  EXPECT_NEAR(again.tilt_right_rad, stand.tilt_right_rad, 1e-12);
  EXPECT_NEAR(again.tilt_up_rad, stand.tilt_up_rad, 1e-12);
  EXPECT_NEAR(again.turned_rad, stand.turned_rad, 1e-12);
}

TEST(Stand, OnItsSideHasTheFirstRowDownThePicture) {
  const Target board = Board();
  const Se3 T_camera_board = PoseOf({0, 0, 2, 0, 0, M_PI / 2}, board);
  const Eigen::Vector3d first = T_camera_board * TargetPoints(board)[0], last = T_camera_board * TargetPoints(board)[8];
  EXPECT_NEAR((last - first).y(), 8 * board.square_m, 1e-12) << "clockwise: its right end is below";
  EXPECT_NEAR((last - first).x(), 0, 1e-12);
}

TEST(Stand, UpsideDownIsAsUprightAndOnItsSideIsNot) {
  const Stand upright{0.3, 0.1, 2, 0.4, 0};
  Stand turned = upright;
  turned.turned_rad = M_PI;
  EXPECT_TRUE(AreAlike(upright, turned));
  EXPECT_NEAR(TurnedAside_rad(turned), 0, 1e-12);
  turned.turned_rad = -M_PI / 2;
  EXPECT_FALSE(AreAlike(upright, turned));
  EXPECT_NEAR(TurnedAside_rad(turned), M_PI / 2, 1e-12);
}

TEST(Stand, OfABoardTiltedToTheRightHasItsRightSideNearer) {
  const Target board = Board();
  const auto depth = [&](const Stand& stand, std::size_t point) {
    return (PoseOf(stand, board) * TargetPoints(board)[point]).z();
  };
  const Stand right{0, 0, 2, 0.5, 0}, up{0, 0, 2, 0, 0.5};
  EXPECT_LT(depth(right, 8), depth(right, 0) - 0.2);  // the right end of the first row
  EXPECT_LT(depth(up, 0), depth(up, 45) - 0.1);       // the first row is above the last
}

TEST(SeesWhole, AsksForTheWholePatternLargeEnough) {
  const PlannedCamera camera = CameraAt("left", 0, 0);
  EXPECT_TRUE(SeesWhole(camera, Board(), PoseOf({0, 0, 2, 0, 0}, Board())));
  EXPECT_FALSE(SeesWhole(camera, Board(), PoseOf({0.6, 0, 2, 0, 0}, Board()))) << "cut by the border";
  EXPECT_FALSE(SeesWhole(camera, Board(), PoseOf({0, 0, 5, 0, 0}, Board()))) << "squares of 7 px";
  EXPECT_FALSE(SeesWhole(camera, Board(), PoseOf({0, 0, 2, 1.2, 0}, Board()))) << "too oblique";
}

// By differences of a projection that is written here, the board eliminated by dense algebra.
TEST(Information, OfOneCaptureIsThatOfTheRelativePose) {
  const PlannedRig rig = Pair();
  const UnknownsOfRig unknowns(rig);
  ASSERT_EQ(unknowns.size, 6);
  const PlannedCapture capture = Taken(rig, 0, {0.07, 0, 2, 0.4, 0});
  ASSERT_EQ(capture.looks.size(), 2U);
  const PartOfInformation part = InformationOf(rig, unknowns, capture);
  // Corners of both, in sigmas, by the sensor's pose and the board's.
  const auto corners = [&](const Se3& T_ref_right, const Se3& T_ref_board) {
    Eigen::VectorXd uv(4 * 54);
    Eigen::Index at = 0;
    for (const Se3& T_ref_camera : {Se3{}, T_ref_right})
      for (const Eigen::Vector3d& point : TargetPoints(rig.boards[0])) {
        const Eigen::Vector3d p = T_ref_camera.Inverse() * (T_ref_board * point);
        uv[at++] = (450 * p.x() / p.z()) / 0.2, uv[at++] = (450 * p.y() / p.z()) / 0.2;
      }
    return uv;
  };
  const Se3 T_ref_right = rig.cameras[1].T_ref_camera, T_ref_board = capture.looks[0].T_camera_board;
  Eigen::MatrixXd J(4 * 54, 12);
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = 1e-6 * Vector6d::Unit(i);
    J.col(i) =
        (corners(T_ref_right * Se3::Exp(step), T_ref_board) - corners(T_ref_right * Se3::Exp(-step), T_ref_board)) /
        2e-6;
    J.col(6 + i) =
        (corners(T_ref_right, T_ref_board * Se3::Exp(step)) - corners(T_ref_right, T_ref_board * Se3::Exp(-step))) /
        2e-6;
  }
  const Eigen::MatrixXd H = J.transpose() * J;
  const Eigen::MatrixXd reduced =
      H.topLeftCorner(6, 6) - H.topRightCorner(6, 6) * H.bottomRightCorner(6, 6).inverse() * H.bottomLeftCorner(6, 6);
  EXPECT_LT((part.H - reduced).norm(), 1e-5 * reduced.norm());
}

TEST(Information, OfNinePointsStandsForAllCorners) {
  const PlannedRig rig = Pair();
  const UnknownsOfRig unknowns(rig);
  const PlannedCapture capture = Taken(rig, 0, {0.07, 0.1, 1.8, 0.5, 0.2});
  const Eigen::MatrixXd all = InformationOf(rig, unknowns, capture).H,
                        nine = ExpectedInformation(rig, unknowns, capture).H;
  const Eigen::MatrixXd variances = all.inverse(), expected = nine.inverse();
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(std::sqrt(expected(i, i) / variances(i, i)), 1, 0.05) << i;
}

TEST(Information, OfOneLookSaysNothingOfPoses) {
  const PlannedRig rig = Pair();
  const UnknownsOfRig unknowns(rig);
  PlannedCapture capture = Taken(rig, 0, {0.07, 0, 2, 0.4, 0});
  capture.looks.erase(capture.looks.begin());
  const Eigen::MatrixXd covariance = CovarianceBy(rig, unknowns, std::vector{InformationOf(rig, unknowns, capture)});
  EXPECT_NEAR(std::sqrt(covariance(0, 0)), kGuessSigma_m, 1e-3);
}

// Its focal length is told as that on the axis: while xi changes, fx follows so that the latter stays.
TEST(Information, OfADoubleSphereIsByItsFocalLengthOnTheAxis) {
  PlannedRig rig = Pair();
  PlannedCamera& camera = rig.cameras[0];
  camera.model = CameraModel::kDoubleSphere;
  camera.intrinsics.head<6>() << 240, 241, 319.5, 239.5, -0.2, 0.6;
  camera.lens_sigma.head<6>().setConstant(0.3);
  const UnknownsOfRig unknowns(rig);
  PlannedCapture capture = Taken(rig, 0, {0.07, 0.1, 1.2, 0.5, 0.2});
  capture.looks.resize(1);
  const PartOfInformation part = InformationOf(rig, unknowns, capture);
  ASSERT_EQ(part.H.rows(), 6);
  const auto corners = [&](const Eigen::VectorXd& step) {
    IntrinsicsVector lens = camera.intrinsics;
    lens.head<6>() += step.head<6>();
    lens.head<2>() += step[4] * camera.intrinsics.head<2>() / 0.8;
    const Se3 T_camera_board = capture.looks[0].T_camera_board * Se3::Exp(step.tail<6>());
    Eigen::VectorXd uv(2 * 54);
    Eigen::Index at = 0;
    for (const Eigen::Vector3d& point : TargetPoints(rig.boards[0]))
      uv.segment<2>(2 * at++) = Project(camera.model, lens, T_camera_board * point).uv_px / camera.corner_sigma_px;
    return uv;
  };
  Eigen::MatrixXd J(2 * 54, 12);
  for (int i = 0; i < 12; ++i)
    J.col(i) = (corners(1e-6 * Eigen::VectorXd::Unit(12, i)) - corners(-1e-6 * Eigen::VectorXd::Unit(12, i))) / 2e-6;
  const Eigen::MatrixXd H = J.transpose() * J;
  const Eigen::MatrixXd reduced =
      H.topLeftCorner(6, 6) - H.topRightCorner(6, 6) * H.bottomRightCorner(6, 6).inverse() * H.bottomLeftCorner(6, 6);
  EXPECT_LT((part.H - reduced).norm(), 1e-4 * reduced.norm());
}

TEST(Variances, WithOneMorePartAreThoseOfTheSum) {
  PlannedRig rig = Pair();
  rig.cameras[1].lens_sigma.head<5>() << 50, 50, 20, 20, 0.3;
  const UnknownsOfRig unknowns(rig);
  const std::vector<PartOfInformation> parts = {InformationOf(rig, unknowns, Taken(rig, 0, {0.07, 0, 2, 0.4, 0})),
                                                InformationOf(rig, unknowns, Taken(rig, 0, {0.1, 0.1, 1.7, 0, 0.5}))};
  const Eigen::VectorXd updated = VariancesWith(CovarianceBy(rig, unknowns, {&parts[0], 1}), parts[1], unknowns.size);
  const Eigen::VectorXd whole = CovarianceBy(rig, unknowns, parts).diagonal();
  for (Eigen::Index i = 0; i < whole.size(); ++i) EXPECT_NEAR(updated[i] / whole[i], 1, 1e-5) << i;
}

TEST(PairTies, GoByTheWeakestPairOnTheBestWay) {
  PairTies ties(4);
  for (int i = 0; i < 3; ++i) ties.Add({0, {{0, {}, {}}, {1, {}, {}}}});
  ties.Add({0, {{1, {}, {}}, {2, {}, {}}}});
  EXPECT_EQ(ties.TiedBy(0, 3), (std::vector<int>{3, 3, 1, 0}));
  for (int i = 0; i < 2; ++i) ties.Add({0, {{0, {}, {}}, {2, {}, {}}}});
  EXPECT_EQ(ties.TiedBy(0, 3), (std::vector<int>{3, 3, 2, 0}));
}

// Held where it is told, a session comes to its end, and each placement keeps its promise.
TEST(Advice, LeadsToTheEnd) {
  const PlannedRig rig = {{CameraAt("a", 0, 0), CameraAt("b", 0.2, 0.7), CameraAt("c", 0.3, 1.4)}, 0, {Board()}};
  std::vector<PlannedCapture> captures;
  PlacementAdvice advice = AdviseOn(rig, captures);
  while (advice.next && captures.size() < 40) {
    const NextPlacement& next = *advice.next;
    EXPECT_GE(next.capture.looks.size(), 2U);
    EXPECT_LE(next.sigma_then, next.sigma_now);
    captures.push_back(next.capture);
    for (PlannedLook& look : captures.back().looks) look.corner_idx = AllCorners(rig.boards[0]);
    const PlacementAdvice after = AdviseOn(rig, captures);
    const double sigma = after.poses[next.of].sigma[std::min(next.axis, 5)];
    EXPECT_NEAR(sigma, next.sigma_then, 0.1 * next.sigma_then + 1e-6);
    advice = after;
  }
  EXPECT_TRUE(advice.is_enough);
  EXPECT_TRUE(advice.out_of_reach.empty());
  EXPECT_LT(captures.size(), 30U);
  for (std::size_t c = 1; c < 3; ++c) EXPECT_LE(advice.poses[c].of_tolerance, 1) << c;
}

TEST(PairTies, NameThePairsOfALoopThatCannotBeTested) {
  PlannedRig rig = {{CameraAt("a", 0, 0), CameraAt("b", 0.2, 0.7), CameraAt("c", 0.3, 1.4)}, 0, {Board()}};
  rig.pairs = {{0, 1}, {0, 2}, {1, 2}}, rig.captures_to_test = 5;
  PairTies ties(3);
  for (int i = 0; i < 3; ++i) ties.Add({0, {{0, {}, {}}, {1, {}, {}}}});
  for (int i = 0; i < 3; ++i) ties.Add({0, {{1, {}, {}}, {2, {}, {}}}});
  for (int i = 0; i < 2; ++i) ties.Add({0, {{0, {}, {}}, {2, {}, {}}}});
  EXPECT_TRUE(ties.Untested(rig).empty()) << "of two captures a pair has no pose";
  for (int i = 0; i < 2; ++i) ties.Add({0, {{0, {}, {}}, {1, {}, {}}, {2, {}, {}}}});
  const std::vector<UntestedPair> untested = ties.Untested(rig);
  ASSERT_EQ(untested.size(), 1U) << "two have their five";
  EXPECT_EQ(untested[0].a, 0U);
  EXPECT_EQ(untested[0].b, 2U);
  EXPECT_EQ(untested[0].lacking, 1);
  rig.pairs.pop_back();
  EXPECT_TRUE(ties.Untested(rig).empty()) << "what the session does not calibrate closes no loop";
}

// Of a loop every pair gets the captures by which the server tests it.
TEST(Advice, GoesOnUntilThePairsOfALoopCanBeTested) {
  PlannedRig rig = {{CameraAt("a", 0, 0), CameraAt("b", 0.2, 0.3), CameraAt("c", 0.3, 0.6)}, 0, {Board()}};
  rig.pairs = {{0, 1}, {0, 2}, {1, 2}}, rig.captures_to_test = 14;
  std::vector<PlannedCapture> captures;
  PairTies ties(3);
  PlacementAdvice advice = AdviseOn(rig, captures);
  for (; advice.next && captures.size() < 40; advice = AdviseOn(rig, captures)) {
    captures.push_back(advice.next->capture);
    for (PlannedLook& look : captures.back().looks) look.corner_idx = AllCorners(rig.boards[0]);
    ties.Add(captures.back());
  }
  EXPECT_TRUE(advice.is_enough);
  EXPECT_LT(captures.size(), 30U);
  for (const auto& [a, b] : rig.pairs)
    EXPECT_TRUE(ties.Together(a, b) < kSharedCapturesMin || ties.Together(a, b) >= 14) << a << " - " << b;
}

// Views of 71 degrees, 50 apart: what a hand may be off counted in, an upright board has hardly a place in both.
TEST(Advice, TurnsABoardOnItsSideWhereCamerasHardlyOverlap) {
  const PlannedRig rig = {{CameraAt("a", 0, 0), CameraAt("b", 0.1, 0.87)}, 0, {Board()}};
  const PlacementAdvice advice = AdviseOn(rig, {});
  EXPECT_TRUE(advice.out_of_reach.empty());
  ASSERT_TRUE(advice.next);
  EXPECT_EQ(advice.next->capture.looks.size(), 2U);
  EXPECT_GT(TurnedAside_rad(advice.next->stand), 1.2);
}

// From fewer than eight a sigma is not believed, but it is small before they are there.
TEST(Advice, BringsSigmasDownBeforeItCountsCaptures) {
  const PlannedRig rig = {{CameraAt("a", 0, 0), CameraAt("b", 0.2, 0.7), CameraAt("c", 0.3, 1.4)}, 0, {Board()}};
  std::vector<PlannedCapture> captures;
  for (int i = 0; i < 5; ++i) {
    const PlacementAdvice advice = AdviseOn(rig, captures);
    ASSERT_TRUE(advice.next);
    captures.push_back(advice.next->capture);
    for (PlannedLook& look : captures.back().looks) look.corner_idx = AllCorners(rig.boards[0]);
  }
  const PlacementAdvice advice = AdviseOn(rig, captures);
  for (std::size_t c = 1; c < 3; ++c) EXPECT_LE(advice.poses[c].pose_of_tolerance, 1) << c;
  EXPECT_FALSE(advice.is_enough) << "eight of each pair are wanted";
}

TEST(Missing, CountsASigmaThatIsTooLargeBeforeCaptures) {
  PoseSoFar wide, few;
  wide.sigma_of_tolerance = 1.5, wide.tied_by = 8;
  few.sigma_of_tolerance = 0.9, few.tied_by = 1;
  EXPECT_GT(MissingOf(wide), MissingOf(few));
  PoseSoFar more = few;
  more.tied_by = 2;
  EXPECT_LT(MissingOf(more), MissingOf(few));
  EXPECT_EQ(MissingOf({wide, few}, {1}), MissingOf(wide));
}

TEST(Advice, IsTheSameForTheSame) {
  const PlannedRig rig = Pair();
  const std::vector<PlannedCapture> captures = {Taken(rig, 0, {0.07, 0, 2, 0.4, 0})};
  const PlacementAdvice one = AdviseOn(rig, captures), two = AdviseOn(rig, captures);
  ASSERT_TRUE(one.next && two.next);
  EXPECT_EQ(one.next->T_camera_board, two.next->T_camera_board);
}

TEST(Advice, NamesACameraThatNoBoardCanTie) {
  PlannedRig rig = Pair();
  rig.cameras.push_back(CameraAt("back", 0, M_PI));
  const PlacementAdvice advice = AdviseOn(rig, {});
  EXPECT_EQ(advice.out_of_reach, std::vector<std::size_t>{2});
  ASSERT_TRUE(advice.next) << "the other two can be tied all the same";
}

TEST(Advice, DoesNotAskForTheSamePlaceTwice) {
  const PlannedRig rig = Pair();
  std::vector<PlannedCapture> captures;
  for (int i = 0; i < 2; ++i) {
    const PlacementAdvice advice = AdviseOn(rig, captures);
    ASSERT_TRUE(advice.next);
    captures.push_back(advice.next->capture);
    for (PlannedLook& look : captures.back().looks) look.corner_idx = AllCorners(rig.boards[0]);
  }
  const Stand first = StandOf(captures[0].looks[0].T_camera_board, rig.boards[0]);
  const Stand second = StandOf(captures[1].looks[0].T_camera_board, rig.boards[0]);
  const double apart = std::abs(first.right_rad - second.right_rad) + std::abs(first.up_rad - second.up_rad) +
                       std::abs(first.tilt_right_rad - second.tilt_right_rad) +
                       std::abs(first.tilt_up_rad - second.tilt_up_rad) +
                       std::abs(first.distance_m - second.distance_m);
  EXPECT_GT(apart, 0.1);
}

}  // namespace
}  // namespace rigcal::calib::placement
