#include "server/calib/joint/slant_bias.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace rigcal::calib::joint {
namespace {

constexpr double kAnySlant_m = 0.1;  // as good as not held
constexpr double kHeldFromSigmas = 3.0, kToldSigmas = 4.0;

// With a free slant bias of every lidar that has none so far; nothing where there is no such lidar.
std::optional<Refined> RefinedFreely(SessionProblem problem, const Refined& refined) {
  bool any = false;
  for (const PlateSeen& plate : problem.plates) {
    double& sigma_m = problem.slant_bias_sigma_m[static_cast<std::size_t>(plate.sensor)];
    if (sigma_m == 0.0) sigma_m = kAnySlant_m, any = true;
  }
  if (!any) return std::nullopt;
  auto freely = Refine(problem, refined.state, refined.noise, refined.groups);
  return freely ? std::optional(std::move(*freely)) : std::nullopt;
}

struct Slant {
  double bias_m = 0.0, variance_m2 = 0.0;
  // Of the session; a bias of which the session tells nothing moves no pose.
  [[nodiscard]] double SigmaSquared_m2() const {
    const bool told = variance_m2 < 0.5 * kAnySlant_m * kAnySlant_m;
    return told ? std::max(0.0, bias_m * bias_m - variance_m2) : 0.0;
  }
  [[nodiscard]] double Sigmas() const { return std::abs(bias_m) / std::sqrt(variance_m2); }
};

// Absent: the sensor has none in this layout.
std::optional<Slant> SlantOf(const Refined& refined, std::size_t sensor) {
  const int at = refined.layout.slant[sensor];
  if (at == kNone) return std::nullopt;
  return Slant{refined.state.slant_bias_m[sensor], refined.covariance(at, at)};
}

}  // namespace

Explained WithSlants(Explained now) {
  const auto freely = RefinedFreely(now.start.problem, now.refined);
  if (!freely) return now;
  SessionStart start = now.start;
  start.state = freely->state;
  start.noise = freely->noise;
  bool any = false;
  for (std::size_t s = 0; s < start.problem.sensors.size(); ++s) {
    const auto slant = SlantOf(*freely, s);
    const bool held = slant && slant->Sigmas() >= kHeldFromSigmas && slant->SigmaSquared_m2() > 0;
    start.problem.slant_bias_sigma_m[s] = held ? std::sqrt(slant->SigmaSquared_m2()) : 0.0;
    if (!held) start.state.slant_bias_m[s] = 0.0;
    any |= held;
  }
  if (!any) return now;
  auto next = Explain(std::move(start), now.refined.groups);
  return next ? std::move(*next) : std::move(now);
}

Eigen::MatrixXd CovarianceBySlants(const Explained& last) {
  const auto freely = RefinedFreely(last.start.problem, last.refined);
  if (!freely) return {};
  // Slant biases are the last unknowns, so those before them stand where they do without.
  const int size = last.refined.layout.size;
  int before = freely->layout.size;
  for (const int at : freely->layout.slant)
    if (at != kNone) before = std::min(before, at);
  Eigen::MatrixXd added = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t s = 0; s < freely->layout.slant.size(); ++s) {
    const auto slant = SlantOf(*freely, s);
    if (!slant || last.refined.layout.slant[s] != kNone) continue;
    // By how much a bias of one metre moves the unknowns where nobody takes it out.
    const Eigen::VectorXd moves = freely->covariance.col(freely->layout.slant[s]).head(before) / slant->variance_m2;
    added.topLeftCorner(before, before) += slant->SigmaSquared_m2() * moves * moves.transpose();
  }
  return added;
}

std::vector<SlantBias> SlantsTold(const SessionProblem& problem, const Refined& refined) {
  std::map<SensorId, SlantBias> told;
  for (std::size_t s = 0; s < refined.layout.slant.size(); ++s) {
    const auto slant = SlantOf(refined, s);
    if (!slant || slant->Sigmas() < kToldSigmas) continue;
    told.try_emplace(problem.sensors[s], SlantBias{problem.sensors[s], -slant->bias_m, std::sqrt(slant->variance_m2)});
  }
  std::vector<SlantBias> slants;
  for (const auto& [lidar, slant] : told) slants.push_back(slant);
  return slants;
}

}  // namespace rigcal::calib::joint
