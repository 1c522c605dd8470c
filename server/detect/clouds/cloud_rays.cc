#include "server/detect/clouds/cloud_rays.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace rigcal::detect {
namespace {

constexpr int kConeCells = 24;  // cells of the direction index along each axis of the cube around the unit sphere
constexpr int kAzimuths = 360;
constexpr std::uint64_t kVoxelBits = 21, kVoxelMask = (1ULL << kVoxelBits) - 1;

std::uint64_t Mixed(std::uint64_t value) {
  value += 0x9E3779B97F4A7C15ULL;
  value = (value ^ (value >> 30)) * 0xBF58476D1CE4E5B9ULL;
  value = (value ^ (value >> 27)) * 0x94D049BB133111EBULL;
  return value ^ (value >> 31);
}

bool IsUsable(const Eigen::Vector3f& point_m) {
  const float range_m = point_m.norm();  // not finite: neither comparison holds
  return range_m >= CloudRays::kRangeMin_m && range_m <= CloudRays::kRangeMax_m;
}

void Shuffle(std::vector<Eigen::Vector3f>& points) {
  for (std::size_t i = points.size(); i > 1; --i) std::swap(points[i - 1], points[Mixed(i) % i]);
}

std::vector<Eigen::Vector3f> Sample(const Cloud& cloud) {
  const std::uint64_t usable = std::count_if(cloud.points_m.begin(), cloud.points_m.end(), IsUsable);
  std::vector<Eigen::Vector3f> sample;
  sample.reserve(std::min<std::size_t>(usable, CloudRays::kRaysMax));
  for (std::size_t i = 0; i < cloud.points_m.size() && sample.size() < CloudRays::kRaysMax; ++i)
    if (IsUsable(cloud.points_m[i]) && (usable <= CloudRays::kRaysMax || Mixed(i) % usable < CloudRays::kRaysMax))
      sample.push_back(cloud.points_m[i]);
  Shuffle(sample);
  return sample;
}

int AzimuthOf(double x, double y) {
  return std::clamp(static_cast<int>((std::atan2(y, x) / M_PI + 1) * (kAzimuths / 2)), 0, kAzimuths - 1);
}

int ConeCell(float component) {
  return std::clamp(static_cast<int>((component + 1) * (kConeCells / 2)), 0, kConeCells - 1);
}

Eigen::Vector3i VoxelOf(const Eigen::Vector3f& point_m, double side_m) {
  return (point_m.cast<double>() / side_m).array().floor().cast<int>();
}

// z runs fastest, so that a column of voxels is one stretch of keys.
std::uint64_t VoxelKey(const Eigen::Vector3i& voxel) {
  std::uint64_t key = 0;
  for (const int axis : {0, 1, 2})
    key = (key << kVoxelBits) | (static_cast<std::uint64_t>(voxel[axis] + (1 << (kVoxelBits - 1))) & kVoxelMask);
  return key;
}

}  // namespace

CloudRays::CloudRays(const Cloud& cloud, double ball_m)
    : points_m(Sample(cloud)), ball_m_(std::max(ball_m, kRangeMax_m / 1e6)) {
  directions.reserve(points_m.size());
  for (const Eigen::Vector3f& point : points_m) directions.push_back(point.normalized());
  IndexField();
  IndexDirections();
  IndexVoxels();
}

void CloudRays::IndexField() {
  azimuths_.assign(kAzimuths, false);
  for (const Eigen::Vector3f& d : directions) {
    height_min_ = std::min(height_min_, d.z()), height_max_ = std::max(height_max_, d.z());
    const int azimuth = AzimuthOf(d.x(), d.y());
    for (int beside = -2; beside <= 2; ++beside)
      azimuths_[static_cast<std::size_t>((azimuth + beside + kAzimuths) % kAzimuths)] = true;
  }
}

bool CloudRays::Sees(const Eigen::Vector3d& direction) const {
  const Eigen::Vector3d d = direction.normalized();
  return d.z() >= height_min_ && d.z() <= height_max_ && azimuths_[static_cast<std::size_t>(AzimuthOf(d.x(), d.y()))];
}

