#include "server/detect/clouds/plate_fit.h"

#include <algorithm>
#include <cmath>

namespace rigcal::detect {
namespace {

constexpr std::size_t kRoughBudget = 400, kFinalBudget = 3000;
constexpr int kFinalRounds = 3;
constexpr double kSmoothSigma_m = 0.03;  // a plate as rough as this scores half

constexpr double kHidden = 0.5;  // what a side that no beam goes beyond takes from the score

// Piercings of the plane around a point, and how dense they are.
struct Surroundings {
  PlaneFrame frame;
  std::vector<Piercing> piercings;
};

Surroundings Around(const CloudRays& rays, const FittedPlane& plane, const PlateSize& size,
                    const Eigen::Vector3d& middle_m, std::size_t budget) {
  Surroundings around;
  around.frame = FrameOn(plane, middle_m);
  around.piercings = Pierce(rays, plane, around.frame, 0.95 * size.max_m.norm(), budget);
  return around;
}

BeamSpacing SpacingInside(const CloudRays& rays, const FittedPlate& plate, const std::vector<Piercing>& piercings) {
  std::vector<std::uint32_t> inside;
  for (const Piercing& piercing : piercings)
    if (plate.outline.Depth_m(piercing.uv_m.cast<double>()) > 0) inside.push_back(piercing.ray);
  return inside.size() < 2 ? BeamSpacing{} : SpacingOf(rays, inside, plate.plane, plate.frame);
}

// 1 if the lidar could have seen something beyond every side, less for each side that its field of view hides.
double ViewOf(const CloudRays& rays, const FittedPlate& plate) {
  const Eigen::Vector2d axis = plate.outline.Axis(), other(-axis.y(), axis.x()), size = plate.outline.size_m;
  double view = 1;
  for (const double sign : {-1.0, 1.0})
    for (const int k : {0, 1}) {
      const Eigen::Vector2d out = k == 0 ? axis : other, along = k == 0 ? other : axis;
      double hidden = 0;
      for (const double share : {-0.35, 0.0, 0.35})
        hidden += !rays.Sees(
            plate.frame.At(plate.outline.centre_m + out * sign * 0.6 * size[k] + along * share * size[1 - k]));
      view *= 1 - kHidden * hidden / 3;
    }
  return view;
}

void Judge(const CloudRays& rays, const std::vector<Piercing>& piercings, FittedPlate& plate) {
  const BeamSpacing spacing = SpacingInside(rays, plate, piercings);
  const double roughness = plate.plane.sigma_m / kSmoothSigma_m;
  plate.margin_m = EdgeMargin_m(plate.outline, spacing);
  plate.score = ScoreOf(piercings, plate.outline, spacing) * ViewOf(rays, plate) / (1 + roughness * roughness);
}

// The plane through what the outline holds, edges left out.
std::optional<FittedPlane> Refitted(const CloudRays& rays, const FittedPlate& plate,
                                    const std::vector<Piercing>& piercings) {
  std::vector<Eigen::Vector3d> points;
  for (const Piercing& piercing : piercings)
    if (piercing.evidence == Evidence::kOn && plate.outline.Depth_m(piercing.uv_m.cast<double>()) > plate.margin_m)
      points.push_back(rays.points_m[piercing.ray].cast<double>());
  return FitPlane(points, 0.05 * plate.outline.size_m.minCoeff());
}

}  // namespace

std::array<Eigen::Vector3d, 4> FittedPlate::Corners_m() const {
  const Eigen::Vector2d axis = outline.Axis(), other(-axis.y(), axis.x());
  const Eigen::Vector2d x = axis * outline.size_m.x() / 2, y = other * outline.size_m.y() / 2, c = outline.centre_m;
  return {frame.At(c - x - y), frame.At(c + x - y), frame.At(c + x + y), frame.At(c - x + y)};
}

std::optional<FittedPlate> RoughPlate(const CloudRays& rays, const PlateSize& size, const PlateHypothesis& hypothesis) {
  FittedPlate plate;
  plate.plane = hypothesis.plane;
  Surroundings around = Around(rays, plate.plane, size, hypothesis.middle_m, kRoughBudget);
  plate.frame = around.frame;
  plate.outline = FindOutline(around.piercings, size);
  Judge(rays, around.piercings, plate);
  const auto plane = Refitted(rays, plate, around.piercings);
  if (!plane) return std::nullopt;
  const Eigen::Vector3d centre = plate.Centre_m();
  plate.plane = *plane;
  around = Around(rays, plate.plane, size, centre, kRoughBudget);
  plate.frame = around.frame;
  plate.outline = FindOutline(around.piercings, size);
  Judge(rays, around.piercings, plate);
  return plate;
}

std::optional<FittedPlate> FinalPlate(const CloudRays& rays, const PlateSize& size, const FittedPlate& rough) {
  FittedPlate plate = rough;
  for (int round = 0; round < kFinalRounds; ++round) {
    const Surroundings around = Around(rays, plate.plane, size, plate.Centre_m(), kFinalBudget);
    const Eigen::Vector3d centre = plate.Centre_m();
    const Eigen::Vector3d axis = plate.frame.At(plate.outline.centre_m + plate.outline.Axis()) - centre;
    plate.frame = around.frame;
    plate.outline.centre_m = plate.frame.Of(centre);
    plate.outline.angle_rad = std::atan2(plate.frame.v.dot(axis), plate.frame.u.dot(axis));
    plate.outline = RefineOutline(around.piercings, size, plate.outline);
    Judge(rays, around.piercings, plate);
    if (round + 1 == kFinalRounds) break;
    const auto plane = Refitted(rays, plate, around.piercings);
    if (!plane) return std::nullopt;
    plate.plane = *plane;
  }
  return plate;
}

PlanePatch PatchOf(const Cloud& cloud, const FittedPlate& plate) {
  PlanePatch patch;
  patch.centre_m = plate.Centre_m();
  patch.normal = plate.plane.normal;
  patch.score = plate.score;
  const double tolerance_m = plate.plane.Tolerance_m(), reach_m = plate.outline.size_m.norm() / 2 + tolerance_m;
  const Eigen::Vector3f centre = patch.centre_m.cast<float>();
  const auto squared_m2 = static_cast<float>(reach_m * reach_m);
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = -low;
  double sum_m2 = 0;
  for (const Eigen::Vector3f& point : cloud.points_m) {
    if (!((point - centre).squaredNorm() <= squared_m2)) continue;
    const Eigen::Vector3d p = point.cast<double>();
    const double distance_m = plate.plane.Distance_m(p), facing = -plate.plane.normal.dot(p);
    if (std::abs(distance_m) > tolerance_m || facing <= 0) continue;
    // Noise moves a point along its ray: where the ray pierces the plane is where it was measured.
    const Eigen::Vector2d uv_m = plate.frame.Of(p * (plate.plane.offset_m / facing));
    if (plate.outline.Depth_m(uv_m) < plate.margin_m) continue;
    patch.points_m.push_back(point);
    sum_m2 += distance_m * distance_m;
    low = low.cwiseMin(plate.outline.Local(uv_m)), high = high.cwiseMax(plate.outline.Local(uv_m));
  }
  if (patch.points_m.empty()) return patch;
  patch.extent_m = {(high - low).maxCoeff(), (high - low).minCoeff()};
  patch.rms_m = std::sqrt(sum_m2 / static_cast<double>(patch.points_m.size()));
  return patch;
}

}  // namespace rigcal::detect
