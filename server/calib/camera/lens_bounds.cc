#include "server/calib/camera/lens_bounds.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "server/calib/core/wording.h"

namespace rigcal::calib {
namespace {

constexpr double kBeyondShare = 0.1;  // of the views: single corners may be found where none is
constexpr std::size_t kBeyondLeast = 2;
constexpr int kRadiiLooked = 32;
// The strongest pincushion of lenses that are sold is some 15 %, and no fisheye is flatter than the sine.
constexpr double kNearestRatio = 0.5, kFarthestRatio = 1.5, kSteepestRatio = 2.5;
constexpr double kRectilinearMax_rad = 1.5;  // beyond, nothing is
constexpr int kTangential = 6;               // p1, then p2, of a pinhole
// A picture plane that is tilted by t against its lens shifts a point by t r^2, of which a decentring of t / 3 does the
// same along its axis (Brown 1966: 3 p r^2). Cameras are built to within a degree or two; beyond, p stands for a
// principal point that the views do not tell.
constexpr double kTiltMax_deg = 3.0;

struct SeenField {
  std::size_t beyond = 0;  // views whose outermost corner no ray leads to
  double reach_rad = 0;    // from the axis to the outermost corner of the others
};

SeenField FieldOf(const IntrinsicsVector& intrinsics, const CameraViews& views) {
  SeenField field;
  const auto out = [&](const Eigen::Vector2d& uv_px) {
    return (uv_px - intrinsics.segment<2>(2)).cwiseQuotient(intrinsics.head<2>()).squaredNorm();
  };
  for (const SeenCorners& seen : views.seen) {
    const auto outermost =
        std::max_element(seen.uv_px.begin(), seen.uv_px.end(),
                         [&](const Eigen::Vector2d& x, const Eigen::Vector2d& y) { return out(x) < out(y); });
    if (outermost == seen.uv_px.end()) continue;
    const auto ray = Unproject(views.model, intrinsics, *outermost);
    if (ray)
      field.reach_rad = std::max(field.reach_rad, std::atan2(ray->head<2>().norm(), ray->z()));
    else
      ++field.beyond;
  }
  return field;
}

// Of unit focal length on the axis, without what is not the same all round it.
IntrinsicsVector RadialPart(CameraModel model, IntrinsicsVector intrinsics) {
  const double focal = model == CameraModel::kDoubleSphere ? 1 + intrinsics[4] : 1.0;
  intrinsics.head<4>() << focal, focal, 0, 0;
  if (IsPinhole(model)) intrinsics.segment<2>(kTangential).setZero();
  return intrinsics;
}

// The first angle to the axis at which it bends as no lens does.
std::optional<double> AbsurdAt_rad(CameraModel model, const IntrinsicsVector& radial, double reach_rad) {
  double before = 0;
  for (int i = 1; i <= kRadiiLooked; ++i) {
    const double angle_rad = reach_rad * i / kRadiiLooked;
    const Projection at = Project(model, radial, {std::sin(angle_rad), 0, std::cos(angle_rad)}, false);
    const double image = at.uv_px.x();
    if (!at.in_front || !(image >= kNearestRatio * std::sin(std::min(angle_rad, M_PI / 2)))) return angle_rad;
    const double grown = image - before;
    before = image;
    if (angle_rad > kRectilinearMax_rad) continue;
    const double straight = std::tan(angle_rad),
                 straight_grown = straight - std::tan(reach_rad * (i - 1) / kRadiiLooked);
    if (!(image <= kFarthestRatio * straight && grown <= kSteepestRatio * straight_grown)) return angle_rad;
  }
  return std::nullopt;
}

std::string CureOf(bool is_given) {
  return is_given
             ? "Check that the given intrinsics belong to this camera, to pictures of this size and to the model that "
               "they name, or leave them out to have them estimated."
             : "Take more captures with the board tilted in different directions, near and far, in all corners of the "
               "picture.";
}

std::string WhoseDistortion(const SensorId& camera, bool is_given, CameraModel model) {
  return Worded("The {} {} distortion of {} ", {is_given ? "given" : "estimated", NameOf(model), camera});
}

// Of the sensor against the lens, that p1 and p2 of a pinhole stand for; 0 of other models.
double TiltOf_deg(CameraModel model, const IntrinsicsVector& intrinsics) {
  return IsPinhole(model) ? 3 * intrinsics.segment<2>(kTangential).norm() * 180 / M_PI : 0.0;
}

}  // namespace

Diagnosis NoSphereLens(const SensorId& camera, bool is_given, const CameraIntrinsics& lens, const std::string& why) {
  const std::string what = WhoseDistortion(camera, is_given, lens.model) + "is that of no lens: " + why;
  if (!is_given && lens.model == CameraModel::kEucm && lens.distortion.front() < 0)
    return {kAbsurdDistortionCode, what + "; below 0 it bends like a pinhole, or less.",
            "Set its model to pinhole_radtan."};
  return {kAbsurdDistortionCode, what + ".", CureOf(is_given)};
}

std::optional<Diagnosis> WhyAbsurd(const Sensor& camera, const IntrinsicsVector& intrinsics, const CameraViews& views) {
  const bool is_given = camera.intrinsics.has_value();
  const CameraIntrinsics lens = IntrinsicsOf(views.model, intrinsics);
  if (const std::string why = WhyNoSphere(lens); !why.empty()) return NoSphereLens(camera.id, is_given, lens, why);
  const std::string whose = WhoseDistortion(camera.id, is_given, views.model);
  const SeenField field = FieldOf(intrinsics, views);
  if (field.beyond >= kBeyondLeast &&
      static_cast<double>(field.beyond) >= kBeyondShare * static_cast<double>(views.seen.size()))
    return Diagnosis{kAbsurdDistortionCode,
                     whose + Worded("turns over inside the picture: in {} of {} corners lie beyond.",
                                    {field.beyond, CountText(views.seen.size())}),
                     CureOf(is_given)};
  if (const double tilt_deg = TiltOf_deg(views.model, intrinsics); !is_given && tilt_deg > kTiltMax_deg)
    return Diagnosis{kAbsurdDistortionCode,
                     whose + Worded("is decentred as if its sensor were tilted by {} deg against its lens, as none is.",
                                    {Formatted("%.1f", tilt_deg)}),
                     CureOf(is_given)};
  const auto at_rad = AbsurdAt_rad(views.model, RadialPart(views.model, intrinsics), field.reach_rad);
  if (!at_rad) return std::nullopt;
  return Diagnosis{kAbsurdDistortionCode,
                   whose + Worded("bends rays {} deg from the axis, where corners were seen, as no lens does.",
                                  {Formatted("%.0f", *at_rad * 180 / M_PI)}),
                   CureOf(is_given)};
}

}  // namespace rigcal::calib
