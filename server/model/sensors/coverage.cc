#include "server/model/sensors/coverage.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rigcal {
namespace {

constexpr int kColumns = 12, kRowsMax = 24;

void CountCorners(const CameraFit& fit, Coverage& coverage) {
  for (const ViewFit& view : fit.views)
    for (const Eigen::Vector2d& uv_px : view.uv_px) {
      if (!uv_px.allFinite()) continue;
      const int column = FieldOf(uv_px.x(), fit.width_px, coverage.columns);
      const int row = FieldOf(uv_px.y(), fit.height_px, coverage.rows);
      ++coverage.corners[static_cast<std::size_t>(row * coverage.columns + column)];
    }
}

void MeasureMargins(const CameraFit& fit, Coverage& coverage) {
  Eigen::AlignedBox2d seen;
  for (const ViewFit& view : fit.views)
    for (const Eigen::Vector2d& uv_px : view.uv_px)
      if (uv_px.allFinite()) seen.extend(uv_px);
  if (seen.isEmpty() || fit.width_px <= 0 || fit.height_px <= 0) return;
  const auto part = [](double margin_px, int size_px) { return std::clamp(margin_px / size_px, 0.0, 1.0); };
  coverage.margin_ratio = {
      part(seen.min().x() + 0.5, fit.width_px), part(fit.width_px - 0.5 - seen.max().x(), fit.width_px),
      part(seen.min().y() + 0.5, fit.height_px), part(fit.height_px - 0.5 - seen.max().y(), fit.height_px)};
}

}  // namespace

int RowsFor(const CameraFit& fit, int columns) {
  if (fit.width_px <= 0 || fit.height_px <= 0) return 1;
  return std::clamp(static_cast<int>(std::lround(double(columns) * fit.height_px / fit.width_px)), 1, kRowsMax);
}

int FieldOf(double at_px, int size_px, int fields) {
  const double part = (at_px + 0.5) / std::max(size_px, 1) * fields;
  return std::clamp(static_cast<int>(std::floor(std::clamp(part, 0.0, 1e6))), 0, fields - 1);
}

double MiddleOf(int field, int size_px, int fields) { return (field + 0.5) * size_px / std::max(fields, 1) - 0.5; }

Coverage CoverageOf(const CameraFit& fit) {
  Coverage coverage;
  coverage.columns = kColumns;
  coverage.rows = RowsFor(fit, kColumns);
  coverage.corners.assign(static_cast<std::size_t>(coverage.columns * coverage.rows), 0);
  CountCorners(fit, coverage);
  MeasureMargins(fit, coverage);
  const auto seen =
      std::count_if(coverage.corners.begin(), coverage.corners.end(), [](int count) { return count > 0; });
  coverage.share_ratio = static_cast<double>(seen) / static_cast<double>(coverage.corners.size());
  return coverage;
}

}  // namespace rigcal
