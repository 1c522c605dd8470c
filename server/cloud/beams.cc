#include "server/cloud/beams.h"

#include <algorithm>
#include <cmath>

#include "server/base/limits.h"
#include "server/base/process/parallel_for.h"

namespace rigcal::cloud {
namespace {

constexpr std::size_t kColumns = 128;  // stretches of azimuth that are looked at
constexpr std::size_t kChunk = 16384;
constexpr float kSteepest_rad = 1.05F;  // near the poles a stretch of azimuth has no width
constexpr double kHole_rad = 0.09;      // wider gaps are directions without a return, no spacing
constexpr float kStepMin_rad = 2e-4F, kStepMax_rad = 0.06F;

const std::vector<double>* IntensityOf(const Cloud& cloud) {
  for (const char* name : {"intensity", "reflectivity", "i"})
    for (const CloudField& field : cloud.fields)
      if (field.name == name && field.values.size() == cloud.points_m.size()) return &field.values;
  return nullptr;
}

// What becomes white.
double Brightest(std::vector<double> values) {
  if (values.empty()) return 1;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * 99 / 100);
  std::nth_element(values.begin(), at, values.end());
  return std::isfinite(*at) && *at > 0 ? *at : 1;
}

void TakePoints(const Cloud& cloud, Beams& beams) {
  const std::size_t count = cloud.points_m.size();
  beams.stride = std::max<std::size_t>(1, (count + limits::kColouredPointsMax - 1) / limits::kColouredPointsMax);
  const std::vector<double>* intensity = IntensityOf(cloud);
  const double scale = intensity ? 255 / Brightest(*intensity) : 0;
  beams.points_m.reserve(count / beams.stride + 1), beams.intensity.reserve(count / beams.stride + 1);
  for (std::size_t i = 0; i < count; i += beams.stride) {
    if (!cloud.points_m[i].allFinite()) continue;
    const double value = intensity ? scale * (*intensity)[i] : 0;
    beams.points_m.push_back(cloud.points_m[i]);
    beams.intensity.push_back(value > 0 ? static_cast<std::uint8_t>(std::min(value, 255.0)) : 0);
  }
}

using Columns = std::vector<std::vector<float>>;  // elevations, radians

// The column that a point lies in, or kColumns: between two of them. Along a square instead of a circle, which needs no
// arc tangent; the columns' widths then differ by a factor of 2 at most, and their mean is what counts.
std::size_t ColumnOf(const Eigen::Vector3f& point, float width_rad) {
  constexpr float kAround = 4, kPitch = kAround / kColumns;
  const float share = point.y() / (std::abs(point.x()) + std::abs(point.y()));
  const float along = point.x() < 0 ? 2 - share : share < 0 ? kAround + share : share;
  if (!(along >= 0 && along < kAround)) return kColumns;
  const auto column = static_cast<std::size_t>(along / kPitch);
  const float width = width_rad * kAround / (2 * static_cast<float>(M_PI));
  return along - static_cast<float>(column) * kPitch < width ? column : kColumns;
}

Columns ColumnsOf(const std::vector<Eigen::Vector3f>& points, float width_rad) {
  std::vector<Columns> parts((points.size() + kChunk - 1) / kChunk);
  ParallelFor(parts.size(), [&](std::size_t part) {
    parts[part].resize(kColumns);
    const std::size_t end = std::min(points.size(), (part + 1) * kChunk);
    for (std::size_t i = part * kChunk; i < end; ++i) {
      const std::size_t column = ColumnOf(points[i], width_rad);
      if (column == kColumns) continue;
      const float elevation = std::atan2(points[i].z(), points[i].head<2>().norm());
      if (std::abs(elevation) < kSteepest_rad) parts[part][column].push_back(elevation);
    }
  });
  Columns columns(kColumns);
  for (const Columns& part : parts)
    for (std::size_t c = 0; c < kColumns; ++c) columns[c].insert(columns[c].end(), part[c].begin(), part[c].end());
  return columns;
}

int HeightOf(float elevation_rad) {
  return std::clamp(static_cast<int>((std::sin(elevation_rad) + 1) * (0.5F * Beams::kHeights)), 0, Beams::kHeights - 1);
}

// By height, the gaps that lie over it: a long gap counts where it is long, many equal elevations of one ring count
// nowhere.
struct Gaps {
  std::vector<std::vector<float>> over = std::vector<std::vector<float>>(Beams::kHeights);
  double total_rad = 0;
};

Gaps GapsOf(Columns& columns) {
  Gaps gaps;
  for (std::vector<float>& column : columns) {
    std::sort(column.begin(), column.end());
    for (std::size_t i = 1; i < column.size(); ++i) {
      const float gap = column[i] - column[i - 1];
      if (!(gap > 0) || gap > kHole_rad) continue;
      gaps.total_rad += gap;
      const int last = HeightOf(column[i]);
      for (int h = HeightOf(column[i - 1]); h < last; ++h) gaps.over[static_cast<std::size_t>(h)].push_back(gap);
    }
  }
  return gaps;
}

float MedianOf(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

float Bounded(double step_rad) { return std::clamp(static_cast<float>(step_rad), kStepMin_rad, kStepMax_rad); }

// Heights without a gap over them take the median of all.
void SetStepsUp(Gaps& gaps, Beams& beams) {
  constexpr std::size_t kSays = 3;
  std::vector<float> known;
  for (std::size_t h = 0; h < Beams::kHeights; ++h) {
    const bool says = gaps.over[h].size() >= kSays;
    beams.steps_up_rad[h] = says ? Bounded(MedianOf(gaps.over[h])) : 0;
    if (says) known.push_back(beams.steps_up_rad[h]);
  }
  if (known.empty()) known = {kStepMin_rad};
  beams.elevation_step_rad = MedianOf(known);
  for (float& step : beams.steps_up_rad)
    if (step == 0) step = beams.elevation_step_rad;
}

// Up: from the gaps in narrow stretches of azimuth. Across: what the density leaves.
void FindSteps(Beams& beams) {
  if (beams.points_m.size() < 2) return;
  const double width_rad = std::min(std::sqrt(4 * M_PI / static_cast<double>(beams.points_m.size())), 0.045);
  Columns columns = ColumnsOf(beams.points_m, static_cast<float>(width_rad));
  Gaps gaps = GapsOf(columns);
  if (!(gaps.total_rad > 0)) return;
  SetStepsUp(gaps, beams);
  double heights_rad = 0;  // of all patches, one upon another
  for (const std::vector<float>& column : columns)
    for (const float elevation : column) heights_rad += beams.StepUp_rad(std::sin(elevation));
  beams.azimuth_step_rad = Bounded(width_rad * gaps.total_rad / heights_rad);
}

}  // namespace

Beams BeamsOf(const Cloud& cloud) {
  Beams beams;
  TakePoints(cloud, beams);
  FindSteps(beams);
  beams.facing = Facing(beams.points_m, beams.azimuth_step_rad, beams.elevation_step_rad,
                        [&beams](float sine) { return beams.StepUp_rad(sine); });
  return beams;
}

}  // namespace rigcal::cloud
