// What of a revision leaves, and in which frame: covariances against samples drawn in the test.
#include <gmock/gmock.h>

#include <random>

#include "tests/unit/formats/export_sample.h"

namespace rigcal::exports {
namespace {

using sample::Rig;
using testing::ElementsAre;
using testing::HasSubstr;

SensorPose Pose(const std::string& name, double x_m) {
  SensorPose pose;
  pose.sensor = SensorId(name);
  pose.known = true;
  pose.T_ref_sensor.p_m.x() = x_m;
  pose.covariance = Matrix6d::Identity() * x_m;
  return pose;
}

formats::RevisionInput Revision() {
  formats::RevisionInput revision;
  revision.robot = RobotId("r");
  revision.reference = SensorId("b");
  revision.solution.poses = {Pose("a", 1), Pose("b", 0), Pose("c", 2)};
  return revision;
}

TEST(ExportCalibration, TheReferenceComesFirstAndFactsStandBesideTheirSensor) {
  formats::SensorFactsOfRevision facts{RobotId("r"), 3, {}};
  facts.sensors.push_back(
      {SensorId("a"), SensorKind::kCamera, sample::Camera("a", CameraModel::kPinholeRadtan, {0, 0, 0, 0, 0})});
  facts.sensors.push_back({SensorId("c"), SensorKind::kLidar});
  const auto calibration = CalibrationOf(Revision(), facts);
  ASSERT_TRUE(calibration);
  ASSERT_EQ(calibration->sensors.size(), 3U);
  EXPECT_EQ(calibration->root_frame(), "b");
  EXPECT_TRUE(calibration->Find(SensorId("a"))->camera);
  EXPECT_EQ(calibration->Find(SensorId("c"))->kind, SensorKind::kLidar);
  EXPECT_TRUE(calibration->left_out.empty());
}

TEST(ExportCalibration, NamesWhatIsNotWhole) {
  formats::RevisionInput revision = Revision();
  revision.solution.poses[2].known = false;
  EXPECT_THAT(CalibrationOf(revision, std::nullopt)->left_out,
              ElementsAre("c: its pose is not known", HasSubstr("this rigcald is older")));
  Vector6d height = Vector6d::Zero();
  height[tangent::kZ] = 1;
  revision.solution.poses[2].unobservable_basis = {height};
  revision.solution.poses[2].measured_part = MeasuredPart{};
  EXPECT_THAT(CalibrationOf(revision, std::nullopt)->left_out[0], "c: the position along z was not measured");
  revision.solution.poses[0].known = false;
  EXPECT_THAT(CalibrationOf(revision, std::nullopt).error().what, HasSubstr("no whole pose beside its reference"));
}

// A camera without a size or intrinsics has no lens to write.
TEST(ExportCalibration, AFitWithoutIntrinsicsIsNone) {
  formats::SensorFactsOfRevision facts{RobotId("r"), 3, {}};
  CameraFit fit = sample::Camera("a", CameraModel::kPinholeRadtan, {0, 0, 0, 0, 0});
  fit.source = IntrinsicsSource::kNone;
  facts.sensors.push_back({SensorId("a"), SensorKind::kCamera, fit});
  EXPECT_FALSE(CalibrationOf(Revision(), facts)->Find(SensorId("a"))->camera);
}

// Poses against points; the covariance of the former root against 20,000 drawn errors: within 5 % of the standard
// deviations.
TEST(ExportCalibration, AnotherRootMovesPosesAndTheirUncertainty) {
  Calibration rig = Rig();
  const ExportedSensor right = rig.sensors[1];
  const Matrix6d told = Matrix6d::Identity() * 0.25;
  const auto rebased =
      Rebased(rig, SensorId("right"), {{SensorId("lidar"), told}, {SensorId("mast"), told}, {SensorId("nose"), told}});
  ASSERT_TRUE(rebased);
  EXPECT_EQ(rebased->root_frame(), "right");
  ASSERT_EQ(rebased->sensors.size(), 5U);
  const auto& truth = sample::Truth();
  for (const ExportedSensor& sensor : rebased->sensors)
    for (const Eigen::Vector3d& p : sample::Points())
      EXPECT_LT((sensor.T_root_sensor * p - truth.at("right").Back(truth.at(sensor.frame) * p)).norm(), 1e-13)
          << sensor.frame;
  EXPECT_EQ(rebased->Find(SensorId("lidar"))->covariance, told);
  EXPECT_TRUE(rebased->sensors[0].covariance.isZero());
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Matrix6d scatter = Matrix6d::Zero();
  constexpr int kDraws = 20000;
  const Se3 T_right_left = right.T_root_sensor.Inverse();
  for (int k = 0; k < kDraws; ++k) {
    Vector6d xi;
    for (int axis = 0; axis < 6; ++axis) xi[axis] = std::sqrt(right.covariance(axis, axis)) * normal(random);
    const Vector6d e = (T_right_left.Inverse() * (right.T_root_sensor * Se3::Exp(xi)).Inverse()).Log();
    scatter += e * e.transpose() / kDraws;
  }
  const Matrix6d& covariance = rebased->Find(SensorId("left"))->covariance;
  for (int axis = 0; axis < 6; ++axis)
    EXPECT_NEAR(std::sqrt(covariance(axis, axis)), std::sqrt(scatter(axis, axis)),
                0.05 * std::sqrt(scatter(axis, axis)))
        << axis;
}

TEST(ExportCalibration, ARootThatIsNoneAndASensorWithoutCovarianceAreSaid) {
  EXPECT_THAT(Rebased(Rig(), SensorId("tail"), {}).error().cure, HasSubstr("left, right, lidar, mast, nose"));
  const auto rebased = Rebased(Rig(), SensorId("lidar"), {});
  ASSERT_TRUE(rebased);
  EXPECT_EQ(rebased->sensors.size(), 2U);
  EXPECT_THAT(rebased->left_out, testing::Contains("mast: how well its pose in lidar is known cannot be told"));
}

TEST(ExportCalibration, FramesHaveOtherNamesIfAskedFor) {
  Calibration rig = Rig();
  ASSERT_TRUE(RenameFrames(rig, {{SensorId("lidar"), "top/velodyne"}}));
  EXPECT_EQ(rig.Find(SensorId("lidar"))->frame, "top/velodyne");
  EXPECT_THAT(sample::TextOf(WriteUrdf, rig), HasSubstr("<child link=\"top/velodyne\"/>"));
  EXPECT_THAT(RenameFrames(rig, {{SensorId("tail"), "t"}}).error().what, HasSubstr("'tail' is no sensor"));
  EXPECT_THAT(RenameFrames(rig, {{SensorId("mast"), "a\"b"}}).error().what, HasSubstr("cannot hold"));
  EXPECT_THAT(RenameFrames(rig, {{SensorId("mast"), "left"}}).error().what,
              HasSubstr("two sensors would have the frame 'left'"));
}

TEST(SensorFacts, ComeBackAsTheyWere) {
  formats::SensorFactsOfRevision facts{RobotId("r"), 3, {}};
  formats::SensorFacts camera{SensorId("a"), SensorKind::kCamera,
                              sample::Camera("a", CameraModel::kFisheyeKb4, {1, 2, 3, 4}),
                              EdgeId(std::string(64, 'e'))};
  facts.sensors = {camera, {SensorId("b"), SensorKind::kPoseStream}, {SensorId("c")}};
  const std::string text = formats::WriteSensorFacts(facts);
  const auto read = formats::ReadSensorFacts(text);
  ASSERT_TRUE(read) << read.error().what;
  EXPECT_EQ(formats::WriteSensorFacts(*read), text);
  EXPECT_EQ(read->sensors[0].camera->intrinsics, camera.camera->intrinsics);
  EXPECT_FALSE(read->sensors[2].kind);
  EXPECT_THAT(formats::ReadSensorFacts("{\"robot\":\"r\"}").error().what, HasSubstr("sensors"));
}

}  // namespace
}  // namespace rigcal::exports
