#include "server/calib/camera/given_intrinsics.h"

#include <algorithm>

namespace rigcal::calib {
namespace {

constexpr double kCornerSigmaMin_px = 0.01;

std::vector<int> Where(const Sensor& camera, bool refined) {
  std::vector<int> where;
  if (!RefinesIntrinsics(camera)) return where;
  for (std::size_t i = 0; i < camera.intrinsics_sigma->size(); ++i)
    if (((*camera.intrinsics_sigma)[i] > 0) == refined) where.push_back(static_cast<int>(i));
  return where;
}

}  // namespace

bool RefinesIntrinsics(const Sensor& camera) {
  if (!camera.intrinsics || !camera.intrinsics_sigma) return false;
  const std::vector<double>& sigma = *camera.intrinsics_sigma;
  return sigma.size() == static_cast<std::size_t>(IntrinsicsCount(camera.intrinsics->model)) &&
         std::any_of(sigma.begin(), sigma.end(), [](double value) { return value > 0; });
}

bool HoldsIntrinsics(const Sensor& camera) { return camera.intrinsics && !RefinesIntrinsics(camera); }

IntrinsicsPull PullOf(const Sensor& camera, double corner_sigma_px) {
  IntrinsicsPull pull;
  if (!RefinesIntrinsics(camera)) return pull;
  pull.given = VectorOf(*camera.intrinsics);
  for (const int i : RefinedOf(camera)) pull.sigma[i] = (*camera.intrinsics_sigma)[static_cast<std::size_t>(i)];
  pull.corner_sigma_px = std::max(corner_sigma_px, kCornerSigmaMin_px);
  return pull;
}

std::vector<int> HeldOf(const Sensor& camera) { return Where(camera, false); }
std::vector<int> RefinedOf(const Sensor& camera) { return Where(camera, true); }

}  // namespace rigcal::calib
