#include "client/text/pose_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

namespace rigcal::client {
namespace {

// Rotation matrices written out by hand, so that no library's convention is shared.
Eigen::Matrix3d Rx(double a) {
  return (Eigen::Matrix3d() << 1, 0, 0, 0, std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a)).finished();
}
Eigen::Matrix3d Ry(double a) {
  return (Eigen::Matrix3d() << std::cos(a), 0, std::sin(a), 0, 1, 0, -std::sin(a), 0, std::cos(a)).finished();
}
Eigen::Matrix3d Rz(double a) {
  return (Eigen::Matrix3d() << std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a), 0, 0, 0, 1).finished();
}

TEST(RollPitchYaw, GivesBackEachAngleAtItsPlace) {
  for (const double roll : {-3.0, -0.4, 0.0, 1.2, 3.1})
    for (const double pitch : {-1.5, -0.3, 0.0, 0.9, 1.5})
      for (const double yaw : {-3.1, -1.0, 0.0, 0.2, 2.9}) {
        const Eigen::Vector3d rpy = RollPitchYaw(Eigen::Matrix3d(Rz(yaw) * Ry(pitch) * Rx(roll)));
        EXPECT_NEAR(rpy[0], roll, 1e-12);
        EXPECT_NEAR(rpy[1], pitch, 1e-12);
        EXPECT_NEAR(rpy[2], yaw, 1e-12);
      }
}

TEST(RollPitchYaw, AtTheGimbalTheMatrixComesBack) {
  for (const double pitch : {M_PI / 2, -M_PI / 2}) {
    const Eigen::Matrix3d R = Rz(0.7) * Ry(pitch) * Rx(0.2);
    const Eigen::Vector3d rpy = RollPitchYaw(R);
    EXPECT_EQ(rpy[0], 0.0);
    EXPECT_LT((Rz(rpy[2]) * Ry(rpy[1]) * Rx(rpy[0]) - R).norm(), 1e-8);
  }
}

TEST(RollPitchYaw, TheQuaternionIsInOrderXyzw) {
  const double half = 0.15;
  const Eigen::Vector3d about_y = RollPitchYaw(Eigen::Vector4d(0, std::sin(half), 0, std::cos(half)));
  EXPECT_NEAR(about_y[1], 2 * half, 1e-12);
  EXPECT_NEAR(about_y[0], 0.0, 1e-12);
  EXPECT_NEAR(about_y[2], 0.0, 1e-12);
  const Eigen::Vector3d unnormalized = RollPitchYaw(Eigen::Vector4d(3 * std::sin(half), 0, 0, 3 * std::cos(half)));
  EXPECT_NEAR(unnormalized[0], 2 * half, 1e-12);
}

TEST(PoseText, MillimetresAndDegreesAndDashesWhereNothingIsKnown) {
  const auto document = Document::Parse(
      R"({"pose": {"p_m": [0.08318, -0.00092, 0.00012], "q_xyzw": [0, 0, 0.7071067811865476, 0.7071067811865476]},
          "partly": [0.001, null, 0.003], "zero": {"q_xyzw": [0, 0, 0, 0]}})",
      "test");
  ASSERT_TRUE(document);
  EXPECT_EQ(Triple((*document)["pose"]["p_m"], kMmPerM, 2), "83.18 -0.92 0.12");
  EXPECT_EQ(RpyText((*document)["pose"], 3), "0.000 0.000 90.000");
  EXPECT_EQ(Triple((*document)["partly"], kMmPerM, 1), "1.0 - 3.0");
  EXPECT_EQ(Triple((*document)["absent"], kMmPerM, 1), "-");
  EXPECT_EQ(RpyText((*document)["zero"], 3), "-");
  EXPECT_EQ(RpyText((*document)["absent"], 3), "-");
}

TEST(PoseText, MatrixIsSixLinesOfSix) {
  const auto document = Document::Parse(
      "[[1,0,0,0,0,0],[0,1,0,0,0,0],[0,0,1,0,0,0],[0,0,0,1,0,0],[0,0,0,0,1,0],[0,0,0,0,0,-2.5e-9]]", "test");
  ASSERT_TRUE(document);
  std::ostringstream out;
  PrintMatrix(*document, "", out);
  std::istringstream lines(out.str());
  std::string line;
  int count = 0;
  for (; std::getline(lines, line); ++count) EXPECT_EQ(line.size(), 6U * 13U);
  EXPECT_EQ(count, 6);
  EXPECT_NE(out.str().find("-2.5000e-09\n"), std::string::npos);
}

}  // namespace
}  // namespace rigcal::client
