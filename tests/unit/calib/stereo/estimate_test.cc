#include <gmock/gmock.h>

#include <cstring>

#include "tests/unit/calib/virtual_pair.h"

namespace rigcal::calib {
namespace {

double Difference(const Se3& T, const Se3& S) { return (T.Matrix() - S.Matrix()).cwiseAbs().maxCoeff(); }

TEST(Estimate, ExactDataGiveTheExactAnswer) {
  const VirtualPair pair;
  const std::vector<Se3> boards = TiltedBoards(12);
  const auto estimate = Estimate(Photographed(pair, boards, 0, 0));
  ASSERT_TRUE(estimate) << estimate.error().what;
  EXPECT_LT(Difference(estimate->T_a_b, pair.T_a_b), 1e-8);
  EXPECT_LT(Difference(estimate->T_a_board.at(CaptureId("003")), boards[3]), 1e-8);
  EXPECT_NEAR(estimate->intrinsics_a.fx_px, pair.a.fx_px, 1e-5);
  EXPECT_NEAR(estimate->intrinsics_b.cy_px, pair.b.cy_px, 1e-5);
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_NEAR(estimate->intrinsics_a.distortion[i], pair.a.distortion[i], 1e-6) << i;
  EXPECT_LT(estimate->rms_px, 1e-7);
}

TEST(Estimate, RmsIsTheDistancePerPoint) {
  const VirtualPair pair;
  const auto estimate = Estimate(Photographed(pair, TiltedBoards(12), 0.2, 5));
  ASSERT_TRUE(estimate);
  // 0.2 px on u and on v is 0.283 px of distance; the fit takes 5 % of it.
  EXPECT_NEAR(estimate->rms_px, 0.2 * std::sqrt(2.0) * std::sqrt(1 - 96.0 / 2592), 0.02);
  const double both = (std::pow(estimate->rms_a_px, 2) + std::pow(estimate->rms_b_px, 2)) / 2;
  EXPECT_NEAR(estimate->rms_px, std::sqrt(both), 1e-12);
}

TEST(Estimate, GivenIntrinsicsStayAsGiven) {
  const VirtualPair pair;
  StereoProblem problem = Photographed(pair, TiltedBoards(6), 0, 0);
  problem.camera_a.intrinsics = pair.a;
  problem.camera_b.intrinsics = pair.b;
  const auto estimate = Estimate(problem);
  ASSERT_TRUE(estimate);
  EXPECT_EQ(estimate->intrinsics_a.fx_px, pair.a.fx_px);
  EXPECT_EQ(estimate->intrinsics_b.distortion, pair.b.distortion);
  EXPECT_LT(Difference(estimate->T_a_b, pair.T_a_b), 1e-8);
}

TEST(Estimate, SingleViewsInformTheIntrinsicsOfTheirCamera) {
  const VirtualPair pair;
  const StereoProblem all = Photographed(pair, TiltedBoards(16), 0.2, 3);
  StereoProblem partly = all;
  for (std::size_t k = 10; k < 16; ++k) (k % 2 == 0 ? partly.captures[k].a : partly.captures[k].b) = NotFoundView();
  StereoProblem only_both = all;
  only_both.captures.resize(10);
  const auto with = Estimate(partly), without = Estimate(only_both);
  ASSERT_TRUE(with && without);
  EXPECT_EQ(with->T_a_board.size(), 16U);
  EXPECT_LT(with->C_model(tangent::kZ, tangent::kZ), without->C_model(tangent::kZ, tangent::kZ));
  EXPECT_THAT(with->residuals[12].note, testing::HasSubstr("one camera only"));
  EXPECT_TRUE(with->residuals[12].used);
}

TEST(Estimate, SingleViewsOfAGivenCameraAreNotUsed) {
  const VirtualPair pair;
  StereoProblem problem = Photographed(pair, TiltedBoards(10), 0.2, 3);
  problem.camera_a.intrinsics = pair.a;
  problem.captures[4].b = NotFoundView();
  const auto estimate = Estimate(problem);
  ASSERT_TRUE(estimate);
  EXPECT_FALSE(estimate->residuals[4].used);
  EXPECT_THAT(estimate->residuals[4].note, testing::HasSubstr("front_right: no 9 x 6 board"));
}

TEST(Estimate, AWarmStartReachesTheSameMinimum) {
  const StereoProblem problem = Photographed(VirtualPair(), TiltedBoards(12), 0.2, 9);
  const auto cold = Estimate(problem);
  ASSERT_TRUE(cold);
  StereoEstimate shaken = *cold;
  shaken.T_a_b = shaken.T_a_b * Se3::Exp(0.01 * Vector6d::Ones());
  const auto warm = Estimate(problem, &shaken);
  ASSERT_TRUE(warm);
  EXPECT_LT(Difference(cold->T_a_b, warm->T_a_b), 1e-9);
}

TEST(Estimate, TheSameInputGivesTheSameBits) {
  const StereoProblem problem = Photographed(VirtualPair(), TiltedBoards(12), 0.2, 9);
  const Edge first = EstimateEdge(problem), second = EstimateEdge(problem);
  EXPECT_EQ(std::memcmp(&first.T_a_b.p_m, &second.T_a_b.p_m, sizeof first.T_a_b.p_m), 0);
  EXPECT_EQ(first.uncertainty.Omega, second.uncertainty.Omega);
  ASSERT_EQ(first.uncertainty.blocks.size(), 12U);
  for (std::size_t k = 0; k < 12; ++k) EXPECT_EQ(first.uncertainty.blocks[k].d, second.uncertainty.blocks[k].d);
}

TEST(Jackknife, BlocksAreTheAnswersWithoutOneCapture) {
  const StereoProblem problem = Photographed(VirtualPair(), TiltedBoards(9), 0.2, 4);
  const auto estimate = Estimate(problem);
  ASSERT_TRUE(estimate);
  const auto uncertainty = Jackknife(problem, *estimate);
  ASSERT_TRUE(uncertainty);
  ASSERT_EQ(uncertainty->blocks.size(), 9U);
  EXPECT_EQ(uncertainty->source, UncertaintySource::kJackknife);
  EXPECT_EQ(uncertainty->dof, 8);
  EXPECT_EQ(uncertainty->blocks[5].block_id, "005");
  StereoProblem without = problem;
  without.captures.erase(without.captures.begin() + 5);
  const auto other = Estimate(without);  // cold: nothing in common with the warm start under test
  ASSERT_TRUE(other);
  EXPECT_LT((uncertainty->blocks[5].d - (estimate->T_a_b.Inverse() * other->T_a_b).Log()).norm(), 1e-8);
}

TEST(Jackknife, FewCapturesAreMarkedModel) {
  const StereoProblem problem = Photographed(VirtualPair(), TiltedBoards(4), 0.2, 4);
  const auto estimate = Estimate(problem);
  ASSERT_TRUE(estimate);
  const auto uncertainty = Jackknife(problem, *estimate);
  ASSERT_TRUE(uncertainty);
  EXPECT_EQ(uncertainty->source, UncertaintySource::kModel);
  EXPECT_TRUE(uncertainty->blocks.empty());
  EXPECT_LT((uncertainty->covariance - estimate->C_model).norm(), 1e-9 * estimate->C_model.norm());
}

TEST(Jackknife, TheBoardsSizeCarriesOverToTheBaseline) {
  const VirtualPair pair;
  StereoProblem problem = Photographed(pair, TiltedBoards(9), 0.2, 4);
  problem.board.square_sigma_m = 0.01 * problem.board.square_m;
  const auto estimate = Estimate(problem);
  ASSERT_TRUE(estimate);
  const auto uncertainty = Jackknife(problem, *estimate);
  ASSERT_TRUE(uncertainty);
  ASSERT_EQ(uncertainty->contributions.size(), 1U);
  const Matrix6d& part = uncertainty->contributions[0].covariance;
  // Closed form: everything scales, so t grows by 1 %, in the axes of b, and nothing turns.
  const Eigen::Vector3d growth = 0.01 * (estimate->T_a_b.R().transpose() * estimate->T_a_b.p_m);
  const Eigen::Matrix3d shift = part.topLeftCorner<3, 3>(), turn = part.bottomRightCorner<3, 3>();
  EXPECT_LT((shift - growth * growth.transpose()).norm(), 1e-6 * growth.squaredNorm());
  EXPECT_LT(turn.norm(), 1e-12);
}

TEST(Jackknife, GivenIntrinsicsBringTheirUncertainty) {
  const VirtualPair pair;
  StereoProblem problem = Photographed(pair, TiltedBoards(9), 0.2, 4);
  problem.camera_a.intrinsics = pair.a;
  problem.camera_b.intrinsics = pair.b;
  // cx of b alone, by far better than these views tell it.
  problem.camera_b.intrinsics_sigma = {0, 0, 0.01, 0, 0, 0, 0, 0, 0};
  const auto estimate = Estimate(problem);
  ASSERT_TRUE(estimate);
  const auto uncertainty = Jackknife(problem, *estimate);
  ASSERT_TRUE(uncertainty);
  ASSERT_EQ(uncertainty->contributions.size(), 1U);
  EXPECT_THAT(uncertainty->contributions[0].name, testing::HasSubstr("front_right"));
  StereoProblem moved = problem;
  moved.camera_b.intrinsics->cx_px += 0.01;
  const auto other = Estimate(moved);
  ASSERT_TRUE(other);
  const Vector6d shift = (estimate->T_a_b.Inverse() * other->T_a_b).Log();
  const Vector6d sigma = uncertainty->contributions[0].covariance.diagonal().cwiseSqrt();
  // A principal point that is wrong sideways turns the camera about y: by 0.01 px of 590.
  EXPECT_NEAR(sigma[tangent::kRy], 0.01 / pair.b.fx_px, 0.3 * 0.01 / pair.b.fx_px);
  EXPECT_LT((shift.cwiseAbs() - sigma).cwiseAbs().maxCoeff(), 0.02 * shift.norm());
}

TEST(EstimateEdge, SaysWhatAReaderNeeds) {
  const Edge edge = EstimateEdge(Photographed(VirtualPair(), TiltedBoards(12), 0.2, 1));
  ASSERT_EQ(edge.state, EdgeState::kGood);
  EXPECT_TRUE(edge.diagnoses.empty());
  EXPECT_EQ(edge.method, "stereo");
  EXPECT_EQ(edge.frame_a.str(), "front_left");
  EXPECT_EQ(edge.frame_b.str(), "front_right");
  EXPECT_EQ(edge.figures.at("captures_used"), 12);
  EXPECT_EQ(edge.figures.at("captures_total"), 12);
  EXPECT_NEAR(edge.figures.at("rms_px"), 0.28, 0.03);
  EXPECT_NEAR(edge.figures.at("fx_a_px"), 610, 10);
  EXPECT_GT(edge.figures.at("model_sigma_ratio"), 0.4);
  EXPECT_LT(edge.figures.at("model_sigma_ratio"), 3);
  EXPECT_EQ(edge.captures.size(), 12U);
  EXPECT_TRUE(Validate(edge.uncertainty));
}

}  // namespace
}  // namespace rigcal::calib
