#include "server/detect/clouds/cloud_board.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <new>

#include "server/base/process/out_of_memory.h"
#include "server/detect/clouds/cloud_picture.h"
#include "server/detect/clouds/plate_fit.h"

namespace rigcal::detect {
namespace {

// Raised whenever the same cloud could give other patches, or another reason why there are none.
constexpr int kPlateVersion = 2;
constexpr double kPlateMin_m = 0.05, kPlateMax_m = 12.0;
constexpr std::size_t kRaysMin = 12, kPatchPointsMin = 12;
constexpr double kScoreMin = 0.12;
constexpr std::size_t kFinalistsMax = 12;

std::string Metres(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

std::string SizeText(const PlateSize& size) {
  const std::string least = Metres(size.min_m.x()) + " x " + Metres(size.min_m.y());
  const std::string most = Metres(size.max_m.x()) + " x " + Metres(size.max_m.y());
  return least == most ? least + " m" : least + " to " + most + " m";
}

// Empty: it can. Otherwise why not.
std::string WhyUnsearchable(const PlateSize& size) {
  if (size.min_m.minCoeff() >= kPlateMin_m && size.max_m.maxCoeff() <= kPlateMax_m &&
      size.max_m.maxCoeff() <= 10 * size.min_m.minCoeff())
    return {};
  return "a plate of " + SizeText(size) +
         " cannot be searched in a cloud; sides must be 0.05 to 12 m and at most ten to one: check plate_size_m";
}

bool SamePlace(const FittedPlate& a, const FittedPlate& b, const PlateSize& size) {
  return (a.Centre_m() - b.Centre_m()).norm() < 0.5 * size.Short_m();
}

// The best of each place, best first.
std::vector<FittedPlate> Distinct(std::vector<FittedPlate> plates, const PlateSize& size, std::size_t most) {
  std::stable_sort(plates.begin(), plates.end(),
                   [](const FittedPlate& a, const FittedPlate& b) { return a.score > b.score; });
  std::vector<FittedPlate> kept;
  for (const FittedPlate& plate : plates) {
    if (kept.size() >= most) break;
    if (plate.score < kScoreMin) continue;
    if (std::none_of(kept.begin(), kept.end(), [&](const FittedPlate& other) { return SamePlace(plate, other, size); }))
      kept.push_back(plate);
  }
  return kept;
}

std::vector<FittedPlate> FindPlates(const CloudRays& rays, const PlateSize& size) {
  std::vector<FittedPlate> rough, final;
  for (const PlateHypothesis& hypothesis : PlateHypotheses(rays, size))
    if (const auto plate = RoughPlate(rays, size, hypothesis)) rough.push_back(*plate);
  for (const FittedPlate& plate : Distinct(std::move(rough), size, kFinalistsMax))
    if (const auto fitted = FinalPlate(rays, size, plate)) final.push_back(*fitted);
  return Distinct(std::move(final), size, kPatchesMax);
}

std::string WhyNoRays(const Cloud& cloud, const CloudRays& rays) {
  if (cloud.points_m.empty()) return "the cloud holds no points; check that the lidar was measuring";
  return "the cloud holds " + std::to_string(rays.points_m.size()) +
         " points at 0.1 to 200 m, too few to show a plate; check that its unit is the metre";
}

void Search(const Cloud& cloud, const PlateSize& size, AnnotatedCloud& result) {
  CloudView& view = result.view;
  const CloudRays rays(cloud, size.Short_m() / 2);
  std::vector<FittedPlate> drawn;
  if (rays.points_m.size() < kRaysMin) {
    view.why_not = WhyNoRays(cloud, rays);
  } else {
    for (const FittedPlate& plate : FindPlates(rays, size)) {
      PlanePatch patch = PatchOf(cloud, plate);
      if (patch.points_m.size() < kPatchPointsMin) continue;
      view.candidates.push_back(std::move(patch));
      drawn.push_back(plate);
    }
    view.found = !view.candidates.empty();
    if (!view.found)
      view.why_not =
          "no flat patch of " + SizeText(size) +
          " stands free in the cloud; hold the plate clear of walls and furniture, facing the lidar, near enough "
          "for three scan lines";
  }
  result.picture = CloudPicture(rays, view.points, drawn);
}

}  // namespace

std::string CloudDetectorKey(const Target& target) {
  const PlateSize size = PlateSizeOf(target);
  char text[128];
  std::snprintf(text, sizeof text, "plate-%d/%.6gx%.6g-%.6gx%.6g/", kPlateVersion, size.min_m.x(), size.min_m.y(),
                size.max_m.x(), size.max_m.y());
  return text + target.id.str();
}

AnnotatedCloud DetectPlate(const Cloud& cloud, const Target& target) {
  AnnotatedCloud result;
  result.view.target = target.id;
  result.view.points = cloud.points_m.size();
  const PlateSize size = PlateSizeOf(target);
  result.view.why_not = WhyUnsearchable(size);
  if (!result.view.why_not.empty()) return result;
  try {
    Search(cloud, size, result);
  } catch (const std::exception& exception) {
    if (IsOutOfMemory(exception)) throw std::bad_alloc();
    result.view.found = false;
    result.view.points = 0;
    result.view.candidates.clear();
    result.view.why_not = std::string("the search for the plate failed: ") + exception.what();
  }
  return result;
}

}  // namespace rigcal::detect
