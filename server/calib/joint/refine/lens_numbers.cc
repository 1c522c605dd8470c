#include "server/calib/joint/refine/lens_numbers.h"

#include <algorithm>

#include "server/calib/camera/lens_bounds.h"

namespace rigcal::calib::joint {
namespace {

SensorId NameOfCamera(const SessionProblem& problem, int camera) {
  const auto look = std::find_if(problem.corners.begin(), problem.corners.end(),
                                 [&](const CornersSeen& one) { return one.camera == camera; });
  return look == problem.corners.end() ? SensorId() : problem.sensors[static_cast<std::size_t>(look->sensor)];
}

}  // namespace

std::optional<Diagnosis> WhyNoLens(const SessionProblem& problem, const SessionState& state) {
  for (std::size_t c = 0; c < problem.cameras.size(); ++c) {
    const Lens& camera = problem.cameras[c];
    if (camera.refined.empty()) continue;
    const CameraIntrinsics lens = IntrinsicsOf(camera.model, state.intrinsics[c]);
    if (const std::string why = WhyNoSphere(lens); !why.empty())
      return NoSphereLens(NameOfCamera(problem, static_cast<int>(c)), false, lens, why);  // also where it began given
  }
  return std::nullopt;
}

}  // namespace rigcal::calib::joint
