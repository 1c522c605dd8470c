#include "server/cloud/blend.h"

#include <algorithm>
#include <numeric>

#include "server/base/process/parallel_for.h"

namespace rigcal::cloud {
namespace {

struct Mix {
  Eigen::Vector3f colour = Eigen::Vector3f::Zero();
  float weight = 0, heaviest = 0;
  std::uint8_t camera_idx = kNoCamera;
};

void AddView(const std::vector<SeenPoint>& seen, const Gain& gain, std::uint8_t camera_idx, std::size_t first,
             std::vector<Mix>& mixes) {
  for (const SeenPoint& point : seen) {
    Mix& mix = mixes[point.point_idx - first];
    for (int c = 0; c < 3; ++c) {
      const auto i = static_cast<std::size_t>(c);
      mix.colour[c] += point.weight * gain[i] * static_cast<float>(point.rgb[i]);
    }
    mix.weight += point.weight;
    if (point.weight > mix.heaviest) mix.heaviest = point.weight, mix.camera_idx = camera_idx;
  }
}

Rgb ColourOf(const Mix& mix) {
  Rgb rgb;
  for (int c = 0; c < 3; ++c)
    rgb[static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(std::min(mix.colour[c] / mix.weight + 0.5F, 255.0F));
  return rgb;
}

std::size_t MixPart(std::span<const CameraView> views, std::size_t part, ColouredCloud& cloud) {
  const std::size_t first = part * CameraView::kPart, end = std::min(cloud.rgb.size(), first + CameraView::kPart);
  std::vector<Mix> mixes(end - first);
  for (std::size_t i = 0; i < views.size(); ++i)
    AddView(views[i].parts[part], cloud.gains[i], static_cast<std::uint8_t>(i), first, mixes);
  std::size_t covered = 0;
  for (std::size_t i = first; i < end; ++i) {
    const Mix& mix = mixes[i - first];
    if (!(mix.weight > 0)) continue;
    cloud.rgb[i] = ColourOf(mix), cloud.camera_idx[i] = mix.camera_idx;
    ++covered;
  }
  return covered;
}

}  // namespace

ColouredCloud Blend(Beams beams, std::span<const CameraView> views) {
  ColouredCloud cloud;
  cloud.gains = BalancedGains(views);
  cloud.step_rad = beams.MeanStep_rad();
  cloud.facing = std::move(beams.facing);
  cloud.points_m = std::move(beams.points_m);
  cloud.intensity = std::move(beams.intensity);
  cloud.rgb.assign(cloud.points_m.size(), kUncovered);
  cloud.camera_idx.assign(cloud.points_m.size(), kNoCamera);
  std::vector<std::size_t> covered((cloud.points_m.size() + CameraView::kPart - 1) / CameraView::kPart, 0);
  ParallelFor(covered.size(), [&](std::size_t part) { covered[part] = MixPart(views, part, cloud); });
  cloud.covered = std::accumulate(covered.begin(), covered.end(), std::size_t{0});
  return cloud;
}

}  // namespace rigcal::cloud
