#include "server/detect/circles/circle_edge.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace rigcal::detect {
namespace {

constexpr int kRays = 64;
constexpr int kRounds = 4;
constexpr double kStep_px = 0.25;
constexpr double kInside_ratio = 0.45, kOutsideMax_ratio = 0.6;  // from the edge, of the radius
constexpr double kContrastMin_grey = 12;
// Of the outline from the ellipse that it makes, rms: what noise and the lens do, and what a covering finger does.
constexpr double kOffRound_px = 0.2, kOffRound_ratio = 0.015;
constexpr double kRayOff_px = 1.0, kRayOff_ratio = 0.08;  // the largest

struct Ray {
  Eigen::Vector2d from_px, along_px;  // at 0 the centre, at 1 the edge
  [[nodiscard]] double Grey(const GreyImage& image, double at) const {
    const Eigen::Vector2d place = from_px + at * along_px;
    return image.Between(place.x(), place.y());
  }
};

bool IsInside(const GreyImage& image, const Eigen::Vector2d& at_px) {
  return at_px.x() >= 0 && at_px.y() >= 0 && at_px.x() <= image.width_px - 1 && at_px.y() <= image.height_px - 1;
}

double MeanGrey(const GreyImage& image, const Ray& ray, double from, double to) {
  constexpr int kSamples = 8;
  double sum = 0;
  for (int i = 0; i < kSamples; ++i) sum += ray.Grey(image, from + (to - from) * (i + 0.5) / kSamples);
  return sum / kSamples;
}

// Where grey passes the middle between inside and outside, nearest to the edge as it was expected; in radii.
std::optional<double> EdgeAlong(const GreyImage& image, const Ray& ray, bool is_dark, double inside_grey,
                                double reach) {
  const double outside_grey = MeanGrey(image, ray, 1 + 0.6 * reach, 1 + reach);
  const double rise = is_dark ? outside_grey - inside_grey : inside_grey - outside_grey;
  if (!(rise >= kContrastMin_grey)) return std::nullopt;
  const double middle = (inside_grey + outside_grey) / 2, from = 1 - kInside_ratio, to = 1 + reach;
  const int steps = std::max(4, static_cast<int>(std::ceil((to - from) * ray.along_px.norm() / kStep_px)));
  std::optional<double> edge;
  double before = ray.Grey(image, from) - middle;
  for (int i = 1; i <= steps; ++i) {
    const double at = from + (to - from) * i / steps, now = ray.Grey(image, at) - middle;
    if (is_dark ? (before < 0 && now >= 0) : (before > 0 && now <= 0)) {
      const double here = at - (to - from) / steps * now / (now - before);
      if (!edge || std::abs(here - 1) < std::abs(*edge - 1)) edge = here;
    }
    before = now;
  }
  return edge;
}

struct Outline {
  std::vector<Eigen::Vector2d> points_px;
  double off_rms_px = 0, off_max_px = 0, radius_px = 0;
};

std::optional<Outline> OutlineOf(const GreyImage& image, const Ellipse& ellipse, double reach) {
  std::vector<Ray> rays;
  double inside_grey = 0;
  for (int i = 0; i < kRays; ++i) {
    const double angle = 2 * M_PI * i / kRays;
    rays.push_back({ellipse.centre_px, ellipse.axes_px * Eigen::Vector2d(std::cos(angle), std::sin(angle))});
    if (!IsInside(image, rays.back().from_px + (1 + reach) * rays.back().along_px)) return std::nullopt;
    inside_grey += MeanGrey(image, rays.back(), 0.1, 1 - kInside_ratio) / kRays;
  }
  Outline outline;
  double sum = 0;
  for (const Ray& ray : rays) {
    const auto edge = EdgeAlong(image, ray, ellipse.is_dark, inside_grey, reach);
    if (!edge) return std::nullopt;
    outline.points_px.push_back(ray.from_px + *edge * ray.along_px);
    const double off_px = std::abs(*edge - 1) * ray.along_px.norm();
    sum += off_px * off_px;
    outline.off_max_px = std::max(outline.off_max_px, off_px);
  }
  outline.off_rms_px = std::sqrt(sum / kRays);
  outline.radius_px = std::sqrt(std::abs(ellipse.axes_px.determinant()));
  return outline;
}

// The polygon of the rays lies within the outline that it is cut from.
double PolygonShrink() { return std::sqrt(std::sin(2 * M_PI / kRays) / (2 * M_PI / kRays)); }

}  // namespace

std::optional<Ellipse> Sharpened(const GreyImage& image, const Ellipse& ellipse, double clear_ratio) {
  const double reach = std::min(kOutsideMax_ratio, 0.8 * clear_ratio);
  Ellipse sharp = ellipse;
  for (int round = 0; round < kRounds; ++round) {
    const auto outline = OutlineOf(image, sharp, reach);
    if (!outline) return std::nullopt;
    if (round + 1 == kRounds && !(outline->off_rms_px <= kOffRound_px + kOffRound_ratio * outline->radius_px &&
                                  outline->off_max_px <= kRayOff_px + kRayOff_ratio * outline->radius_px))
      return std::nullopt;
    const PolygonMoments moments = MomentsOf(outline->points_px);
    sharp.centre_px = moments.centroid;
    sharp.axes_px = AxesOf(moments.second) / PolygonShrink();
    if (!(sharp.Minor_px() > 0.5)) return std::nullopt;
  }
  return sharp;
}

}  // namespace rigcal::detect
