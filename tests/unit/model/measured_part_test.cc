// Six results of a pose of which some directions are open.
#include "server/model/graph/measured_part.h"

#include <gmock/gmock.h>

#include <cmath>

#include "server/math/covariance.h"
#include "server/model/graph/graph.h"

namespace rigcal {
namespace {

using testing::ElementsAre;

const Eigen::Matrix3d kAsRobot = Eigen::Matrix3d::Identity();

Vector6d Along(double x, double y, double z, double rx = 0, double ry = 0, double rz = 0) {
  return (Vector6d() << x, y, z, rx, ry, rz).finished();
}

// One millimetre and two milliradians along every axis of the sensor, but for what is open.
Matrix6d CovarianceWithout(const std::vector<Vector6d>& open) {
  Matrix6d C = Along(1e-6, 1e-6, 1e-6, 4e-6, 4e-6, 4e-6).asDiagonal();
  Eigen::Matrix<double, 6, Eigen::Dynamic> basis(6, static_cast<Eigen::Index>(open.size()));
  for (std::size_t k = 0; k < open.size(); ++k) basis.col(static_cast<Eigen::Index>(k)) = open[k];
  return CovarianceAcross(C, basis);
}

std::vector<AxisResult> Told(const std::vector<Vector6d>& open, const Se3& T = {},
                             const Eigen::Matrix3d& R_frame_robot = kAsRobot) {
  return AxesOf(T, CovarianceWithout(open), open, R_frame_robot);
}

std::vector<std::string> Open(const std::vector<AxisResult>& axes) {
  std::vector<std::string> names;
  for (const AxisResult& axis : axes)
    if (!axis.measured()) names.push_back(axis.name);
  return names;
}

TEST(AxesOf, EachAxisThatIsOpenHasNoNumberAndTheOthersHave) {
  const std::vector<std::string> names = {"forward", "sideways", "height", "roll", "pitch", "yaw"};
  for (int open = 0; open < 6; ++open) {
    const std::vector<AxisResult> axes = Told({Vector6d::Unit(open)});
    ASSERT_EQ(axes.size(), 6U);
    for (int k = 0; k < 6; ++k) {
      const AxisResult& axis = axes[static_cast<std::size_t>(k)];
      EXPECT_EQ(axis.name, names[static_cast<std::size_t>(k)]);
      EXPECT_EQ(axis.turn, k >= 3);
      EXPECT_EQ(axis.measured(), k != open) << axis.name;
      EXPECT_EQ(axis.position_m.has_value(), k < 3 && k != open);
      EXPECT_NEAR(axis.sigma_m.value_or(0) + axis.sigma_rad.value_or(0), k == open ? 0 : k < 3 ? 0.001 : 0.002, 1e-12);
    }
  }
}

TEST(AxesOf, TellsWhereTheSensorIsAlongWhatWasMeasured) {
  Se3 T;
  T.p_m = {0.5, -0.2, 1.5};
  T.q = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX());  // y of the sensor is up
  const std::vector<AxisResult> axes = Told({Vector6d::Unit(tangent::kY)}, T);
  EXPECT_THAT(Open(axes), ElementsAre("height"));
  EXPECT_NEAR(axes[0].position_m.value(), 0.5, 1e-12);
  EXPECT_NEAR(axes[1].position_m.value(), -0.2, 1e-12);
  EXPECT_TRUE(TurnsMeasured(axes));
}

// The error is put on one axis of the sensor and looked for at the robot's.
TEST(AxesOf, ErrorOnOneAxisOfTheSensorIsToldAtThatOfTheRobot) {
  Eigen::Matrix3d camera;  // the reference looks along its z
  camera << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  Matrix6d C = 1e-12 * Matrix6d::Identity();
  C(tangent::kX, tangent::kX) = 9e-6, C(tangent::kRz, tangent::kRz) = 16e-6;
  const std::vector<AxisResult> axes = AxesOf({}, C, {}, camera);
  EXPECT_NEAR(axes[1].sigma_m.value(), 3e-3, 1e-12);  // x is to the right
  EXPECT_NEAR(axes[3].sigma_rad.value(), 4e-3, 1e-12);
  EXPECT_NEAR(axes[0].sigma_m.value(), 1e-6, 1e-12);
  EXPECT_LT((axes[1].direction - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-12);
}

// The floor is not level in the reference's frame by 6 degrees: what lies across the upright was measured.
TEST(AxesOf, AnAxisOffBySomeDegreesKeepsItsNameAndTheRestStandsAcrossIt) {
  const double tilt = 6 * M_PI / 180;
  const Vector6d upright = Along(std::sin(tilt), 0, std::cos(tilt));
  Se3 T;
  T.p_m = {2, 0, 0.7};
  const std::vector<AxisResult> axes = Told({upright}, T);
  EXPECT_THAT(Open(axes), ElementsAre("height"));
  EXPECT_LT((axes[2].direction - upright.head<3>()).norm(), 1e-12);
  EXPECT_NEAR(axes[0].position_m.value(), 2 * std::cos(tilt) - 0.7 * std::sin(tilt), 1e-12);
  T.p_m += 5 * upright.head<3>();  // held elsewhere, it is the same result
  EXPECT_NEAR(Told({upright}, T)[0].position_m.value(), axes[0].position_m.value(), 1e-12);
  EXPECT_NEAR(axes[0].sigma_m.value(), 1e-3, 1e-9);
}

TEST(AxesOf, ADirectionAlongNoAxisHasNoName) {
  const std::vector<AxisResult> axes = Told({Along(0.9, -0.44, 0)});
  std::size_t open = 0;
  for (const AxisResult& axis : axes) {
    if (axis.measured()) continue;
    ++open;
    EXPECT_EQ(LabelOf(axis, kAsRobot), "(0.90 forward, -0.44 sideways)");
    EXPECT_EQ(LabelOf(axis, std::nullopt), "(0.90 x, -0.44 y)");
  }
  EXPECT_EQ(open, 1U);
  EXPECT_THAT(NamesOfOpen(axes, 1), ElementsAre("one direction"));
  EXPECT_THAT(NamesOfOpen(Told({Along(0.9, -0.44, 0), Along(0, 0, 1)}), 2), ElementsAre("2 directions"));
  EXPECT_EQ(axes.back().name, "yaw");  // turns keep theirs
}

// Turned on the spot, 0.3 m beside the axis: neither the yaw nor the place along the circle.
TEST(AxesOf, AShiftThatIsOpenTogetherWithATurnMakesBothOpen) {
  const std::vector<AxisResult> axes = Told({Along(0.3, 0, 0, 0, 0, 1)});
  EXPECT_THAT(NamesOfOpen(axes, 1), ElementsAre("forward", "yaw"));
  EXPECT_FALSE(TurnsMeasured(axes));
  EXPECT_NEAR(axes[1].sigma_m.value(), 0.001, 1e-9);
}

// What noise couples with a height is no turn, whichever of its numbers is 1.
TEST(AxesOf, NextToNothingBesideAShiftIsNoTurn) {
  const Vector6d noisy = Along(0.052, 0.035, 1, 2e-3, 1e-3, -3e-3);
  for (const Vector6d& direction : {noisy, Vector6d(noisy / 3e-3)})
    EXPECT_THAT(Open(Told({direction})), ElementsAre("height"));
  EXPECT_THAT(Open(Told({Along(0, 0, 1, 0, 0, 0.02)})), ElementsAre("height", "yaw"));
  EXPECT_THAT(Open(Told({Along(0, 5e-4, 0, 0, 0, 1)})), ElementsAre("yaw"));
  EXPECT_THAT(Open(Told({Along(0, 2e-3, 0, 0, 0, 1)})), ElementsAre("sideways", "yaw"));
}

TEST(AxesOf, WithoutTheRobotsAxesThoseOfTheFrameHaveTheirNames) {
  const std::vector<AxisResult> axes = AxesOf({}, CovarianceWithout({Along(0, 0, 1)}), {Along(0, 0, 1)}, std::nullopt);
  std::vector<std::string> names;
  for (const AxisResult& axis : axes) names.push_back(axis.name);
  EXPECT_THAT(names, ElementsAre("x", "y", "z", "rx", "ry", "rz"));
  EXPECT_THAT(NamesOfOpen(axes, 1), ElementsAre("z"));
  EXPECT_TRUE(OpenHaveNames(axes));
  EXPECT_FALSE(OpenHaveNames(Told({Along(0.9, -0.44, 0)})));
  EXPECT_FALSE(OpenHaveNames({}));
}

TEST(AxesOf, APoseThatIsKnownHasSixNumbersAndOneOfWhichNothingIsKnownHasNone) {
  SensorPose pose;
  EXPECT_TRUE(AxesOf(pose, kAsRobot).empty());
  EXPECT_EQ(pose.Placed(), nullptr);
  pose.measured_part = MeasuredPart{{}, CovarianceWithout({Vector6d::Unit(2)})};
  pose.unobservable_basis = {Vector6d::Unit(2)};
  EXPECT_THAT(Open(AxesOf(pose, kAsRobot)), ElementsAre("height"));
  EXPECT_EQ(pose.Placed(), &pose.measured_part->T_ref_sensor);
  pose.known = true;
  pose.covariance = CovarianceWithout({});
  EXPECT_THAT(Open(AxesOf(pose, kAsRobot)), testing::IsEmpty());
  EXPECT_EQ(pose.Placed(), &pose.T_ref_sensor);
}

TEST(WorstSigmaOf, IsOfWhatWasMeasured) {
  const RestSigma rest = WorstSigmaOf(Told({Along(0, 0, 1)}));
  EXPECT_NEAR(rest.m.value(), 0.001, 1e-12);
  EXPECT_NEAR(rest.rad.value(), 0.002, 1e-12);
  EXPECT_FALSE(WorstSigmaOf(Told({Vector6d::Unit(0), Vector6d::Unit(1), Vector6d::Unit(2)})).m);
}

TEST(InSentence, NamesAxesAsPeopleDo) {
  EXPECT_EQ(InSentence("height"), "the height");
  EXPECT_EQ(InSentence("forward"), "the forward position");
  EXPECT_EQ(InSentence("z"), "the position along z");
  EXPECT_EQ(InSentence("ry"), "the turn about y");
  EXPECT_EQ(InSentence("2 directions"), "2 directions");
}

// Numbers that no rig has make no number that is none.
TEST(AxesOf, WildNumbersMakeNothingThatIsNotFinite) {
  Se3 T;
  T.p_m = {1e308, 1e308, -1e308};
  const std::vector<AxisResult> axes =
      AxesOf(T, 1e308 * Matrix6d::Ones(), {Vector6d::Constant(1e308), Vector6d::Zero()}, kAsRobot);
  ASSERT_EQ(axes.size(), 6U);
  for (const AxisResult& axis : axes) {
    EXPECT_TRUE(axis.direction.allFinite());
    for (const auto& value : {axis.position_m, axis.sigma_m, axis.sigma_rad})
      EXPECT_TRUE(!value || std::isfinite(*value));
  }
}

}  // namespace
}  // namespace rigcal
