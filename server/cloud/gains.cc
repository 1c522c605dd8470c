#include "server/cloud/gains.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "server/base/process/parallel_for.h"

namespace rigcal::cloud {
namespace {

constexpr int kDarkest = 12, kBrightest = 243;  // of a well exposed colour
constexpr int kPerOctave = 256;
constexpr int kBinMax = 5 * kPerOctave;  // log2(243 / 12) = 4.3
constexpr std::int64_t kCommonMin = 50;  // points, before a pair says anything
constexpr double kTrusted = 200;         // points at which a pair has half its full say
constexpr double kHold = 1e-3;           // pulls to gain 1: fixes the common factor, hardly anything else
constexpr double kLogMax = 2;            // octaves

using Histogram = std::array<std::int32_t, 2 * kBinMax + 1>;

// log2 of a colour in whole bins.
const std::array<std::int32_t, 256>& LogTable() {
  static const auto table = [] {
    std::array<std::int32_t, 256> values{};
    for (std::size_t i = 1; i < 256; ++i)
      values[i] = static_cast<std::int32_t>(std::lround(kPerOctave * std::log2(static_cast<double>(i))));
    return values;
  }();
  return table;
}

bool WellExposed(const Rgb& rgb) {
  return std::all_of(rgb.begin(), rgb.end(), [](int c) { return c >= kDarkest && c <= kBrightest; });
}

struct Pair {
  std::size_t a = 0, b = 0;
  std::int64_t common = 0;
  std::array<double, 3> log2_ratio{};  // b over a, medians
};

double MedianOf(const Histogram& histogram, std::int64_t total) {
  std::int64_t below = 0;
  for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
    if (2 * (below + histogram[bin]) >= total)
      return (static_cast<double>(bin) - kBinMax - 0.5 +
              (0.5 * static_cast<double>(total) - static_cast<double>(below)) / histogram[bin]) /
             kPerOctave;
    below += histogram[bin];
  }
  return 0;
}

void CountCommon(const std::vector<SeenPoint>& a, const std::vector<SeenPoint>& b, std::array<Histogram, 3>& histograms,
                 std::int64_t& common) {
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    if (a[i].point_idx != b[j].point_idx) {
      a[i].point_idx < b[j].point_idx ? ++i : ++j;
      continue;
    }
    if (WellExposed(a[i].rgb) && WellExposed(b[j].rgb)) {
      ++common;
      for (std::size_t c = 0; c < 3; ++c)
        ++histograms[c][static_cast<std::size_t>(LogTable()[b[j].rgb[c]] - LogTable()[a[i].rgb[c]] + kBinMax)];
    }
    ++i, ++j;
  }
}

void Compare(std::span<const CameraView> views, Pair& pair) {
  std::array<Histogram, 3> histograms{};
  const CameraView &a = views[pair.a], &b = views[pair.b];
  for (std::size_t part = 0; part < std::min(a.parts.size(), b.parts.size()); ++part)
    CountCommon(a.parts[part], b.parts[part], histograms, pair.common);
  if (pair.common < kCommonMin) return;
  for (std::size_t c = 0; c < 3; ++c) pair.log2_ratio[c] = MedianOf(histograms[c], pair.common);
}

// Minimises sum w (g_b - g_a + ratio)^2 + hold sum g^2.
Eigen::VectorXd SolveLogs(const std::vector<Pair>& pairs, std::size_t cameras, std::size_t colour) {
  const auto size = static_cast<Eigen::Index>(cameras);
  Eigen::MatrixXd H = kHold * Eigen::MatrixXd::Identity(size, size);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(size);
  for (const Pair& pair : pairs) {
    if (pair.common < kCommonMin) continue;
    const auto common = static_cast<double>(pair.common);
    const double weight = common / (common + kTrusted);
    const auto i = static_cast<Eigen::Index>(pair.a), j = static_cast<Eigen::Index>(pair.b);
    H(i, i) += weight, H(j, j) += weight, H(i, j) -= weight, H(j, i) -= weight;
    b(i) += weight * pair.log2_ratio[colour], b(j) -= weight * pair.log2_ratio[colour];
  }
  return H.ldlt().solve(b);
}

}  // namespace

std::vector<Gain> BalancedGains(std::span<const CameraView> views) {
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < views.size(); ++a)
    for (std::size_t b = a + 1; b < views.size(); ++b) pairs.push_back({a, b, 0, {}});
  ParallelFor(pairs.size(), [&](std::size_t i) { Compare(views, pairs[i]); });
  std::vector<Gain> gains(views.size(), Gain{1, 1, 1});
  for (std::size_t colour = 0; colour < 3; ++colour) {
    const Eigen::VectorXd logs = SolveLogs(pairs, views.size(), colour);
    for (std::size_t i = 0; i < views.size(); ++i)
      gains[i][colour] =
          static_cast<float>(std::exp2(std::clamp(logs(static_cast<Eigen::Index>(i)), -kLogMax, kLogMax)));
  }
  return gains;
}

}  // namespace rigcal::cloud
