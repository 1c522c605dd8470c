#include "server/report/cameras/camera_views.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "server/report/cameras/camera_drawing.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kViewsMax = 3;
constexpr double kAspect = 4.0 / 3.0;  // of what is cut out

double RmsOf(const ViewFit& view) {
  double sum_px2 = 0.0;
  for (const Eigen::Vector2d& residual_px : view.residual_px) sum_px2 += residual_px.squaredNorm();
  return view.residual_px.empty() ? 0.0 : std::sqrt(sum_px2 / static_cast<double>(view.residual_px.size()));
}

const Evidence* PictureOf(const Edge& edge, const SensorId& camera, const CaptureId& capture,
                          const std::set<Digest>& stored) {
  const auto found = std::find_if(edge.evidence.begin(), edge.evidence.end(), [&](const Evidence& one) {
    return one.sensor == camera && one.capture == capture && (one.suffix == "jpg" || one.suffix == "png") &&
           stored.contains(one.digest);
  });
  return found == edge.evidence.end() ? nullptr : &*found;
}

bool CanBeDrawn(const ViewFit& view) {
  const auto finite = [](const Eigen::Vector2d& p) { return p.allFinite(); };
  return !view.residual_px.empty() && view.residual_px.size() == view.uv_px.size() &&
         std::all_of(view.uv_px.begin(), view.uv_px.end(), finite) &&
         std::all_of(view.residual_px.begin(), view.residual_px.end(), finite);
}

// The board with some room around it, as far as the picture goes.
Eigen::AlignedBox2d CropOf(const CameraFit& fit, const ViewFit& view) {
  constexpr double kRoom_ratio = 0.62, kLeast_px = 24.0;  // half of the size, from the middle
  Eigen::AlignedBox2d board;
  for (const Eigen::Vector2d& uv_px : view.uv_px) board.extend(uv_px);
  const double width_px = kRoom_ratio * std::max({board.sizes().x(), board.sizes().y() * kAspect, kLeast_px});
  const Eigen::Vector2d half(width_px, width_px / kAspect), middle = board.center();
  const Eigen::AlignedBox2d picture(Eigen::Vector2d(0, 0), Eigen::Vector2d(fit.width_px, fit.height_px));
  return Eigen::AlignedBox2d(middle - half, middle + half).intersection(picture);
}

std::string Point(const Eigen::Vector2d& p) { return Fixed(p.x(), 1) + " " + Fixed(p.y(), 1); }

// Pixel 0 reaches from 0 to 1 in the drawing.
void FillPaths(Dictionary& figure, const ViewFit& view, double magnified) {
  std::string seen, shifts;
  for (std::size_t i = 0; i < view.uv_px.size(); ++i) {
    const Eigen::Vector2d at = view.uv_px[i] + Eigen::Vector2d(0.5, 0.5);
    seen += "M" + Point(at) + "h0";
    shifts += "M" + Point(at) + "l" + Point(-magnified * view.residual_px[i]);
  }
  figure.SetValue("SEEN", seen);
  figure.SetValue("SHIFTS", shifts);
}

void FillView(Dictionary& figure, const CameraFit& fit, const ViewFit& view, const Evidence& picture) {
  constexpr double kUsualLength_ratio = 0.03, kMagnifiedMax = 10'000.0;  // of a residual of one rms, of the width
  const Eigen::AlignedBox2d crop = CropOf(fit, view);
  const double rms_px = RmsOf(view);
  const double magnified =
      rms_px > 0 ? std::clamp(NiceBelow(kUsualLength_ratio * crop.sizes().x() / rms_px), 1.0, kMagnifiedMax) : 1.0;
  figure.SetValue("FILE", picture.digest.str() + "." + picture.suffix);
  figure.SetValue("WIDTH", std::to_string(fit.width_px));
  figure.SetValue("HEIGHT", std::to_string(fit.height_px));
  figure.SetValue("CROP", Point(crop.min()) + " " + Point(crop.sizes()));
  figure.SetValue("CAPTURE", view.capture.str());
  figure.SetValue("RMS", Significant(rms_px, 3));
  figure.SetValue("MAGNIFIED", Fixed(magnified, 0));
  FillPaths(figure, view, magnified);
}

}  // namespace

void FillWorstViews(Dictionary& section, const CameraFit& fit, const Edge& edge, const std::set<Digest>& stored) {
  if (fit.width_px <= 0 || fit.height_px <= 0) return;
  std::vector<std::pair<const ViewFit*, const Evidence*>> views;
  for (const ViewFit& view : fit.views)
    if (const Evidence* picture = PictureOf(edge, fit.camera, view.capture, stored);
        picture != nullptr && CanBeDrawn(view) && !CropOf(fit, view).isEmpty())
      views.emplace_back(&view, picture);
  if (views.empty()) return;
  std::stable_sort(views.begin(), views.end(),
                   [](const auto& a, const auto& b) { return RmsOf(*a.first) > RmsOf(*b.first); });
  Dictionary* worst = section.AddSectionDictionary("WORST_VIEWS");
  for (std::size_t i = 0; i < std::min(views.size(), kViewsMax); ++i)
    FillView(*worst->AddSectionDictionary("VIEW"), fit, *views[i].first, *views[i].second);
}

}  // namespace rigcal::report
