#include "server/report/cameras/camera_shape.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr int kMeanColumns = 8;             // of the fields whose mean residual is drawn
constexpr std::size_t kMeanCornersMin = 8;  // of such a field

template <typename Act>
void ForEachResidual(const CameraFit& fit, const Act& act) {
  for (const ViewFit& view : fit.views)
    for (std::size_t i = 0; i < view.residual_px.size(); ++i)
      if (view.residual_px[i].allFinite() && view.uv_px[i].allFinite()) act(view.uv_px[i], view.residual_px[i]);
}

std::size_t BinOf(double in_sigmas) {
  const double bin = std::floor((in_sigmas + kReach) / (2 * kReach) * kBins);
  return static_cast<std::size_t>(std::clamp(bin, 0.0, double(kBins - 1)));
}

std::string JoinedSides(const std::array<double, 4>& margin_ratio) {
  std::string text;
  for (std::size_t side = 0; side < kSidesOfPicture.size(); ++side)
    if (margin_ratio[side] > kEmptyMargin_ratio)
      text += (text.empty() ? "" : ", ") + std::string(kSidesOfPicture[side]) + " (" +
              Fixed(100 * margin_ratio[side], 0) + " %)";
  return text;
}

}  // namespace

ResidualShape ShapeOf(const CameraFit& fit) {
  ResidualShape shape;
  double sum_px2 = 0.0;
  ForEachResidual(fit, [&](const Eigen::Vector2d&, const Eigen::Vector2d& r) {
    shape.numbers += 2;
    sum_px2 += r.squaredNorm();
    shape.worst_px = std::max(shape.worst_px, r.norm());
  });
  shape.density.assign(kBins, 0.0);
  if (shape.numbers == 0) return shape;
  shape.sigma_px = std::sqrt(sum_px2 / static_cast<double>(shape.numbers));
  if (!(shape.sigma_px > 0)) return shape;
  const double weight = 1.0 / static_cast<double>(shape.numbers);
  ForEachResidual(fit, [&](const Eigen::Vector2d&, const Eigen::Vector2d& r) {
    for (const double value : r) {
      shape.density[BinOf(value / shape.sigma_px)] += weight * kBins / (2 * kReach);
      if (std::abs(value) > 3 * shape.sigma_px) shape.beyond_3_ratio += weight;
    }
  });
  return shape;
}

std::vector<FieldMean> MeansOf(const CameraFit& fit) {
  const int rows = RowsFor(fit, kMeanColumns);
  std::map<std::pair<int, int>, FieldMean> fields;
  ForEachResidual(fit, [&](const Eigen::Vector2d& uv_px, const Eigen::Vector2d& r) {
    const int column = FieldOf(uv_px.x(), fit.width_px, kMeanColumns), row = FieldOf(uv_px.y(), fit.height_px, rows);
    FieldMean& field =
        fields.try_emplace({row, column}, FieldMean{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), 0}).first->second;
    field.at_px += uv_px;
    field.mean_px += r;
    ++field.corners;
  });
  std::vector<FieldMean> means;
  for (auto& [place, field] : fields) {
    if (field.corners < kMeanCornersMin) continue;
    field.at_px /= static_cast<double>(field.corners);
    field.mean_px /= static_cast<double>(field.corners);
    means.push_back(field);
  }
  return means;
}

Stand StandOf(const CameraFit& fit) {
  Stand stand;
  for (const ViewFit& view : fit.views) {
    if (view.residual_px.empty()) continue;
    stand.nearest_m = stand.views == 0 ? view.distance_m : std::min(stand.nearest_m, view.distance_m);
    stand.farthest_m = std::max(stand.farthest_m, view.distance_m);
    stand.largest_tilt_rad = std::max(stand.largest_tilt_rad, view.tilt_rad.norm());
    ++stand.views;
  }
  return stand;
}

std::size_t CornersOf(const CameraFit& fit) {
  std::size_t corners = 0;
  for (const ViewFit& view : fit.views) corners += view.uv_px.size();
  return corners;
}

std::vector<CameraAdvice> AdviceOf(const CameraFit& fit) {
  std::vector<CameraAdvice> advice;
  const bool given = fit.source == IntrinsicsSource::kGiven;
  const std::string sides = JoinedSides(CoverageOf(fit).margin_ratio);
  if (!sides.empty() && !given)
    advice.push_back({"empty: " + sides, "No corner near these sides of the picture: " + sides +
                                             ". Lens distortion there is a guess: hold the board there, too."});
  const Stand stand = StandOf(fit);
  if (stand.views == 0 || given) return advice;
  const std::string tilt = Fixed(stand.largest_tilt_rad * kDegPerRad, 0) + " deg";
  if (stand.largest_tilt_rad < kFlatTilt_rad)
    advice.push_back({"tilt up to " + tilt, "No board was tilted by more than " + tilt +
                                                ": tilt it by 20 to 45 deg, each way, to pin the focal length."});
  if (stand.farthest_m < kSameDistance_ratio * stand.nearest_m)
    advice.push_back({"distances " + Significant(stand.nearest_m, 2) + " to " + Significant(stand.farthest_m, 2) + " m",
                      "All boards were at about one distance: vary it."});
  return advice;
}

}  // namespace rigcal::report
