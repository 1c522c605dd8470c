#include "server/cloud/point_files.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace rigcal::cloud {
namespace {

static_assert(std::endian::native == std::endian::little, "both files are little endian");

constexpr float kInt16Max = 32767;

template <typename T>
void Put(const T& value, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void PutColour(const ColouredCloud& cloud, std::size_t i, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(cloud.rgb[i].data()), 3);
  Put(cloud.camera_idx[i], bytes);
  Put(cloud.intensity[i], bytes);
}

struct Grid {
  std::uint32_t count = 0;
  Eigen::Vector3f origin_m = Eigen::Vector3f::Zero();
  float step_m = 1e-4F;
};

bool InReach(const Eigen::Vector3f& point_m) { return point_m.norm() <= kViewerReach_m; }

Grid GridOf(const ColouredCloud& cloud) {
  Grid grid;
  Eigen::Vector3f low = Eigen::Vector3f::Constant(kViewerReach_m), high = -low;
  for (const Eigen::Vector3f& point : cloud.points_m) {
    if (!InReach(point)) continue;
    ++grid.count;
    low = low.cwiseMin(point), high = high.cwiseMax(point);
  }
  if (grid.count == 0) return grid;
  grid.origin_m = 0.5F * (low + high);
  // A little more than half the size over the largest value, so that rounding stays within it.
  grid.step_m = std::max(grid.step_m, (high - low).maxCoeff() * 0.5F / (kInt16Max - 1));
  return grid;
}

std::int16_t Step(const Grid& grid, float value_m, int axis) {
  const float steps = std::round((value_m - grid.origin_m[axis]) / grid.step_m);
  return static_cast<std::int16_t>(std::clamp(steps, -kInt16Max, kInt16Max));
}

}  // namespace

std::string WritePly(const ColouredCloud& cloud) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment in the lidar's frame, metres; camera 255: covered by none\n"
      "element vertex " +
      std::to_string(cloud.points_m.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nproperty uchar camera\nproperty uchar intensity\nend_header\n";
  bytes.reserve(bytes.size() + 17 * cloud.points_m.size());
  for (std::size_t i = 0; i < cloud.points_m.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) Put(cloud.points_m[i][axis], bytes);
    PutColour(cloud, i, bytes);
  }
  return bytes;
}

std::string WriteViewerPoints(const ColouredCloud& cloud) {
  const Grid grid = GridOf(cloud);
  std::string bytes = "RCLD";
  bytes.reserve(28 + 12 * static_cast<std::size_t>(grid.count));
  Put(std::uint32_t{1}, bytes);
  Put(grid.count, bytes);
  for (int axis = 0; axis < 3; ++axis) Put(grid.origin_m[axis], bytes);
  Put(grid.step_m, bytes);
  for (std::size_t i = 0; i < cloud.points_m.size(); ++i) {
    if (!InReach(cloud.points_m[i])) continue;
    for (int axis = 0; axis < 3; ++axis) Put(Step(grid, cloud.points_m[i][axis], axis), bytes);
    PutColour(cloud, i, bytes);
    bytes.push_back(0);
  }
  return bytes;
}

}  // namespace rigcal::cloud
