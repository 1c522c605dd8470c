#include "server/calib/joint/refine/lens_numbers.h"

#include <algorithm>
#include <map>

#include "server/calib/camera/lens_bounds.h"

namespace rigcal::calib::joint {
namespace {

SensorId NameOfCamera(const SessionProblem& problem, int camera) {
  const auto look = std::find_if(problem.corners.begin(), problem.corners.end(),
                                 [&](const CornersSeen& one) { return one.camera == camera; });
  return look == problem.corners.end() ? SensorId() : problem.sensors[static_cast<std::size_t>(look->sensor)];
}

// By name of its camera, of several lenses of one name the one that was looked through last.
std::map<SensorId, std::size_t> LastLenses(const SessionProblem& problem) {
  std::map<SensorId, std::pair<int, std::size_t>> last;  // its last place, the lens
  for (const CornersSeen& look : problem.corners) {
    const SensorId& name = problem.sensors[static_cast<std::size_t>(look.sensor)];
    const std::pair<int, std::size_t> now = {look.place, static_cast<std::size_t>(look.camera)};
    const auto [known, is_new] = last.try_emplace(name, now);
    if (!is_new) known->second = std::max(known->second, now);
  }
  std::map<SensorId, std::size_t> lenses;
  for (const auto& [name, one] : last) lenses.emplace(name, one.second);
  return lenses;
}

}  // namespace

std::vector<RefinedLens> LensesTold(const SessionProblem& problem, const Refined& refined,
                                    const Eigen::MatrixXd& covariance) {
  std::vector<RefinedLens> lenses;
  for (const auto& [name, c] : LastLenses(problem)) {
    const Lens& camera = problem.cameras[c];
    if (camera.refined.empty()) continue;
    const int count = IntrinsicsCount(camera.model), at = refined.layout.lens[c];
    RefinedLens lens{name, IntrinsicsOf(camera.model, refined.state.intrinsics[c]),
                     Eigen::MatrixXd::Zero(count, count)};
    for (std::size_t i = 0; i < camera.refined.size(); ++i)
      for (std::size_t k = 0; k < camera.refined.size(); ++k)
        lens.covariance(camera.refined[i], camera.refined[k]) =
            covariance(at + static_cast<int>(i), at + static_cast<int>(k));
    lenses.push_back(std::move(lens));
  }
  return lenses;
}

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
