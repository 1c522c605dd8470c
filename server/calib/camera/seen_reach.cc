#include "server/calib/camera/seen_reach.h"

#include <algorithm>
#include <cmath>

namespace rigcal::calib {

double SeenReach(CameraModel model, const IntrinsicsVector& intrinsics, const CameraViews& views) {
  double reach = 0;
  for (const SeenCorners& seen : views.seen)
    for (const Eigen::Vector2d& uv_px : seen.uv_px) {
      const auto ray = Unproject(model, intrinsics, uv_px);
      if (!ray) continue;
      const double r = ray->head<2>().norm();
      reach = std::max(reach, model == CameraModel::kFisheyeKb4 ? std::atan2(r, ray->z()) : r / ray->z());
    }
  return reach;
}

}  // namespace rigcal::calib
