// Boards whose normals lie in one plane or nearly so: five numbers are told, and the sixth is not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/calib/virtual_lidar.h"

namespace rigcal::calib {
namespace {

using Eigen::Vector3d;

VirtualLidarRig NoisyRig() {
  VirtualLidarRig rig;
  rig.corner_sigma_px = 0.2;
  rig.range_sigma_m = 0.02;
  return rig;
}

bool HasNote(const Edge& edge, const std::string& code) {
  return std::any_of(edge.diagnoses.begin(), edge.diagnoses.end(), [&](const Diagnosis& d) { return d.code == code; });
}

Vector6d ErrorOf(const Se3& truth, const Se3& estimate) { return (truth.Inverse() * estimate).Log(); }

// As before a robot on a flat floor: turned about the camera's y, and tilted out of the plane of those normals to both
// sides by no more than `tilt_rad`.
std::vector<Se3> BoardsTurnedOnAFloor(double tilt_rad = 0.0) {
  std::vector<Se3> boards = BoardsBefore(12);
  for (std::size_t i = 0; i < boards.size(); ++i)
    boards[i].q =
        Eigen::Quaterniond(Eigen::AngleAxisd(tilt_rad * std::sin(2.4 * static_cast<double>(i)), Vector3d::UnitX()) *
                           Eigen::AngleAxisd(0.1 * static_cast<double>(i) - 0.6, Vector3d::UnitY()));
  return boards;
}

double AngleBetween_deg(const Vector3d& a, const Vector3d& b) {
  return std::asin(std::min(1.0, a.normalized().cross(b.normalized()).norm())) * 180 / M_PI;
}

TEST(LidarCameraOnePlane, NothingIsToldAcrossIt) {
  const VirtualLidarRig rig = NoisyRig();
  LidarCameraProblem problem = Recorded(rig, BoardsTurnedOnAFloor(), 10);
  for (const bool camera_is_a : {true, false}) {
    problem.camera_is_a = camera_is_a;
    const Edge edge = EstimateLidarCameraEdge(problem);
    ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses.front().what;
    EXPECT_TRUE(HasNote(edge, "normals_in_one_plane"));
    EXPECT_FALSE(HasNote(edge, "weak_normal_spread"));
    ASSERT_EQ(edge.uncertainty.rank, 5);
    const Vector6d untold = edge.uncertainty.unobservable_basis.col(0);
    const auto axis = [&](const char* name) { return edge.figures.at(std::string("axis_a_") + name + "_ratio"); };
    const Vector3d axis_a(axis("x"), axis("y"), axis("z"));
    EXPECT_LT(AngleBetween_deg(camera_is_a ? axis_a : Vector3d(rig.T_cam_lidar.R() * axis_a), Vector3d::UnitY()), 0.5);
    const Vector3d upright_b =
        camera_is_a ? Vector3d(rig.T_cam_lidar.R().transpose() * Vector3d::UnitY()) : Vector3d(Vector3d::UnitY());
    EXPECT_LT(AngleBetween_deg(untold.head<3>(), upright_b), 2.0);
    EXPECT_LT(untold.tail<3>().norm(), 0.02);  // radians per metre
  }
}

LidarCameraProblem DrawnOff(const VirtualLidarRig& rig, const std::vector<Se3>& boards, unsigned seed, double off_m) {
  LidarCameraProblem problem = Recorded(rig, boards, seed);
  problem.T_cam_lidar_nominal = rig.T_cam_lidar;
  problem.T_cam_lidar_nominal->p_m.y() += off_m;
  return problem;
}

// What the drawing says across the plane of the normals moves the answer along what the edge says that it does not
// know, and nowhere else: of boards that leave the plane by a little it would otherwise turn the lidar by sigmas.
TEST(LidarCameraOnePlane, ADrawingMovesOnlyWhatIsNotTold) {
  const VirtualLidarRig rig = NoisyRig();
  for (const double tilt_rad : {0.0, 0.02, 0.04}) {
    const std::vector<Se3> boards = BoardsTurnedOnAFloor(tilt_rad);
    const Edge low = EstimateLidarCameraEdge(DrawnOff(rig, boards, 11, -0.1));
    const Edge high = EstimateLidarCameraEdge(DrawnOff(rig, boards, 11, 0.1));
    ASSERT_EQ(low.state, EdgeState::kGood) << low.diagnoses.front().what;
    ASSERT_EQ(high.state, EdgeState::kGood) << high.diagnoses.front().what;
    ASSERT_EQ(low.uncertainty.rank, 5);
    const Vector6d moved = ErrorOf(low.T_a_b, high.T_a_b);
    RecordProperty("moved_mm_" + std::to_string(tilt_rad), std::to_string(1e3 * moved.norm()));
    EXPECT_GT(moved.norm(), 1e-4);
    EXPECT_LT(std::sqrt(moved.dot(low.uncertainty.Omega * moved)), 0.2) << tilt_rad;
  }
}

// Mean of the squared errors of what is claimed, in sigmas per number; of drawings that are 10 cm off.
double MeanSquareOfTold(double tilt_rad, int seeds, int rank) {
  const VirtualLidarRig rig = NoisyRig();
  double squares = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    const auto number = static_cast<unsigned>(900 + seed);
    const Edge edge = EstimateLidarCameraEdge(DrawnOff(rig, BoardsTurnedOnAFloor(tilt_rad), number, 0.1));
    if (edge.state != EdgeState::kGood || edge.uncertainty.rank != rank) return std::nan("");
    const Vector6d error = ErrorOf(edge.T_a_b, rig.T_cam_lidar);
    squares += error.dot(edge.uncertainty.Omega * error) / rank / seeds;
  }
  return squares;
}

TEST(LidarCameraOnePlane, WhatIsToldIsWithinItsSigma) {
  for (const auto& [tilt_rad, rank] : {std::pair(0.0, 5), {0.02, 5}, {0.05, 5}, {0.1, 6}}) {
    const double square = MeanSquareOfTold(tilt_rad, 24, rank);
    RecordProperty("mean_squared_ratio_" + std::to_string(tilt_rad), std::to_string(square));
    EXPECT_GT(square, 0.5) << tilt_rad;
    EXPECT_LT(square, 2.5) << tilt_rad;
  }
}

}  // namespace
}  // namespace rigcal::calib
