#include "server/calib/joint/slant_bias.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace rigcal::calib::joint {
namespace {

constexpr double kAnySlant_m = 0.1;  // as good as not held
constexpr double kToldSigmas = 4.0;

std::vector<bool> SeePlates(const SessionProblem& problem) {
  std::vector<bool> sees(problem.sensors.size(), false);
  for (const PlateSeen& plate : problem.plates) sees[static_cast<std::size_t>(plate.sensor)] = true;
  return sees;
}

// Sigma of each sensor's slant bias as the session tells it; 0: none, or no lidar.
std::vector<double> SlantSigmas_m(const Refined& freely) {
  std::vector<double> sigmas_m(freely.layout.slant.size(), 0.0);
  for (std::size_t s = 0; s < sigmas_m.size(); ++s) {
    const int at = freely.layout.slant[s];
    if (at == kNone) continue;
    const double bias_m = freely.state.slant_bias_m[s], variance_m2 = freely.covariance(at, at);
    if (variance_m2 < 0.5 * kAnySlant_m * kAnySlant_m)  // else the session tells nothing of it
      sigmas_m[s] = std::sqrt(std::max(0.0, bias_m * bias_m - variance_m2));
  }
  return sigmas_m;
}

}  // namespace

Explained WithSlants(Explained now) {
  SessionStart start = now.start;
  const std::vector<bool> lidars = SeePlates(start.problem);
  if (std::none_of(lidars.begin(), lidars.end(), [](bool sees) { return sees; })) return now;
  for (std::size_t s = 0; s < lidars.size(); ++s) start.problem.slant_bias_sigma_m[s] = lidars[s] ? kAnySlant_m : 0.0;
  const auto freely = Refine(start.problem, now.refined.state, now.refined.noise, now.refined.groups);
  if (!freely) return now;
  start.problem.slant_bias_sigma_m = SlantSigmas_m(*freely);
  const auto& sigmas_m = start.problem.slant_bias_sigma_m;
  if (std::all_of(sigmas_m.begin(), sigmas_m.end(), [](double sigma_m) { return sigma_m == 0.0; })) return now;
  start.state = freely->state;
  for (std::size_t s = 0; s < sigmas_m.size(); ++s)
    if (sigmas_m[s] == 0.0) start.state.slant_bias_m[s] = 0.0;
  start.noise = freely->noise;
  auto next = Explain(std::move(start), now.refined.groups);
  return next ? std::move(*next) : std::move(now);
}

std::vector<SlantBias> SlantsTold(const SessionProblem& problem, const Refined& refined) {
  std::map<SensorId, SlantBias> told;
  for (std::size_t s = 0; s < refined.layout.slant.size(); ++s) {
    const int at = refined.layout.slant[s];
    if (at == kNone) continue;
    const SlantBias slant{problem.sensors[s], -refined.state.slant_bias_m[s], std::sqrt(refined.covariance(at, at))};
    if (std::abs(slant.too_long_m) >= kToldSigmas * slant.sigma_m) told.try_emplace(slant.lidar, slant);
  }
  std::vector<SlantBias> slants;
  for (const auto& [lidar, slant] : told) slants.push_back(slant);
  return slants;
}

}  // namespace rigcal::calib::joint
