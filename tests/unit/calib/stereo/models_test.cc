// Camera pairs of every model, views in part, and what a reader is told about them.
#include <gmock/gmock.h>

#include "tests/unit/calib/virtual_pair.h"

namespace rigcal::calib {
namespace {

using testing::HasSubstr;

double Difference(const Se3& T, const Se3& S) { return (T.Matrix() - S.Matrix()).cwiseAbs().maxCoeff(); }

std::vector<Se3> BoardsFor(CameraModel model, int count) {
  return model == CameraModel::kPinholeRadtan ? TiltedBoards(count) : SpreadBoards(count);
}

class PairOfModel : public testing::TestWithParam<CameraModel> {
 protected:
  VirtualPair pair_ = PairOf(GetParam());
  std::vector<Se3> boards_ = BoardsFor(GetParam(), 16);
};
INSTANTIATE_TEST_SUITE_P(All, PairOfModel,
                         testing::Values(CameraModel::kPinholeRadtan, CameraModel::kPinholeRational,
                                         CameraModel::kFisheyeKb4, CameraModel::kEucm, CameraModel::kDoubleSphere),
                         [](const auto& tested) { return NameOf(tested.param); });

TEST_P(PairOfModel, ExactDataGiveTheExactAnswer) {
  const auto estimate = Estimate(Photographed(pair_, boards_, 0, 0));
  ASSERT_TRUE(estimate) << estimate.error().what;
  EXPECT_LT(Difference(estimate->T_a_b, pair_.T_a_b), 1e-7);
  EXPECT_LT(Difference(estimate->T_a_board.at(CaptureId("003")), boards_[3]), 1e-7);
  EXPECT_NEAR(estimate->intrinsics_a.fx_px, pair_.a.fx_px, 1e-3);
  EXPECT_NEAR(estimate->intrinsics_b.cy_px, pair_.b.cy_px, 1e-3);
  EXPECT_EQ(estimate->intrinsics_a.model, GetParam());
  EXPECT_LT(estimate->rms_px, 1e-6);
}

TEST_P(PairOfModel, NoisyDataStayWithinTheStatedUncertainty) {
  const Edge edge = EstimateEdge(Photographed(pair_, boards_, 0.1, 4));
  ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses.at(0).what;
  const Vector6d error = (pair_.T_a_b.Inverse() * edge.T_a_b).Log();
  const Vector6d sigma = edge.uncertainty.covariance.diagonal().cwiseSqrt();
  for (int axis = 0; axis < 6; ++axis) EXPECT_LT(std::abs(error[axis]), 5 * sigma[axis]) << axis;
  EXPECT_NEAR(edge.figures.at("rms_px"), 0.1 * std::sqrt(2.0), 0.02);
}

TEST_P(PairOfModel, GivenIntrinsicsStayAsGiven) {
  StereoProblem problem = Photographed(pair_, boards_, 0, 0);
  problem.camera_a.intrinsics = pair_.a;
  problem.camera_b.intrinsics = pair_.b;
  const auto estimate = Estimate(problem);
  ASSERT_TRUE(estimate) << estimate.error().what;
  EXPECT_EQ(estimate->intrinsics_b.distortion, pair_.b.distortion);
  EXPECT_LT(Difference(estimate->T_a_b, pair_.T_a_b), 1e-8);
}

TEST_P(PairOfModel, FiguresNameTheDistortionOfTheModel) {
  const Edge edge = EstimateEdge(Photographed(pair_, boards_, 0.1, 4));
  for (const std::string& name : DistortionNames(GetParam())) {
    EXPECT_EQ(edge.figures.count(name + "_a_ratio"), 1U) << name;
    EXPECT_EQ(edge.figures.count(name + "_b_ratio"), 1U) << name;
  }
  EXPECT_EQ(edge.figures.count("p1_a_ratio"), IsPinhole(GetParam()) ? 1U : 0U);
  EXPECT_EQ(edge.figures.count("k6_a_ratio"), GetParam() == CameraModel::kPinholeRational ? 1U : 0U);
}

// The last given number of the model moves the result as estimating again with that number moved does.
TEST_P(PairOfModel, GivenIntrinsicsBringTheirUncertainty) {
  StereoProblem problem = Photographed(pair_, boards_, 0.1, 4);
  problem.camera_a.intrinsics = pair_.a;
  problem.camera_b.intrinsics = pair_.b;
  std::vector<double> sigma(4 + DistortionCount(GetParam()), 0.0);
  sigma.back() = 1e-3;
  problem.camera_b.intrinsics_sigma = sigma;
  const auto estimate = Estimate(problem);
  ASSERT_TRUE(estimate);
  const auto uncertainty = Jackknife(problem, *estimate);
  ASSERT_TRUE(uncertainty);
  ASSERT_EQ(uncertainty->contributions.size(), 1U);
  StereoProblem moved = problem;
  moved.camera_b.intrinsics->distortion.back() += 1e-3;
  const auto other = Estimate(moved);
  ASSERT_TRUE(other);
  const Vector6d shift = (estimate->T_a_b.Inverse() * other->T_a_b).Log();
  const Vector6d stated = uncertainty->contributions[0].covariance.diagonal().cwiseSqrt();
  EXPECT_GT(shift.norm(), 0);
  EXPECT_LT((shift.cwiseAbs() - stated).cwiseAbs().maxCoeff(), 0.05 * shift.norm());
}

TEST_P(PairOfModel, EachCameraMaySeeItsOwnPart) {
  StereoProblem problem = Photographed(pair_, boards_, 0, 0);
  problem.camera_a.intrinsics = pair_.a;
  problem.camera_b.intrinsics = pair_.b;
  for (std::size_t k = 0; k < problem.captures.size(); ++k) {
    StereoCapture& capture = problem.captures[k];
    const int split = 3 + static_cast<int>(k % 4);
    capture.a = Part(*capture.a, problem.board, 0, split);
    capture.b = Part(*capture.b, problem.board, split, 9);
  }
  const auto estimate = Estimate(problem);
  ASSERT_TRUE(estimate) << estimate.error().what;
  EXPECT_EQ(estimate->T_a_board.size(), 16U);
  EXPECT_LT(Difference(estimate->T_a_b, pair_.T_a_b), 1e-7);
}

TEST(MixedPair, AFisheyeAndAPinhole) {
  VirtualPair pair = PairOf(CameraModel::kFisheyeKb4);
  pair.b = VirtualPair().b;
  const StereoProblem problem = Photographed(pair, TiltedBoards(14), 0, 0);
  StereoProblem given = problem;
  given.camera_a.intrinsics = pair.a;
  const auto estimate = Estimate(given);
  ASSERT_TRUE(estimate) << estimate.error().what;
  EXPECT_EQ(estimate->intrinsics_b.model, CameraModel::kPinholeRadtan);
  EXPECT_LT(Difference(estimate->T_a_b, pair.T_a_b), 1e-7);
}

TEST(PartialViews, EstimatedIntrinsicsToo) {
  const VirtualPair pair;
  StereoProblem problem = Photographed(pair, TiltedBoards(14), 0, 0);
  for (std::size_t k = 0; k < problem.captures.size(); ++k) {
    problem.captures[k].a = Part(*problem.captures[k].a, problem.board, k % 2 == 0 ? 0 : 3, k % 2 == 0 ? 6 : 9);
    problem.captures[k].b = Part(*problem.captures[k].b, problem.board, k % 3 == 0 ? 0 : 2, 9);
  }
  const auto estimate = Estimate(problem);
  ASSERT_TRUE(estimate) << estimate.error().what;
  EXPECT_LT(Difference(estimate->T_a_b, pair.T_a_b), 1e-7);
  EXPECT_NEAR(estimate->intrinsics_a.fx_px, pair.a.fx_px, 1e-4);
}

StereoProblem WithFirstView(const BoardView& view) {
  StereoProblem problem = Photographed(VirtualPair(), TiltedBoards(10), 0.1, 4);
  problem.camera_a.intrinsics = VirtualPair().a;
  problem.camera_b.intrinsics = VirtualPair().b;
  problem.captures[0].b = view;
  return problem;
}

void ExpectUnused(const BoardView& view, const std::string& why) {
  const auto estimate = Estimate(WithFirstView(view));
  ASSERT_TRUE(estimate) << estimate.error().what;
  EXPECT_FALSE(estimate->residuals[0].used);
  EXPECT_THAT(estimate->residuals[0].note, HasSubstr(why));
}

TEST(PartialViews, TooLittleOfTheTargetIsSaid) {
  const StereoProblem problem = Photographed(VirtualPair(), TiltedBoards(1), 0.1, 4);
  const BoardView whole = *problem.captures[0].b;
  ExpectUnused(Part(whole, problem.board, 0, 1), "front_right: the points of the target that are seen lie on one line");
  BoardView few = whole;
  few.corners_px.resize(5);
  few.corner_idx = {0, 1, 9, 10, 20};
  ExpectUnused(few, "front_right: only 5 points of the target are seen; at least 6 are needed");
}

TEST(PartialViews, PointsThatAreNotTheTargetsAreSaid) {
  const BoardView whole = *Photographed(VirtualPair(), TiltedBoards(1), 0.1, 4).captures[0].b;
  for (const int wrong : {-1, 54, 3}) {
    BoardView view = whole;
    (wrong == 3 ? view.corner_idx[5] : wrong < 0 ? view.corner_idx.front() : view.corner_idx.back()) = wrong;
    ExpectUnused(view, "the points found are not those of target 'board'");
  }
  BoardView uneven = whole;
  uneven.corner_idx.pop_back();
  ExpectUnused(uneven, "the points found are not those of target 'board'");
  BoardView broken = whole;
  broken.corners_px[7].y() = std::numeric_limits<double>::infinity();
  ExpectUnused(broken, "a corner has no finite place in the picture");
}

TEST(PartialViews, OverlappingPartsAtOnePlaceRepeat) {
  StereoProblem problem = Photographed(VirtualPair(), TiltedBoards(10), 0.1, 4);
  problem.captures[6].a = Part(*problem.captures[2].a, problem.board, 2, 7);
  problem.captures[6].b = Part(*problem.captures[2].b, problem.board, 0, 5);
  const auto estimate = Estimate(problem);
  ASSERT_TRUE(estimate);
  EXPECT_THAT(estimate->residuals[6].note, HasSubstr("shows the same as 002"));
}

// As wide as 140 degrees: no series of radii starts near it, and its numerator and denominator are in the hundreds at
// the edge.
VirtualPair WidePair() {
  VirtualPair pair;
  pair.a = {
      288, 287, 322, 238, {7.263, 2.337, 0.0, 0.0001, 0.0379, 7.636, 4.597, 0.3275}, CameraModel::kPinholeRational};
  pair.b = {286, 286, 315, 244, {4.847, 1.624, 0.0, 0.0, 0.0342, 5.204, 3.114, 0.2477}, CameraModel::kPinholeRational};
  return pair;
}

// Turned to face the camera from all round the picture, up to 55 degrees off its axis, and leaning.
std::vector<Se3> BoardsAllRound(int count) {
  std::vector<Se3> boards;
  for (int k = 0; k < count; ++k) {
    const double around = 2.4 * k, off = 0.96 * std::sqrt((k % 6) / 5.0), range_m = 0.34 + 0.05 * std::sin(1.9 * k);
    const Eigen::Vector3d axis(std::cos(around), std::sin(around), 0);
    const Eigen::Vector3d centre = range_m * (std::sin(off) * axis + std::cos(off) * Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d lean(0.4 * std::cos(1.3 * k), 0.4 * std::sin(1.3 * k), 0.15 * std::sin(1.7 * k));
    boards.push_back(BoardAt(VirtualPair(), centre, 0.6 * off * Eigen::Vector3d::UnitZ().cross(axis) + lean));
  }
  return boards;
}

TEST(WideRationalPair, ViewsInPartAreEnough) {
  const VirtualPair pair = WidePair();
  StereoProblem problem = Photographed(pair, BoardsAllRound(18), 0.1, 4);
  for (std::size_t k = 0; k < problem.captures.size(); ++k) {
    problem.captures[k].a = Part(*problem.captures[k].a, problem.board, k % 2 == 0 ? 0 : 2, k % 2 == 0 ? 7 : 9);
    problem.captures[k].b = Part(*problem.captures[k].b, problem.board, k % 3 == 0 ? 0 : 1, 8);
  }
  const Edge edge = EstimateEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses.at(0).what;
  EXPECT_NEAR(edge.figures.at("rms_px"), 0.1 * std::sqrt(2.0), 0.02);
  const Vector6d error = (pair.T_a_b.Inverse() * edge.T_a_b).Log();
  const Vector6d sigma = edge.uncertainty.covariance.diagonal().cwiseSqrt();
  for (int axis = 0; axis < 6; ++axis) EXPECT_LT(std::abs(error[axis]), 5 * sigma[axis]) << axis;
}

TEST(WideRationalPair, RadtanIsRefusedByName) {
  StereoProblem problem = Photographed(WidePair(), BoardsAllRound(18), 0.1, 4);
  problem.camera_a.camera_model = problem.camera_b.camera_model = CameraModel::kPinholeRadtan;
  const Edge edge = EstimateEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kFailed);
  EXPECT_THAT(edge.diagnoses.at(0).cure, HasSubstr("'model: pinhole_rational'"));
  EXPECT_TRUE(edge.figures.contains("rms_as_pinhole_rational_a_px") ||
              edge.figures.contains("rms_as_pinhole_rational_b_px"));
}

// A rational lens in the middle of a picture: only sums of its coefficients can be known.
TEST(RationalPair, TooLittleOfThePictureIsADiagnosis) {
  VirtualPair pair;
  pair.a.model = pair.b.model = CameraModel::kPinholeRational;
  pair.a.distortion.resize(8);
  pair.b.distortion.resize(8);
  const Edge edge = EstimateEdge(Photographed(pair, TiltedBoards(8), 0.2, 3));
  ASSERT_EQ(edge.state, EdgeState::kFailed);
  EXPECT_THAT(edge.diagnoses.at(0).code,
              testing::AnyOf("distortion_not_observable", "ill_conditioned", "no_convergence"));
  EXPECT_FALSE(edge.diagnoses.at(0).cure.empty());
  for (const auto& [name, value] : edge.figures) EXPECT_LT(std::abs(value), 1e6) << name;
}

}  // namespace
}  // namespace rigcal::calib
