// What a page tells of a sensor of which a direction was not measured.
#include <gmock/gmock.h>

#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// The height of top, open as a robot on a level floor leaves it; no other sensor is without a pose.
ReportInput InPart() {
  ReportInput input = SampleReport();
  input.revision.solution.R_ref_robot = Eigen::Matrix3d::Identity();
  auto& poses = input.revision.solution.poses;
  poses.pop_back();
  SensorPose& top = poses[4];
  top.known = false;
  top.unobservable_basis = {Vector6d::Unit(tangent::kZ)};
  top.measured_part = MeasuredPart{top.T_ref_sensor};
  top.measured_part->T_ref_sensor.p_m = {0.1, -0.2, 0.777};
  top.measured_part->T_ref_sensor.q = Eigen::AngleAxisd(M_PI / 6, Eigen::Vector3d::UnitZ());
  for (int axis = 0; axis < 6; ++axis)
    top.measured_part->covariance(axis, axis) = axis == 2 ? 0 : axis < 3 ? 4e-6 : 4e-8;
  return input;
}

TEST(ReportPart, EachAxisHasItsSigmaOrIsNotMeasured) {
  const std::string page = PageOf(InPart()), row = RowOf(page, "top");
  EXPECT_THAT(row, HasSubstr("<div>forward 100.00</div><div>sideways -200.00</div><div>height not measured</div>"));
  EXPECT_THAT(row, HasSubstr("<td>0.000</td><td>0.000</td><td>30.000</td>"));
  EXPECT_THAT(row, HasSubstr("<div>forward 2.0</div><div>sideways 2.0</div></td>"));
  EXPECT_THAT(row, HasSubstr("<div>roll 0.011</div><div>pitch 0.011</div><div>yaw 0.011</div>"));
  EXPECT_THAT(row, Not(HasSubstr("777")));  // what was held is no result
  EXPECT_THAT(row, Not(HasSubstr("unknown")));
  EXPECT_THAT(page, HasSubstr("along and about the axes of <bdi>the robot</bdi>"));
  EXPECT_THAT(PageOf(SampleReport()), Not(HasSubstr("not everything was measured")));
}

TEST(ReportPart, WithoutTheRobotsAxesTheReferencesAreNamed) {
  ReportInput input = InPart();
  input.revision.solution.R_ref_robot.reset();
  const std::string page = PageOf(input);
  EXPECT_THAT(RowOf(page, "top"), HasSubstr("<div>x 100.00</div><div>y -200.00</div><div>z not measured</div>"));
  EXPECT_THAT(page, HasSubstr("along and about the axes of <bdi>front_left</bdi>"));
}

TEST(ReportPart, ATurnThatIsOpenHasNoAngles) {
  ReportInput input = InPart();
  SensorPose& top = input.revision.solution.poses[4];
  top.unobservable_basis = {Vector6d::Unit(tangent::kRz)};
  top.measured_part->covariance(tangent::kRz, tangent::kRz) = 0;
  const std::string row = RowOf(PageOf(input), "top");
  EXPECT_THAT(row, HasSubstr("<td class=\"text\" colspan=\"3\"><div>yaw not measured</div></td>"));
  EXPECT_THAT(row, HasSubstr("<div>height 777.00</div>"));
  EXPECT_THAT(row, HasSubstr("<div>roll 0.011</div><div>pitch 0.011</div></td>"));
  EXPECT_THAT(row, Not(HasSubstr("30.000")));
}

TEST(ReportPart, TheCertificateSaysHowFarItGoes) {
  const std::string page = RenderRevision(InPart(), "{}").value().at("certificate.html");
  EXPECT_THAT(page, HasSubstr("the height was not measured; the rest is good to 2.0 mm and 0.011 deg"));
  EXPECT_THAT(page, Not(HasSubstr("777")));
}

TEST(ReportPart, IsTheWorstSensorWhereNoOtherIsWithoutAPose) {
  const std::string page = PageOf(InPart());
  EXPECT_THAT(page, HasSubstr("height not measured</p>"));
  EXPECT_THAT(page, HasSubstr("4 known, 1 in part, 0 unknown"));
  ReportInput lost = InPart();
  AddPose(lost.revision, "tracker", false, Se3(), 0);
  EXPECT_THAT(PageOf(lost), HasSubstr("its pose is not known"));
}

}  // namespace
}  // namespace rigcal::report