void CloudRays::IndexDirections() {
  std::vector<std::uint32_t> cells(directions.size()), start(kConeCells * kConeCells * kConeCells + 1, 0);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const Eigen::Vector3f& d = directions[i];
    cells[i] =
        static_cast<std::uint32_t>((ConeCell(d.x()) * kConeCells + ConeCell(d.y())) * kConeCells + ConeCell(d.z()));
    ++start[cells[i] + 1];
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  for (int x = 0; x < kConeCells; ++x) {
    slab_start_.push_back(static_cast<std::uint32_t>(cone_middles_.size()));
    for (int rest = 0; rest < kConeCells * kConeCells; ++rest) {
      const auto cell = static_cast<std::size_t>(x * kConeCells * kConeCells + rest);
      if (start[cell] == start[cell + 1]) continue;
      const Eigen::Vector3f corner(static_cast<float>(x), static_cast<float>(rest / kConeCells),
                                   static_cast<float>(rest % kConeCells));
      cone_middles_.push_back((corner.array() + 0.5f) * (2.0f / kConeCells) - 1.0f);
      cone_start_.push_back(start[cell]);
    }
  }
  slab_start_.push_back(static_cast<std::uint32_t>(cone_middles_.size()));
  cone_start_.push_back(static_cast<std::uint32_t>(directions.size()));
  cone_members_.resize(directions.size());
  for (std::size_t i = 0; i < directions.size(); ++i) cone_members_[start[cells[i]]++] = static_cast<std::uint32_t>(i);
}

void CloudRays::IndexVoxels() {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed(points_m.size());
  for (std::size_t i = 0; i < points_m.size(); ++i)
    keyed[i] = {VoxelKey(VoxelOf(points_m[i], ball_m_)), static_cast<std::uint32_t>(i)};
  std::sort(keyed.begin(), keyed.end());
  voxel_members_.reserve(keyed.size());
  for (const auto& [key, index] : keyed) {
    if (voxel_keys_.empty() || voxel_keys_.back() != key) {
      voxel_keys_.push_back(key);
      voxel_start_.push_back(static_cast<std::uint32_t>(voxel_members_.size()));
    }
    voxel_members_.push_back(index);
  }
  voxel_start_.push_back(static_cast<std::uint32_t>(voxel_members_.size()));
}

void CloudRays::InBall(const Eigen::Vector3f& centre_m, std::size_t budget, std::vector<std::uint32_t>& found) const {
  found.clear();
  std::vector<std::pair<std::uint32_t, std::uint32_t>> stretches;
  std::size_t members = 0;
  const Eigen::Vector3i centre = VoxelOf(centre_m, ball_m_);
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y) {
      const std::uint64_t first = VoxelKey(centre + Eigen::Vector3i(x, y, -1));
      const auto low = std::lower_bound(voxel_keys_.begin(), voxel_keys_.end(), first);
      for (auto at = low; at != voxel_keys_.end() && *at <= first + 2; ++at) {
        const auto voxel = static_cast<std::size_t>(at - voxel_keys_.begin());
        stretches.emplace_back(voxel_start_[voxel], voxel_start_[voxel + 1]);
        members += voxel_start_[voxel + 1] - voxel_start_[voxel];
      }
    }
  // A ball holds about a third of what lies in flat surroundings of its voxels.
  const auto limit =
      static_cast<double>(points_m.size()) * 3.0 * static_cast<double>(budget) / std::max<double>(1, members);
  const auto squared_m2 = static_cast<float>(ball_m_ * ball_m_);
  for (const auto& [start, end] : stretches)
    for (std::uint32_t i = start; i < end && voxel_members_[i] < limit; ++i)
      if ((points_m[voxel_members_[i]] - centre_m).squaredNorm() <= squared_m2) found.push_back(voxel_members_[i]);
}

void CloudRays::InCone(const Eigen::Vector3f& axis, double angle_rad, std::size_t budget,
                       std::vector<std::uint32_t>& found) const {
  found.clear();
  const auto chord = static_cast<float>(2 * std::sin(std::min(angle_rad, M_PI) / 2));
  const auto cosine = static_cast<float>(std::cos(std::min(angle_rad, M_PI)));
  const float reach = chord + std::sqrt(3.0f) / kConeCells;
  const std::uint32_t first = slab_start_[static_cast<std::size_t>(ConeCell(axis.x() - chord))];
  const std::uint32_t last = slab_start_[static_cast<std::size_t>(ConeCell(axis.x() + chord)) + 1];
  std::vector<std::uint32_t> cells;
  std::size_t members = 0;
  for (std::uint32_t cell = first; cell < last; ++cell) {
    if ((cone_middles_[cell] - axis).squaredNorm() > reach * reach) continue;
    cells.push_back(cell);
    members += cone_start_[cell + 1] - cone_start_[cell];
  }
  // The cells reach beyond the cone: about as much of them lies in it as of the circles that hold both.
  const double wanted = static_cast<double>(budget) * std::min(8.0, std::pow(reach / std::max(chord, 1e-3f), 2));
  const double limit =
      static_cast<double>(points_m.size()) * wanted / std::max<double>(1, static_cast<double>(members));
  for (const std::uint32_t cell : cells)
    for (std::uint32_t i = cone_start_[cell]; i < cone_start_[cell + 1] && cone_members_[i] < limit; ++i)
      if (directions[cone_members_[i]].dot(axis) >= cosine) found.push_back(cone_members_[i]);
}

}  // namespace rigcal::detect
