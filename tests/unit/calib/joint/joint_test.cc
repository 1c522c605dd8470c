// The joint refinement against a virtual robot that shares none of its mathematics: corners are projected by OpenCV.
#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "server/calib/joint/refine/cluster_covariance.h"
#include "tests/unit/calib/joint/visit.h"

namespace rigcal::calib::joint {
namespace {

struct Fixed {
  SessionStart start;
  Layout layout;
  LookWeights weights;
  CaptureGroups groups;
  [[nodiscard]] Linearization Of() const { return {start.problem, layout, start.noise, weights, groups}; }
};
Fixed FixedFrom(SessionStart start) {
  // Large sigmas: no residual of the start is beyond Huber's knee, where the cost has a kink in its second derivative.
  for (SensorNoise& noise : start.noise) noise = {noise.sigma_rad > 0 ? 0.05 : 5.0, noise.sigma_rad > 0 ? 0.05 : 0.0};
  Fixed fixed{std::move(start), {}, {}, {}};
  fixed.layout = LayoutOf(fixed.start.problem);
  fixed.weights = FullWeights(fixed.start.problem);
  fixed.groups = GroupsOf(fixed.start.problem, fixed.start.state);
  return fixed;
}

// Away from the minimum the gradient of the reduced problem is that of the cost with the places at their best, so
// places are moved to where their own gradient vanishes first.
SessionState PlacesSettled(const Fixed& fixed, SessionState state) {
  for (int i = 0; i < 20; ++i) {
    const auto now = Linearize(fixed.Of(), state);
    std::vector<Vector6d> steps;
    for (const PlaceEquations& place : now->places) steps.emplace_back(-place.inverse * place.b);
    state = Moved(fixed.start.problem, fixed.layout, state, Eigen::VectorXd::Zero(fixed.layout.size), steps);
  }
  return state;
}

TEST(CalibJoint, GradientIsThatOfTheCostAwayFromItsMinimum) {
  const FeatureSession session = Visit(WithSeed(3));
  const Fixed fixed = FixedFrom(StartFrom(session));
  const SessionState state = PlacesSettled(fixed, fixed.start.state);
  const auto at = Linearize(fixed.Of(), state);
  ASSERT_TRUE(at);
  const Eigen::VectorXd gradient = 2 * at->total.b.head(fixed.layout.size);
  const Eigen::MatrixXd H = at->total.H;
  ASSERT_GT(gradient.cwiseAbs().maxCoeff(), 1.0);  // nominal poses are off
  const std::vector<Vector6d> still(state.T_world_ref.size(), Vector6d::Zero());
  for (int i = 0; i < fixed.layout.size; ++i) {
    const double h = 1e-3 / std::sqrt(H(i, i));
    const auto cost = [&](double step) {
      const SessionState moved =
          Moved(fixed.start.problem, fixed.layout, state, step * Eigen::VectorXd::Unit(fixed.layout.size, i), still);
      return Linearize(fixed.Of(), moved)->cost;
    };
    EXPECT_NEAR((cost(h) - cost(-h)) / (2 * h), gradient[i], 2e-4 * std::abs(gradient[i]) + 1e-3 * std::sqrt(H(i, i)))
        << "unknown " << i;
  }
}

class GivenLenses : public testing::TestWithParam<sim::IntrinsicsKind> {};

TEST_P(GivenLenses, RefinedPosesAreWithinTheirSigmasOfTheTruth) {
  sim::Options options = WithSeed(5);
  options.intrinsics = GetParam();
  const FeatureSession session = Visit(options);
  const SessionStart start = StartFrom(session);
  EXPECT_TRUE(start.unused.empty());
  const Refined refined = RefinedFrom(start);
  const PoseCovariance covariance = CovarianceOfPoses(refined);
  for (std::size_t s = 0; s < start.problem.sensors.size(); ++s) {
    const int row = covariance.row_of_sensor[s];
    if (row == kNone) continue;
    const Vector6d error =
        (refined.state.T_ref_sensor[s].Inverse() * session.experiment.T_ref_sensor(start.problem.sensors[s])).Log();
    const Matrix6d C = covariance.joint.block<6, 6>(row, row);
    EXPECT_LT(error.dot(C.ldlt().solve(error)), 60.0) << start.problem.sensors[s].str();  // of 6: one in 1e10
    EXPECT_LT(error.head<3>().norm(), 0.005);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, GivenLenses,
                         testing::Values(sim::IntrinsicsKind::kExact, sim::IntrinsicsKind::kCalibrated,
                                         sim::IntrinsicsKind::kAbsent));

TEST(CalibJoint, CovarianceIsNeverBelowTheModels) {
  const PoseCovariance covariance = CovarianceOfPoses(RefinedFrom(StartFrom(Visit(WithSeed(6)))));
  const Eigen::VectorXd scale = covariance.model.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(scale.asDiagonal() * (covariance.joint - covariance.model) *
                                                            scale.asDiagonal());
  EXPECT_GT(axes.eigenvalues()[0], -1e-9);
}

// (I - C H_g)^-1/2 C b_g by its series: sum of binom(2k, k) / 4^k (C H_g)^k C b_g.
Eigen::VectorXd InfluenceBySeries(const Refined& refined, const NormalEquations& group) {
  const int size = refined.layout.size;
  Eigen::VectorXd power = refined.covariance * group.b.head(size), sum = power;
  double coefficient = 1.0;
  for (int k = 1; k < 2000; ++k) {
    power = refined.covariance * (group.H.topLeftCorner(size, size) * power);
    coefficient *= (2.0 * k - 1) / (2.0 * k);
    sum += coefficient * power;
  }
  return sum;
}

TEST(CalibJoint, GroupsMovePosesByTheirScoresWithoutTheirLeverage) {
  const Refined refined = RefinedFrom(StartFrom(Visit(WithSeed(6))));
  const PoseCovariance covariance = CovarianceOfPoses(refined);
  const Eigen::VectorXd sigma = covariance.model.diagonal().cwiseSqrt();
  for (std::size_t g = 0; g < refined.at_optimum.groups.size(); ++g) {
    const Eigen::VectorXd expected = InfluenceBySeries(refined, refined.at_optimum.groups[g]);
    for (std::size_t s = 0; s < covariance.row_of_sensor.size(); ++s) {
      const int row = covariance.row_of_sensor[s];
      if (row == kNone) continue;
      const Vector6d off = covariance.influence.block<6, 1>(row, static_cast<Eigen::Index>(g)) -
                           expected.segment<6>(refined.layout.pose[s]);
      EXPECT_LT(off.cwiseQuotient(sigma.segment<6>(row)).cwiseAbs().maxCoeff(), 1e-7) << g << " " << s;
    }
  }
}

TEST(CalibJoint, NoiseOfEachSensorIsFoundFromItsResiduals) {
  const FeatureSession session = Visit(WithSeed(7));
  const SessionStart start = StartFrom(session);
  const Refined refined = RefinedFrom(start);
  for (std::size_t s = 0; s < start.problem.sensors.size(); ++s) {
    const sim::RigSensor& truth = session.experiment.rig.SensorOf(start.problem.sensors[s]);
    if (truth.kind == SensorKind::kCamera) {
      EXPECT_NEAR(refined.noise[s].sigma, truth.camera.corner_sigma_px, 0.1 * truth.camera.corner_sigma_px);
    }
    if (truth.kind == SensorKind::kTracker) {
      EXPECT_NEAR(refined.noise[s].sigma_rad, truth.tracker.sigma_rad, 0.6 * truth.tracker.sigma_rad);
    }
  }
}

TEST(CalibJoint, OnePictureOfAnotherInstantCostsLittleAndIsHeldBack) {
  FeatureSession session = Visit(WithSeed(9));
  auto& views = session.seen.views.at(SensorId("front_right"));
  const auto bad = std::next(views.begin(), 4);
  for (Eigen::Vector2d& corner : bad->second.corners_px) corner.x() += 8.0;
  const SessionStart start = StartFrom(session);
  const Refined refined = RefinedFrom(start);
  for (std::size_t i = 0; i < start.problem.corners.size(); ++i) {
    const CornersSeen& seen = start.problem.corners[i];
    const bool is_bad = start.problem.sensors[static_cast<std::size_t>(seen.sensor)] == SensorId("front_right") &&
                        start.problem.captures[static_cast<std::size_t>(
                            start.problem.capture_of_place[static_cast<std::size_t>(seen.place)])] == bad->first;
    if (is_bad) {
      EXPECT_LT(refined.weights.corners[i], 0.01);
    } else {
      EXPECT_GT(refined.weights.corners[i], 0.99) << i;
    }
  }
  const Refined clean = RefinedFrom(StartFrom(Visit(WithSeed(9))));
  for (std::size_t s = 0; s < start.problem.sensors.size(); ++s) {
    const Vector6d apart = (clean.state.T_ref_sensor[s].Inverse() * refined.state.T_ref_sensor[s]).Log();
    EXPECT_LT(apart.head<3>().norm(), 5e-4) << start.problem.sensors[s].str();
  }
}

TEST(CalibJoint, CapturesWithoutLeadingZerosAreInTheOrderInWhichTheyWereTaken) {
  FeatureSession session = Visit(WithSeed(3));
  const auto plain = [](const CaptureId& capture) { return CaptureId(std::to_string(std::stoi(capture.str()))); };
  SessionViews views = ViewsOf(session, NominalPoses(session));
  for (CameraViews& camera : views.cameras) {
    for (auto& [capture, view] : camera.views) capture = plain(capture);
    std::map<CaptureId, Se3> poses;
    for (const auto& [capture, pose] : camera.estimate.T_cam_board) poses.emplace(plain(capture), pose);
    camera.estimate.T_cam_board.clear();
    for (const auto& [capture, pose] : poses) camera.estimate.T_cam_board.emplace(capture, pose);
  }
  for (TrackerPoses& tracker : views.trackers)
    for (TimedPose& row : tracker.poses) row.capture = plain(row.capture);
  views.lidars.clear();
  const auto start = StartOf(views);
  ASSERT_TRUE(start) << Sentence(start.error());
  ASSERT_GT(start->problem.captures.size(), 10u);
  for (std::size_t i = 1; i < start->problem.captures.size(); ++i)
    EXPECT_LT(std::stoi(start->problem.captures[i - 1].str()), std::stoi(start->problem.captures[i].str()));
}

TEST(CalibJoint, SensorThatSawNothingDoesNotRefuseTheSession) {
  const FeatureSession session = Visit(WithSeed(4));
  SessionViews views = ViewsOf(session, NominalPoses(session));
  for (LidarViews& lidar : views.lidars)
    if (lidar.lidar.id == SensorId("lidar_vertical")) lidar.clouds.clear();
  const SessionEstimate estimate = EstimateSession(views);
  ASSERT_TRUE(estimate.why_not.empty()) << estimate.why_not.front().what;
  std::set<SensorId> refined;
  for (const RefinedPose& pose : estimate.poses) refined.insert(pose.sensor);
  EXPECT_FALSE(refined.contains(SensorId("lidar_vertical")));
  EXPECT_TRUE(refined.contains(SensorId("lidar_horizontal")));
  EXPECT_EQ(refined.size() + 1, views.T_ref_sensor.size());
}

// Waves across the picture, of another length along u than along v.
Eigen::Vector2d BentBy(double amplitude_px, const Eigen::Vector2d& uv_px) {
  const Eigen::Vector2d turn = 2 * M_PI * uv_px / 2448;
  return amplitude_px * Eigen::Vector2d(std::sin(2.2 * turn.x() + 0.9 * turn.y()), std::cos(1.8 * turn.y() - turn.x()));
}

void Bend(const char* camera, double amplitude_px, FeatureSession& session) {
  for (auto& [capture, view] : session.seen.views.at(SensorId(camera)))
    for (Eigen::Vector2d& corner : view.corners_px) corner += BentBy(amplitude_px, corner);
}

double WorstT2WithoutFields(const FeatureSession& session) {
  const SessionStart start = StartFrom(session);
  const Refined refined = RefinedFrom(start);
  const PoseCovariance covariance = CovarianceOfPoses(refined);
  double worst = 0;
  for (std::size_t s = 0; s < start.problem.sensors.size(); ++s)
    if (const int row = covariance.row_of_sensor[s]; row != kNone)
      worst = std::max(worst, T2(session, start.problem.sensors[s], refined.state.T_ref_sensor[s],
                                 covariance.joint.block<6, 6>(row, row)));
  return worst;
}

TEST(CalibJoint, ALensThatBendsBeyondItsModelIsNamedAloneAndCovered) {
  FeatureSession session = Visit(WithSeed(14));
  Bend("right_back", 0.2, session);
  const SessionEstimate estimate = EstimateFrom(session);
  ASSERT_EQ(estimate.misfits.size(), 1u);
  EXPECT_EQ(estimate.misfits[0].camera.str(), "right_back");
  EXPECT_GT(estimate.misfits[0].rms_px, 0.05);
  EXPECT_LT(estimate.misfits[0].rms_px, 0.2);
  EXPECT_GT(estimate.misfits[0].sigma_ratio, 1.5);
  EXPECT_EQ(estimate.misfits[0].trial.candidates.size(), 3u);
  EXPECT_TRUE(estimate.misfits[0].trial.own_left_out_rms_px.has_value());
  EXPECT_TRUE(estimate.moved.empty());
  EXPECT_LT(WorstT2(session, estimate), 25.0);     // of one sensor by chance: one in 3,000
  EXPECT_GT(WorstT2WithoutFields(session), 25.0);  // though its groups scatter more, and are told so
}

TEST(CalibJoint, EveryLensMayBend) {
  FeatureSession session = Visit(WithSeed(15));
  for (const auto& [camera, views] : FeatureSession(session).seen.views) Bend(camera.str().c_str(), 0.1, session);
  const SessionEstimate estimate = EstimateFrom(session);
  EXPECT_EQ(estimate.misfits.size(), 9u);
  EXPECT_TRUE(estimate.moved.empty());
  EXPECT_LT(WorstT2(session, estimate), 30.0);
}

TEST(CalibJoint, NoLensIsAccusedWhereNoneBends) {
  for (const std::uint64_t seed : {11, 12, 13})
    EXPECT_TRUE(EstimateFrom(Visit(WithSeed(seed))).misfits.empty()) << seed;
}

TEST(CalibJoint, ABumpIsNoBentLensAndABentLensNoBump) {
  sim::Options options = WithSeed(16);
  options.bump = SensorId("left_front");
  options.bump_m = 0.005;
  options.bump_rad = 0.0087;
  FeatureSession session = Visit(options);
  const SessionEstimate bumped = EstimateFrom(session);
  ASSERT_EQ(bumped.moved.size(), 1u);
  EXPECT_EQ(bumped.moved[0].sensor.str(), "left_front");
  EXPECT_NEAR(bumped.moved[0].step.head<3>().norm(), options.bump_m, 0.1 * options.bump_m);
  EXPECT_NEAR(bumped.moved[0].step.tail<3>().norm(), options.bump_rad, 0.1 * options.bump_rad);
  EXPECT_TRUE(bumped.misfits.empty());
  Bend("back", 0.2, session);
  const SessionEstimate both = EstimateFrom(session);
  ASSERT_EQ(both.moved.size(), 1u);
  EXPECT_EQ(both.moved[0].sensor.str(), "left_front");
  ASSERT_EQ(both.misfits.size(), 1u);
  EXPECT_EQ(both.misfits[0].camera.str(), "back");
}

// Squared sigmas of the values of a lens that were refined, at once; 9 are expected.
double LensT2(const FeatureSession& session, const RefinedLens& lens) {
  const IntrinsicsVector off =
      VectorOf(lens.intrinsics) - VectorOf(session.experiment.rig.SensorOf(lens.camera).camera.intrinsics);
  const Eigen::VectorXd e = off.head(lens.covariance.rows());
  return e.dot(lens.covariance.ldlt().solve(e));
}

TEST(CalibJoint, TellsTheLensesThatBelongToItsPoses) {
  for (const auto kind : {sim::IntrinsicsKind::kCalibrated, sim::IntrinsicsKind::kAbsent}) {
    sim::Options options = WithSeed(18);
    options.intrinsics = kind;
    const FeatureSession session = Visit(options);
    const SessionEstimate estimate = EstimateFrom(session);
    ASSERT_EQ(estimate.lenses.size(), 9u);
    double t2 = 0;
    for (const RefinedLens& lens : estimate.lenses) t2 += LensT2(session, lens) / 9;
    EXPECT_GT(t2, 3.0);
    EXPECT_LT(t2, 18.0);
  }
}

TEST(CalibJoint, ALensThatIsHeldIsNotTold) {
  sim::Options options = WithSeed(18);
  options.intrinsics = sim::IntrinsicsKind::kExact;
  EXPECT_TRUE(EstimateFrom(Visit(options)).lenses.empty());
}

TEST(CalibJoint, SaysWhyThereIsNothingToRefine) {
  FeatureSession session = Visit(WithSeed(10));
  for (auto& [camera, views] : session.seen.views)
    for (auto& [capture, view] : views) view.found = false;
  const auto start = StartOf(ViewsOf(session, NominalPoses(session)));
  ASSERT_FALSE(start);
  EXPECT_THAT(start.error().what, testing::HasSubstr("no picture of a board"));
}

}  // namespace
}  // namespace rigcal::calib::joint
