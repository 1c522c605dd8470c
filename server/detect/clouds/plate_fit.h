// From a place where a plate may be to the plate: plane, outline, points.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "server/detect/clouds/plate_hypotheses.h"
#include "server/model/sensors/features.h"

namespace rigcal::detect {

struct FittedPlate {
  FittedPlane plane;
  PlaneFrame frame;
  Outline outline;
  double margin_m = 0.0;  // inside the outline, of pixels that may have seen plate and background at once
  double score = 0.0;

  // Of the outline, in the lidar's frame.
  [[nodiscard]] Eigen::Vector3d Centre_m() const { return frame.At(outline.centre_m); }
  // Lidar frame, in order round the plate.
  [[nodiscard]] std::array<Eigen::Vector3d, 4> Corners_m() const;
};

// A quick fit on few rays, to choose by score; and the final one. Nothing if no plane is left.
[[nodiscard]] std::optional<FittedPlate> RoughPlate(const CloudRays& rays, const PlateSize& size,
                                                    const PlateHypothesis& hypothesis);
[[nodiscard]] std::optional<FittedPlate> FinalPlate(const CloudRays& rays, const PlateSize& size,
                                                    const FittedPlate& rough);

// All of the cloud's points that lie on the plate, edges left out.
[[nodiscard]] PlanePatch PatchOf(const Cloud& cloud, const FittedPlate& plate);

}  // namespace rigcal::detect
