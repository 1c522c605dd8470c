// Captures in a row from one place whose pictures are wrong alike.
#include <cmath>

#include "tests/unit/calib/joint/visit.h"

namespace rigcal::calib::joint {
namespace {

constexpr int kOfBurst = 4;
constexpr double kShare = 0.8;  // of a corner's variance, as the virtual robot draws it

FeatureSession InBursts(std::uint64_t seed, double misfit_px = 0.0) {
  sim::Options options = WithSeed(seed);
  options.captures = 40;
  options.disturb.burst = kOfBurst;
  options.disturb.lens_misfit_px = misfit_px;
  return RecordFeatures(*sim::Prepare(*sim::LoadRig("mars-mapper"), options), 0);
}

TEST(JointBursts, WhatPicturesOfABurstShareIsFoundWithTheNoiseAsItIs) {
  const FeatureSession session = InBursts(1);
  const SessionStart start = StartFrom(session);
  const Refined refined = RefinedFrom(start);
  EXPECT_EQ(refined.groups.groups(), 40 / kOfBurst);
  for (std::size_t s = 0; s < start.problem.sensors.size(); ++s) {
    const sim::RigSensor& truth = session.experiment.rig.SensorOf(start.problem.sensors[s]);
    if (truth.kind != SensorKind::kCamera) continue;
    EXPECT_NEAR(refined.noise[s].burst_share, kShare, 0.05) << truth.id.str();
    EXPECT_NEAR(refined.noise[s].sigma, truth.camera.corner_sigma_px, 0.1 * truth.camera.corner_sigma_px);
  }
}

TEST(JointBursts, APictureOfABurstCountsByWhatItSaysAlone) {
  const SessionStart start = StartFrom(InBursts(2));
  const Refined refined = RefinedFrom(start);
  for (const auto& looks : RepeatsOfCorners(start.problem, refined.groups)) {
    const auto n = static_cast<double>(looks.size());
    const double share =
        refined.noise[static_cast<std::size_t>(start.problem.corners[looks.front()].sensor)].burst_share;
    for (const std::size_t i : looks) EXPECT_NEAR(refined.weights.in_burst[i], 1 / (1 + (n - 1) * share), 0.01);
  }
}

TEST(JointBursts, CapturesFromPlacesOfTheirOwnShareNothing) {
  const SessionStart start = StartFrom(Visit(WithSeed(3)));
  const Refined refined = RefinedFrom(start);
  EXPECT_TRUE(RepeatsOfCorners(start.problem, refined.groups).empty());
  for (const SensorNoise& noise : refined.noise) EXPECT_EQ(noise.burst_share, 0.0);
  for (const double weight : refined.weights.in_burst) EXPECT_EQ(weight, 1.0);
}

TEST(JointBursts, ErrorsThatABurstSharesAreNoBentLens) {
  for (const std::uint64_t seed : {1, 2, 3}) EXPECT_TRUE(EstimateFrom(InBursts(seed)).misfits.empty()) << seed;
}

TEST(JointBursts, ABentLensIsNamedAllTheSame) {
  const FeatureSession session = InBursts(4, 0.2);
  const SessionEstimate estimate = EstimateFrom(session);
  EXPECT_EQ(estimate.misfits.size(), 9u);
  EXPECT_TRUE(estimate.moved.empty());
  EXPECT_LT(WorstT2(session, estimate), 30.0);
}

// Every file twice, the second time as captures behind all others.
SessionViews PushedTwice(const FeatureSession& session) {
  SessionViews views = ViewsOf(session, NominalPoses(session));
  const auto again = [](const CaptureId& capture) { return CaptureId("9" + capture.str()); };
  for (CameraViews& camera : views.cameras) {
    const auto once = camera.views;
    for (const auto& [capture, view] : once) camera.views.emplace_back(again(capture), view);
    const auto poses = camera.estimate.T_cam_board;
    for (const auto& [capture, pose] : poses) camera.estimate.T_cam_board.emplace(again(capture), pose);
  }
  return views;
}

TEST(JointBursts, PicturesThatComeTwiceAreNoNewOnes) {
  const FeatureSession session = Visit(WithSeed(5));
  const SessionEstimate once = EstimateFrom(session), twice = EstimateSession(PushedTwice(session));
  ASSERT_TRUE(twice.why_not.empty());
  ASSERT_EQ(twice.poses.size(), once.poses.size());
  const Eigen::VectorXd ratio = twice.covariance.diagonal().cwiseQuotient(once.covariance.diagonal());
  for (std::size_t i = 0; i < once.poses.size(); ++i) {
    const int row = RowOf(once, i);
    if (row < 0 || once.poses[i].sensor.str().find("lidar") != std::string::npos) continue;
    EXPECT_GT(ratio.segment<6>(row).minCoeff(), 0.75) << once.poses[i].sensor.str();  // 0.5 if they counted as new
  }
}

}  // namespace
}  // namespace rigcal::calib::joint
