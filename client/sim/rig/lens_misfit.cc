#include "client/sim/rig/lens_misfit.h"

#include <cmath>

#include "client/sim/rig/random.h"

namespace rigcal::sim {
namespace {

constexpr int kWaves = 3;
constexpr double kWavesMin = 1.5, kWavesMax = 3.0;
constexpr int kSamples = 48;  // per side of the picture, for its rms
constexpr int kStraightenings = 8;

double SumOf(const std::vector<Wave>& waves, const Eigen::Vector2d& uv_px) {
  double sum_px = 0;
  for (const Wave& wave : waves)
    sum_px += wave.amplitude_px * std::sin(2 * M_PI * wave.cycles_per_px.dot(uv_px) + wave.phase_rad);
  return sum_px;
}

double RmsOf(const std::vector<Wave>& waves, const Eigen::Vector2d& size_px) {
  double sum = 0;
  for (int y = 0; y < kSamples; ++y)
    for (int x = 0; x < kSamples; ++x)
      sum += std::pow(SumOf(waves, size_px.cwiseProduct(Eigen::Vector2d(x + 0.5, y + 0.5)) / kSamples), 2);
  return std::sqrt(sum) / kSamples;
}

std::vector<Wave> DrawWaves(double rms_px, const Eigen::Vector2d& size_px, Random& random) {
  std::vector<Wave> waves;
  for (int i = 0; i < kWaves; ++i) {
    const double count = random.Uniform(kWavesMin, kWavesMax), angle = random.Uniform(0, 2 * M_PI);
    const Eigen::Vector2d across(std::cos(angle), std::sin(angle));
    waves.push_back({count * across.cwiseQuotient(size_px), random.Uniform(0, 2 * M_PI), random.Uniform(0.5, 1)});
  }
  const double factor = rms_px / RmsOf(waves, size_px);
  for (Wave& wave : waves) wave.amplitude_px *= factor;
  return waves;
}

}  // namespace

Eigen::Vector2d LensMisfit::At(const Eigen::Vector2d& uv_px) const {
  return {SumOf(along_u, uv_px), SumOf(along_v, uv_px)};
}

// The field is far smoother than it is large: a fixed point reaches it.
Eigen::Vector2d LensMisfit::Straightened(const Eigen::Vector2d& uv_px) const {
  Eigen::Vector2d straight_px = uv_px;
  for (int i = 0; i < kStraightenings && !empty(); ++i) straight_px = uv_px - At(straight_px);
  return straight_px;
}

LensMisfit DrawLensMisfit(double rms_px, int width_px, int height_px, std::uint64_t key) {
  if (rms_px == 0) return {};
  Random random(key);
  const Eigen::Vector2d size_px(width_px, height_px);
  LensMisfit misfit;
  misfit.along_u = DrawWaves(rms_px, size_px, random);
  misfit.along_v = DrawWaves(rms_px, size_px, random);
  return misfit;
}

}  // namespace rigcal::sim
