// From rendered pictures of circles to the pose of two cameras: within what is told of it.
#include "tests/unit/detect/circles.h"

#include <gmock/gmock.h>

#include "server/calib/camera/camera_fit.h"
#include "server/calib/camera/intrinsics.h"
#include "server/calib/stereo/stereo.h"

namespace rigcal::calib {
namespace {

using detect::Circles;
using detect::Scene;

const Se3 kTruth =
    Se3{{0.13, -0.01, 0.02}, Eigen::Quaterniond(Eigen::AngleAxisd(0.15, Eigen::Vector3d(0.1, -1, 0.1).normalized()))};

Se3 PoseOf(const Scene& scene) { return Se3{scene.t_m, Eigen::Quaterniond(scene.R)}.Normalized(); }

Scene FromOther(Scene scene, std::uint64_t seed) {
  const Se3 T_b_board = kTruth.Inverse() * PoseOf(scene);
  scene.R = T_b_board.R(), scene.t_m = T_b_board.p_m, scene.seed = seed;
  return scene;
}

// Large circles near the cameras, whose centres are off by 0.1 to 0.3 px in the pictures.
Scene SceneOf(const Circles& board, int k) {
  const double tilt_rad = 0.25 + 0.35 * (k % 3) / 2, about = 2.4 * k;
  Scene scene = detect::Looking(board.Middle_m(), 0.5 + 0.06 * (k % 4), 0.4 * k, tilt_rad * std::cos(about),
                                tilt_rad * std::sin(about), 0.05 + 0.02 * (k % 3 - 1), 0.02 * (k % 2));
  scene.seed = static_cast<std::uint64_t>(100 + k);
  return scene;
}

Sensor Camera(const char* name) {
  Sensor camera;
  camera.id = SensorId(name);
  return camera;
}

StereoProblem Photographed(const Circles& board, int captures) {
  StereoProblem problem{Camera("a"), Camera("b"), detect::TargetOf(board), {}};
  const detect::Pattern pattern = detect::Drawn(board);
  for (int k = 0; k < captures; ++k) {
    const Scene a = SceneOf(board, k), b = FromOther(a, static_cast<std::uint64_t>(200 + k));
    StereoCapture capture{CaptureId(std::to_string(10 + k)), {}, {}};
    capture.a = detect::DetectIn(detect::Photographed(a, pattern), problem.board).view;
    capture.b = detect::DetectIn(detect::Photographed(b, pattern), problem.board).view;
    EXPECT_TRUE(capture.a->found && capture.b->found) << k << capture.a->why_not << capture.b->why_not;
    problem.captures.push_back(capture);
  }
  return problem;
}

// That of Scene.
CameraIntrinsics Lens() {
  CameraIntrinsics lens;
  lens.fx_px = lens.fy_px = 600;
  lens.cx_px = 0.5 * 640 - 3.3, lens.cy_px = 0.5 * 480 + 2.7;
  lens.distortion.assign(5, 0.0);
  return lens;
}

void ExpectWithinThreeSigmas(const Edge& edge) {
  ASSERT_EQ(edge.state, EdgeState::kGood) << (edge.diagnoses.empty() ? "" : edge.diagnoses.front().what);
  const Vector6d off = (kTruth.Inverse() * edge.T_a_b).Log();
  for (int axis = 0; axis < 6; ++axis) {
    const double sigma = std::sqrt(edge.uncertainty.covariance(axis, axis));
    EXPECT_LT(std::abs(off[axis]), 3 * sigma) << axis;
    EXPECT_LT(sigma, axis < 3 ? 1e-3 : 2e-3) << axis;
  }
}

class CirclePair : public testing::TestWithParam<Circles> {};
INSTANTIATE_TEST_SUITE_P(Kinds, CirclePair, testing::Values(Circles{6, 5, 0.04, 0.03}, Circles{4, 7, 0.03, 0.03, true}),
                         [](const auto& one) { return one.param.asymmetric ? "asymmetric" : "grid"; });

TEST_P(CirclePair, IsWhatItSaysWithGivenLenses) {
  StereoProblem problem = Photographed(GetParam(), 12);
  problem.camera_a.intrinsics = problem.camera_b.intrinsics = Lens();
  ExpectWithinThreeSigmas(EstimateEdge(problem));
}

TEST_P(CirclePair, IsWhatItSaysWithLensesEstimatedFromTheCircles) {
  const StereoProblem problem = Photographed(GetParam(), 14);
  std::vector<CameraFit> fits;
  ExpectWithinThreeSigmas(EstimateEdge(problem, &fits));
  ASSERT_EQ(fits.size(), 2u);
  for (const CameraFit& fit : fits) {
    EXPECT_LT(std::abs(fit.intrinsics.fx_px - 600), 3 * fit.sigma.at(0)) << fit.sigma.at(0);
    EXPECT_LT(std::abs(fit.intrinsics.cx_px - Lens().cx_px), 3 * fit.sigma.at(2)) << fit.sigma.at(2);
    EXPECT_LT(fit.sigma.at(0), 3.0);
  }
}

}  // namespace
}  // namespace rigcal::calib
