// Visits through lenses of the sphere models, which the simulation projects by mathematics of its own.
#include <gmock/gmock.h>

#include "server/calib/joint/refine/lens_numbers.h"
#include "tests/unit/calib/joint/visit.h"

namespace rigcal::calib::joint {
namespace {

using testing::Values;

// About as wide as the rig's own lenses bend little: 95 degrees, over pictures of 2448 x 2048.
CameraIntrinsics LensOf(CameraModel model, CameraIntrinsics lens, int number) {
  const double other = 0.01 * number;
  lens.model = model;
  if (model == CameraModel::kEucm)
    lens.fx_px = 1250 + number, lens.fy_px = 1249 + number, lens.distortion = {0.58 + other, 1.1 - other};
  else
    lens.fx_px = 1020 + number, lens.fy_px = 1019 + number, lens.distortion = {-0.2 + other, 0.56 + other};
  return lens;
}

FeatureSession VisitThrough(CameraModel model, sim::IntrinsicsKind intrinsics, std::uint64_t seed) {
  sim::Options options = WithSeed(seed);
  options.captures = 24;
  options.intrinsics = intrinsics;
  sim::Rig rig = *sim::LoadRig("mars-mapper");
  int number = 0;
  for (sim::RigSensor& sensor : rig.sensors) {
    if (sensor.kind != SensorKind::kCamera) continue;
    sensor.camera.intrinsics = LensOf(model, sensor.camera.intrinsics, number++);
    sensor.camera.intrinsics_sigma = {1.0, 1.0, 1.0, 1.0, 0.003, 0.005};
  }
  auto experiment = sim::Prepare(rig, options);
  EXPECT_TRUE(experiment);
  return RecordFeatures(*experiment, 0);
}

class SphereLenses : public testing::TestWithParam<std::tuple<CameraModel, sim::IntrinsicsKind>> {
 protected:
  FeatureSession session_ = VisitThrough(std::get<0>(GetParam()), std::get<1>(GetParam()), 5);
};
INSTANTIATE_TEST_SUITE_P(All, SphereLenses,
                         testing::Combine(Values(CameraModel::kEucm, CameraModel::kDoubleSphere),
                                          Values(sim::IntrinsicsKind::kExact, sim::IntrinsicsKind::kCalibrated,
                                                 sim::IntrinsicsKind::kAbsent)));

TEST_P(SphereLenses, PosesAreWithinTheirSigmasOfTheTruth) {
  const SessionEstimate estimate = EstimateFrom(session_);
  EXPECT_LT(WorstT2(session_, estimate), 40.0);  // of 6
  EXPECT_TRUE(estimate.moved.empty());
}

TEST_P(SphereLenses, LensesAreWithinThreeSigmasOfTheTruth) {
  if (std::get<1>(GetParam()) == sim::IntrinsicsKind::kExact) GTEST_SKIP() << "lenses are held";
  const SessionStart start = StartFrom(session_);
  const Refined refined = RefinedFrom(start);
  double squares = 0, count = 0;
  for (std::size_t c = 0; c < start.problem.cameras.size(); ++c) {
    const auto& refines = start.problem.cameras[c].refined;
    const IntrinsicsVector truth =
        VectorOf(session_.experiment.rig.SensorOf(start.problem.sensors[c]).camera.intrinsics);
    for (std::size_t i = 0; i < refines.size(); ++i) {
      const Eigen::Index at = refined.layout.lens[c] + static_cast<Eigen::Index>(i);
      const double off = refined.state.intrinsics[c][refines[i]] - truth[refines[i]];
      const double sigmas = off / std::sqrt(refined.covariance(at, at));
      EXPECT_LT(std::abs(sigmas), 4.0) << start.problem.sensors[c].str() << " " << refines[i];
      squares += sigmas * sigmas, ++count;
    }
  }
  EXPECT_GT(count, 50);
  EXPECT_LT(squares / count, 2.0);
}

// Beyond 1 it projects what no lens sees, however well it fits.
TEST(SphereLens, ARefinedNumberThatNoLensHasIsRefused) {
  SessionStart start = StartFrom(VisitThrough(CameraModel::kEucm, sim::IntrinsicsKind::kAbsent, 5));
  EXPECT_FALSE(WhyNoLens(start.problem, start.state));
  start.state.intrinsics[1][4] = 1.02;
  const auto why = WhyNoLens(start.problem, start.state);
  ASSERT_TRUE(why);
  EXPECT_EQ(why->code, "absurd_distortion");
  EXPECT_EQ(why->what, "The estimated eucm distortion of " + start.problem.sensors[1].str() +
                           " is that of no lens: alpha 1.02 is not within 0 to 1.");
  start.state.intrinsics[1][4] = -0.001;
  EXPECT_EQ(WhyNoLens(start.problem, start.state)->cure, "Set its model to pinhole_radtan.");
  start.problem.cameras[1].sigma.setOnes();
  EXPECT_EQ(WhyNoLens(start.problem, start.state)->cure, "Set its model to pinhole_radtan.")
      << "the number is the refinement's, not what was given";
  for (Lens& camera : start.problem.cameras) camera.refined.clear();
  EXPECT_FALSE(WhyNoLens(start.problem, start.state)) << "given ones are looked at before";
}

}  // namespace
}  // namespace rigcal::calib::joint
