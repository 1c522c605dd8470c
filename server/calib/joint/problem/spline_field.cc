#include "server/calib/joint/problem/spline_field.h"

#include <algorithm>
#include <cmath>

namespace rigcal::calib::joint {
namespace {

// The three splines that are not zero in a cell, at `t` of it.
Eigen::Vector3d Quadratic(double t) { return {0.5 * (1 - t) * (1 - t), 0.5 + t * (1 - t), 0.5 * t * t}; }

struct CellPlace {
  int cell;
  double t;
};
CellPlace PlaceOf(double at_px, double cell_px, int cells) {
  const double at = std::clamp(at_px / cell_px, 0.0, static_cast<double>(cells));
  const int cell = std::min(static_cast<int>(at), cells - 1);
  return {cell, at - cell};
}

}  // namespace

FieldGrid FieldGridOf(const PictureSize& picture) {
  if (picture.empty()) return {};
  const double cell_px = static_cast<double>(std::max(picture.width_px, picture.height_px)) / kFieldCells;
  const auto points = [&](int size_px) { return static_cast<int>(std::ceil(size_px / cell_px - 1e-9)) + 2; };
  return {points(picture.width_px), points(picture.height_px), cell_px, picture};
}

FieldWeights FieldWeightsAt(const FieldGrid& grid, const Eigen::Vector2d& uv_px) {
  // Pixel (0, 0) is the centre of the first one: the picture begins half a pixel before.
  const CellPlace u =
      PlaceOf(std::clamp(uv_px.x() + 0.5, 0.0, 1.0 * grid.picture.width_px), grid.cell_px, grid.columns - 2);
  const CellPlace v =
      PlaceOf(std::clamp(uv_px.y() + 0.5, 0.0, 1.0 * grid.picture.height_px), grid.cell_px, grid.rows - 2);
  const Eigen::Vector3d along_u = Quadratic(u.t), along_v = Quadratic(v.t);
  FieldWeights weights;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(3 * j + i);
      weights.point[k] = (v.cell + j) * grid.columns + u.cell + i;
      weights.weight[k] = along_v[j] * along_u[i];
    }
  return weights;
}

Eigen::Vector2d FieldAt(const FieldGrid& grid, const Eigen::VectorXd& coefficients_px, const Eigen::Vector2d& uv_px) {
  const FieldWeights weights = FieldWeightsAt(grid, uv_px);
  Eigen::Vector2d field_px = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < weights.point.size(); ++k)
    field_px += weights.weight[k] *
                Eigen::Vector2d(coefficients_px[weights.point[k]], coefficients_px[grid.points() + weights.point[k]]);
  return field_px;
}

}  // namespace rigcal::calib::joint
