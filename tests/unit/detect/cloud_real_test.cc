#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cstdio>
#include <ctime>

#include "server/detect/clouds/cloud_board.h"
#include "tests/unit/ascii_pcd.h"
#include "tests/unit/recordings.h"

namespace rigcal::detect {
namespace {

constexpr const char* kClouds = "lidarcam_acfr_vlp16/pcd";

Target Board() {
  Target board{TargetId("board"), 7, 5, 0.095, 0.0, ""};
  board.plate_m = Eigen::Vector2d(0.85, 0.61);
  return board;
}

// The plane through the points that somebody else cut out: independent of the search.
struct Reference {
  Eigen::Vector3d centroid_m, normal;
};

Reference ReferenceOf(const Cloud& cloud) {
  Eigen::MatrixX3d points(cloud.points_m.size(), 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) points.row(i) = cloud.points_m[i].cast<double>();
  const Eigen::Vector3d mean = points.colwise().mean();
  points.rowwise() -= mean.transpose();
  return {mean, Eigen::JacobiSVD<Eigen::MatrixX3d>(points, Eigen::ComputeThinV).matrixV().col(2)};
}

struct Comparison {
  double angle_deg, offset_m, beside_m;
};

Comparison Compare(const PlanePatch& patch, const Reference& truth) {
  const double cosine = std::min(1.0, std::abs(patch.normal.dot(truth.normal)));
  const Eigen::Vector3d between = truth.centroid_m - patch.centre_m;
  const double offset_m = patch.normal.dot(between);
  return {std::acos(cosine) * 180 / M_PI, offset_m, (between - offset_m * patch.normal).norm()};
}

struct Pose {
  std::string name;
  std::size_t rank = 0;  // 0: the plate is not among the candidates
  Comparison off = {};
};

// The candidate that lies on the reference, if there is one; a row of the measuring table is printed.
Pose Judge(const std::filesystem::path& folder, const std::string& name) {
  const Cloud cloud = AsciiPcd(folder / (name + "_full.pcd"));
  const Reference truth = ReferenceOf(AsciiPcd(folder / (name + "_target.pcd")));
  const std::clock_t start = std::clock();
  const CloudView view = DetectPlate(cloud, Board()).view;
  const double cpu_ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  for (std::size_t i = 0; i < view.candidates.size(); ++i) {
    const PlanePatch& patch = view.candidates[i];
    const Comparison off = Compare(patch, truth);
    if (off.beside_m > 0.15 || std::abs(off.offset_m) > 0.05) continue;
    std::printf(
        "%-7s rank %zu of %zu  %.2f deg  %5.1f mm  beside %3.0f mm  %4zu points  rms %.1f mm  score %.2f  %.0f ms\n",
        name.c_str(), i + 1, view.candidates.size(), off.angle_deg, off.offset_m * 1e3, off.beside_m * 1e3,
        patch.points_m.size(), patch.rms_m * 1e3, patch.score, cpu_ms);
    return {name, i + 1, off};
  }
  std::printf("%-7s not among %zu candidates  %.0f ms\n", name.c_str(), view.candidates.size(), cpu_ms);
  return {name};
}

TEST(DetectCloudReal, FindsThePlateInEveryPose) {
  RIGCAL_SKIP_WITHOUT_RECORDING(kClouds);
  const auto folder = Recording(kClouds);
  int first = 0;
  for (int number = 1; number <= 39; number += 2) {
    const Pose pose = Judge(folder, "pose" + std::to_string(number));
    EXPECT_GT(pose.rank, 0u) << pose.name;
    EXPECT_LT(pose.off.angle_deg, 2) << pose.name;
    EXPECT_LT(std::abs(pose.off.offset_m), 0.02) << pose.name;
    EXPECT_LT(pose.off.beside_m, 0.1) << pose.name;
    first += pose.rank == 1;
  }
  EXPECT_GE(first, 18);
}

// Every point of the patch is one of those that somebody else cut out; of those it lacks only the ones at the edges.
TEST(DetectCloudReal, GivesThePointsOfThePlateAndNoOthers) {
  RIGCAL_SKIP_WITHOUT_RECORDING(kClouds);
  const auto folder = Recording(kClouds);
  std::size_t given = 0, right = 0, all = 0;
  for (int number = 1; number <= 39; number += 2) {
    const std::string name = "pose" + std::to_string(number);
    const Cloud target = AsciiPcd(folder / (name + "_target.pcd"));
    all += target.points_m.size();
    for (const PlanePatch& patch : DetectPlate(AsciiPcd(folder / (name + "_full.pcd")), Board()).view.candidates) {
      if (Compare(patch, ReferenceOf(target)).beside_m > 0.15) continue;
      if (std::abs(Compare(patch, ReferenceOf(target)).offset_m) > 0.05) continue;
      given += patch.points_m.size();
      for (const Eigen::Vector3f& point : patch.points_m)
        right += std::any_of(target.points_m.begin(), target.points_m.end(),
                             [&](const Eigen::Vector3f& other) { return (point - other).norm() < 1e-4f; });
    }
  }
  std::printf("given %zu points, of them on the plate %zu; the plate has %zu\n", given, right, all);
  EXPECT_GE(static_cast<double>(right), 0.995 * static_cast<double>(given));
  EXPECT_GT(static_cast<double>(right), 0.8 * static_cast<double>(all));
}

}  // namespace
}  // namespace rigcal::detect
