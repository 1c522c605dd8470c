// The figures of a certificate, by hand.
#include "server/report/certificate/figures.h"

#include <gtest/gtest.h>

#include <limits>

namespace rigcal::report {
namespace {

// Sigma in mm and deg on one axis of each half, less on the others; limits 5 mm and 0.005 rad.
SensorPose PoseWith(double sigma_m, double sigma_rad, double dof) {
  SensorPose pose{SensorId("lidar"), true, Se3(), Matrix6d::Identity() * 1e-12};
  pose.covariance(tangent::kY, tangent::kY) = sigma_m * sigma_m;
  pose.covariance(tangent::kRz, tangent::kRz) = sigma_rad * sigma_rad;
  pose.by_jackknife = dof > 0, pose.dof = dof;
  return pose;
}

formats::RevisionInput Limited() {
  formats::RevisionInput revision;
  revision.policy = PolicyInForce{};
  return revision;
}

CertifiedPose Certified(const SensorPose& pose) { return CertifiedPoseOf(pose, Limited()); }

// From a table of Student's t, 95 % on both sides.
TEST(CertificateFigures, CoverageFactorIsStudents) {
  SensorPose pose;
  EXPECT_FALSE(CoverageFactor(pose)) << "of what is not known nothing is";
  pose.known = true;
  EXPECT_NEAR(*CoverageFactor(pose), 1.960, 1e-3);
  for (const auto& [dof, k] : {std::pair(1.0, 12.706), std::pair(2.0, 4.303), std::pair(4.0, 2.776),
                               std::pair(10.0, 2.228), std::pair(30.0, 2.042), std::pair(1e6, 1.960)}) {
    pose.dof = dof;
    EXPECT_NEAR(*CoverageFactor(pose), k, 1e-3) << dof;
  }
  pose.dof = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(CoverageFactor(pose));
}

TEST(CertificateFigures, UIsKTimesTheWorstAxis) {
  const CertifiedPose certified = Certified(PoseWith(0.0002, 0.0003, 10));
  EXPECT_NEAR(*certified.k, 2.2281, 1e-4);
  EXPECT_NEAR(*certified.shift.sigma, 0.0002, 1e-12);
  EXPECT_NEAR(*certified.shift.U, 0.00044563, 1e-8);
  EXPECT_NEAR(*certified.turn.U, 0.00066844, 1e-8);
  EXPECT_DOUBLE_EQ(*certified.shift.limit, 0.005);
  EXPECT_EQ(certified.decision, Conformity::kWithin);
}

// Of a sigma of 2.2 mm, k = 2.228: U = 4.90 mm; of 2.3 mm: U = 5.12 mm. With 4 degrees of freedom, k = 2.776, 1.9 mm
// are 5.27 mm.
TEST(CertificateFigures, GuardBandIsU) {
  EXPECT_EQ(Certified(PoseWith(0.0022, 0.0003, 10)).decision, Conformity::kWithin);
  EXPECT_EQ(Certified(PoseWith(0.0023, 0.0003, 10)).decision, Conformity::kOpen);
  EXPECT_EQ(Certified(PoseWith(0.0019, 0.0003, 10)).decision, Conformity::kWithin);
  EXPECT_EQ(Certified(PoseWith(0.0019, 0.0003, 4)).decision, Conformity::kOpen);
  EXPECT_EQ(Certified(PoseWith(0.0051, 0.0003, 10)).decision, Conformity::kBeyond);
  EXPECT_EQ(Certified(PoseWith(0.0002, 0.0051, 10)).decision, Conformity::kBeyond) << "both have to be kept";
}

TEST(CertificateFigures, WithoutDegreesOfFreedomOrSigmaNothingIsDecided) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Certified(PoseWith(0.0002, 0.0003, kNone)).decision, Conformity::kOpen);
  EXPECT_FALSE(Certified(PoseWith(0.0002, 0.0003, kNone)).shift.U);
  EXPECT_EQ(Certified(PoseWith(0.0051, 0.0003, kNone)).decision, Conformity::kBeyond);
  for (const double odd : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN(), 0.0}) {
    SensorPose pose = PoseWith(0.0002, 0.0003, 10);
    pose.covariance.diagonal().head<3>().setConstant(odd);
    EXPECT_FALSE(Certified(pose).shift.sigma) << odd;
    EXPECT_FALSE(Certified(pose).shift.U) << odd;
    EXPECT_EQ(Certified(pose).decision, Conformity::kOpen) << odd;
  }
}

TEST(CertificateFigures, WithoutALimitThereIsNoDecision) {
  EXPECT_EQ(CertifiedPoseOf(PoseWith(0.0002, 0.0003, 10), {}).decision, Conformity::kNoLimit);
  EXPECT_TRUE(CertifiedPoseOf(PoseWith(0.0002, 0.0003, 10), {}).shift.U);
}

TEST(CertificateFigures, DecisionsOfWhatIsOff) {
  EXPECT_EQ(Decide(0.004, 0.001, 0.005), Conformity::kWithin);
  EXPECT_EQ(Decide(-0.0041, 0.001, 0.005), Conformity::kOpen);
  EXPECT_EQ(Decide(-0.0061, 0.001, 0.005), Conformity::kBeyond);
}

// Off by 4.5 mm on y with sigma 0.4 mm, by 0.001 rad on rx with sigma 0.0001 rad; z was not measured.
SensorFound Found() {
  SensorFound found{SensorId("lidar"), FoundState::kDrifted};
  found.axes.fill(FoundState::kUnchanged);
  found.axes[tangent::kY] = FoundState::kDrifted;
  found.axes[tangent::kZ] = FoundState::kNotMeasured;
  found.change << 0.0001, -0.0045, 0, 0.001, 0, 0;
  found.sigma << 0.0004, 0.0004, 0, 0.0001, 0.0001, 0.0001;
  found.left = Vector6d::Zero();
  (*found.left)(tangent::kX) = -0.0002;
  return found;
}

TEST(CertificateFigures, AsFoundIsTheAxisThatWasOffMost) {
  const FoundFigures figures = FoundFiguresOf(Found(), kDefaultTolerance, false);
  EXPECT_DOUBLE_EQ(*figures.shift.off, 0.0045);
  EXPECT_DOUBLE_EQ(*figures.shift.U, 0.0008);
  EXPECT_DOUBLE_EQ(*figures.shift.left, 0.0002);
  EXPECT_EQ(figures.shift.decision, Conformity::kOpen) << "4.5 + 0.8 is more than 5, 4.5 - 0.8 is not";
  EXPECT_EQ(figures.turn.decision, Conformity::kWithin);
  EXPECT_EQ(figures.decision, Conformity::kOpen);
}

TEST(CertificateFigures, AnAxisThatIsNeededAndWasNotMeasuredLeavesItOpen) {
  SensorFound found = Found();
  found.change(tangent::kY) = 0.001;
  EXPECT_EQ(FoundFiguresOf(found, kDefaultTolerance, false).decision, Conformity::kWithin);
  EXPECT_EQ(FoundFiguresOf(found, kDefaultTolerance, true).decision, Conformity::kOpen);
  found.axes.fill(FoundState::kNotMeasured);
  const FoundFigures none = FoundFiguresOf(found, kDefaultTolerance, false);
  EXPECT_EQ(none.decision, Conformity::kOpen);
  EXPECT_FALSE(none.shift.off || none.turn.U || none.shift.left);
}

}  // namespace
}  // namespace rigcal::report
