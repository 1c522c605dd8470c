// Thirteen real stereo pairs, 640 x 480, 9 x 6 inner corners of 25 mm. Reference figures: data/README.md.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "server/calib/stereo/stereo.h"
#include "server/detect/board.h"
#include "tests/unit/recordings.h"

namespace rigcal::calib {
namespace {

BoardView ViewIn(const std::filesystem::path& path, const Target& board) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  return detect::Detect(std::as_bytes(std::span(bytes)), board).view;
}

StereoProblem AllPairs() {
  StereoProblem problem;
  problem.camera_a.id = SensorId("left");
  problem.camera_b.id = SensorId("right");
  problem.board = {TargetId("board"), 9, 6, 0.025, 0.0, ""};
  const auto pictures = StereoPairs();
  for (const std::string name : {"01", "02", "03", "04", "05", "06", "07", "08", "09", "11", "12", "13", "14"})
    problem.captures.push_back({CaptureId(name), ViewIn(pictures.at("left/" + name), problem.board),
                                ViewIn(pictures.at("right/" + name), problem.board)});
  return problem;
}

class RealPairs : public testing::Test {
 protected:
  void SetUp() override {
    RIGCAL_SKIP_WITHOUT_STEREO_PAIRS();
    static const StereoProblem problem = AllPairs();
    problem_ = problem;
  }
  StereoProblem problem_;
};

TEST_F(RealPairs, MatchTheReference) {
  const Edge edge = EstimateEdge(problem_);
  ASSERT_EQ(edge.state, EdgeState::kGood);
  EXPECT_LE(edge.figures.at("rms_px"), 0.23);
  EXPECT_NEAR(1e3 * edge.T_a_b.p_m.norm(), 83.18, 0.3);
  // What this program found on them before.
  EXPECT_NEAR(edge.figures.at("rms_px"), 0.190198, 1e-5);
  EXPECT_NEAR(1e3 * edge.T_a_b.p_m.norm(), 83.162880, 1e-5);
  // The reference maps left points into the right camera: its T is T_b_a.
  const Se3 T_b_a = edge.T_a_b.Inverse();
  EXPECT_NEAR(1e3 * T_b_a.p_m.x(), -83.18, 0.3);
  EXPECT_NEAR(1e3 * T_b_a.p_m.y(), 0.92, 0.3);
  EXPECT_NEAR(T_b_a.Log()[tangent::kRx], 0.00712, 0.002);
  EXPECT_NEAR(T_b_a.Log()[tangent::kRy], 0.00420, 0.002);
  EXPECT_NEAR(T_b_a.Log()[tangent::kRz], -0.00352, 0.0005);
  EXPECT_EQ(edge.uncertainty.source, UncertaintySource::kJackknife);
  EXPECT_EQ(edge.uncertainty.blocks.size(), 13U);
}

TEST_F(RealPairs, NinePairsAgreeWithAll) {
  StereoProblem nine = problem_;
  nine.captures.resize(9);
  const Edge edge = EstimateEdge(nine), all = EstimateEdge(problem_);
  ASSERT_EQ(edge.state, EdgeState::kGood);
  EXPECT_LE(edge.figures.at("rms_px"), 0.23);
  const Vector6d difference = (all.T_a_b.Inverse() * edge.T_a_b).Log();
  const Vector6d sigma = edge.uncertainty.covariance.diagonal().cwiseSqrt();
  for (int axis = 0; axis < 6; ++axis) EXPECT_LE(std::abs(difference[axis]), 3 * sigma[axis]) << axis;
}

// Two halves share nothing: their difference is what both sigmas together must cover. Bound: 3 on each of 6 axes.
TEST_F(RealPairs, OddAndEvenCapturesAgreeWithinTheirOwnSigma) {
  StereoProblem odd = problem_, even = problem_;
  const auto is_odd = [](const StereoCapture& capture) { return (capture.capture.str().back() - '0') % 2 == 1; };
  std::erase_if(odd.captures, [&](const StereoCapture& capture) { return !is_odd(capture); });
  std::erase_if(even.captures, is_odd);
  const Edge first = EstimateEdge(odd), second = EstimateEdge(even);
  ASSERT_EQ(first.state, EdgeState::kGood);
  ASSERT_EQ(second.state, EdgeState::kGood);
  const Vector6d difference = (first.T_a_b.Inverse() * second.T_a_b).Log();
  const Vector6d variance = (first.uncertainty.covariance + second.uncertainty.covariance).diagonal();
  for (int axis = 0; axis < 6; ++axis) EXPECT_LE(std::abs(difference[axis]), 3 * std::sqrt(variance[axis])) << axis;
}

// The other camera first: the inverse pose.
TEST_F(RealPairs, ExchangedCamerasGiveTheInverse) {
  StereoProblem exchanged = problem_;
  std::swap(exchanged.camera_a, exchanged.camera_b);
  for (StereoCapture& capture : exchanged.captures) std::swap(capture.a, capture.b);
  const auto forward = Estimate(problem_), backward = Estimate(exchanged);
  ASSERT_TRUE(forward && backward);
  EXPECT_LT((forward->T_a_b * backward->T_a_b).Log().norm(), 1e-8);
}

}  // namespace
}  // namespace rigcal::calib
