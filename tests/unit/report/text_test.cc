#include "server/report/text/text.h"

#include <gtest/gtest.h>

#include <cmath>

#include "server/report/text/edge_axes.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

TEST(ReportText, FixedHasNoNegativeZeroAndNoNan) {
  EXPECT_EQ(Fixed(-0.001, 2), "0.00");
  EXPECT_EQ(Fixed(-1.005e3, 1), "-1005.0");
  EXPECT_EQ(Fixed(std::nan(""), 2), "not known");
  EXPECT_EQ(Fixed(-HUGE_VAL, 2), "not known");
}

TEST(ReportText, SignificantDigits) {
  EXPECT_EQ(Significant(0.0214, 2), "0.021");
  EXPECT_EQ(Significant(123.4, 2), "123");
  EXPECT_EQ(Significant(4.1e-6, 3), "4.10e-6");
  EXPECT_EQ(Significant(1.5e12, 2), "1.5e+12");
  EXPECT_EQ(Significant(0.0, 2), "0");
}

TEST(ReportText, Units) {
  EXPECT_EQ(Mm(0.08318), "83.18");
  EXPECT_EQ(Deg(M_PI / 4), "45.000");
  EXPECT_EQ(FigureName("baseline_m"), "baseline");
  EXPECT_EQ(FigureValue("baseline_m", 0.08318), "83.18 mm");
  EXPECT_EQ(FigureValue("tilt_rad", M_PI / 2), "90.00 deg");
  EXPECT_EQ(FigureName("rms_px"), "rms");
  EXPECT_EQ(FigureValue("rms_px", 0.2231), "0.2231 px");
  EXPECT_EQ(FigureValue("captures", 13), "13");
  EXPECT_EQ(FigureValue("rms_px", std::nan("")), "not known");
}

// Oracle: the rotation is built from its three factors, each about one axis.
TEST(ReportText, RollPitchYawOfEachAxis) {
  const auto about = [](double angle, const Eigen::Vector3d& axis) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
  };
  for (const double roll : {-3.0, 0.1, 1.2})
    for (const double pitch : {-1.5, 0.0, 0.7})
      for (const double yaw : {-2.9, 0.0, 2.2}) {
        const auto angles =
            RollPitchYawOf(about(yaw, Eigen::Vector3d::UnitZ()) * about(pitch, Eigen::Vector3d::UnitY()) *
                           about(roll, Eigen::Vector3d::UnitX()));
        EXPECT_NEAR(angles.roll, roll, 1e-9);
        EXPECT_NEAR(angles.pitch, pitch, 1e-9);
        EXPECT_NEAR(angles.yaw, yaw, 1e-9);
      }
}

TEST(ReportText, PitchOfNinetyDegrees) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ())) *
                               Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()));
  const auto angles = RollPitchYawOf(q);
  EXPECT_EQ(angles.roll, 0.0);
  EXPECT_NEAR(angles.pitch, M_PI / 2, 1e-7);
  EXPECT_NEAR(angles.yaw, 0.4, 1e-7);
}

TEST(ReportText, FreeAxisIsNamedAtItsPlace) {
  for (int axis = 0; axis < 6; ++axis) {
    Matrix6d Omega = Matrix6d::Identity() * 1e6;
    Omega(axis, axis) = 0.0;
    Edge edge;
    edge.uncertainty = FromInformation(Omega, UncertaintySource::kGiven, 0);
    const Uncertainty& uncertainty = edge.uncertainty;
    const std::string name(tangent::kNames[static_cast<std::size_t>(axis)]);
    for (int other = 0; other < 6; ++other) EXPECT_EQ(AxisSigmaText(uncertainty, other) == "free", other == axis);
    const std::string here = LargestSigma(uncertainty, axis < 3 ? 0 : 3, axis < 3 ? " mm" : " deg");
    EXPECT_EQ(here, std::string(axis < 3 ? "1.0 mm" : "0.057 deg") + ", free: " + name);
    EXPECT_NE(ObservabilityText(edge).find("free: " + name + "."), std::string::npos);
  }
}

TEST(ReportText, NothingObservedIsFree) {
  const Uncertainty uncertainty = FromInformation(Matrix6d::Zero(), UncertaintySource::kGiven, 0);
  EXPECT_EQ(LargestSigma(uncertainty, 0, " mm"), "free");
}

}  // namespace
}  // namespace rigcal::report
