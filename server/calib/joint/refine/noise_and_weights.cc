#include <algorithm>
#include <cmath>
#include <map>

#include "server/calib/core/robust.h"
#include "server/calib/joint/refine/refine.h"

namespace rigcal::calib::joint {
namespace {

constexpr double kCornerSigmaMin_px = 0.005, kTrackerSigmaMin = 1e-6, kLookSigmaMin_rad = 1e-6;
constexpr double kRedundancyMin = 6.0;  // fewer residuals than this more than unknowns: noise stays as it was
constexpr double kShareMax = 0.99;
constexpr double kClip = 3.5;  // sigmas: a corner that is further off says nothing of what a burst shares

double Squared(double value) { return value * value; }

struct Component {
  double squares = 0.0, redundancy = 0.0, numbers = 0.0;
  void Add(double weight, double squares_of, double numbers_of, double leverage_of) {
    squares += weight * squares_of;
    numbers += weight * numbers_of;
    redundancy += weight * numbers_of - leverage_of;
  }
};

double Updated(double sigma, const Component& component, double least) {
  if (component.redundancy < kRedundancyMin) return sigma;
  return std::max(least, sigma * std::sqrt(std::max(0.0, component.squares) / component.redundancy));
}

// Moments are less what range noise is expected to add; what is more is shared by the points of a plate.
double UpdatedLidar(double factor, const Component& component) {
  if (component.redundancy < kRedundancyMin) return factor;
  const double excess = component.squares * Squared(factor);
  return std::sqrt(std::max(1.0, (excess + component.numbers) / component.redundancy));
}

// Of each camera: what its field took up, per number that it saw.
std::vector<double> FieldLeverage(const SessionProblem& problem, const SessionState& state, const LookWeights& weights,
                                  const SessionFit& fit) {
  std::vector<double> numbers(problem.cameras.size(), 0.0), leverage(problem.cameras.size(), 0.0);
  for (std::size_t i = 0; i < problem.corners.size(); ++i)
    numbers[static_cast<std::size_t>(problem.corners[i].camera)] += weights.in_burst[i] * fit.corners[i].numbers[0];
  for (std::size_t k = 0; k < state.field_dof.size(); ++k)
    if (numbers[k] > 0) leverage[k] = state.field_dof[k] / numbers[k];
  return leverage;
}

// Of one sensor, what half of its looks in each capture exceed: several boards in one cloud are one capture.
struct ExcessOfCapture {
  std::vector<double> of_looks;
  double median = 0.0, of_run = 0.0;
};

// Of each look: what the least of three successive captures of its sensor exceeds, of the three that exceed most.
template <typename Looks>
std::vector<double> ExcessOfRun(const SessionProblem& problem, const Looks& looks, const std::vector<double>& excess) {
  std::vector<std::map<int, ExcessOfCapture>> of_sensor(problem.sensors.size());
  const auto capture_of = [&](const Where& look) -> ExcessOfCapture& {
    return of_sensor[static_cast<std::size_t>(look.sensor)]
                    [problem.capture_of_place[static_cast<std::size_t>(look.place)]];
  };
  for (std::size_t i = 0; i < looks.size(); ++i) capture_of(looks[i]).of_looks.push_back(excess[i]);
  for (auto& captures : of_sensor) {
    std::vector<ExcessOfCapture*> in_order;
    for (auto& [capture, one] : captures) {
      one.median = MedianOf(one.of_looks);
      in_order.push_back(&one);
    }
    for (std::size_t k = 0; k + 2 < in_order.size(); ++k) {
      const double least = std::min({in_order[k]->median, in_order[k + 1]->median, in_order[k + 2]->median});
      for (std::size_t i = k; i < k + 3; ++i) in_order[i]->of_run = std::max(in_order[i]->of_run, least);
    }
  }
  std::vector<double> of_run;
  for (const Where& look : looks) of_run.push_back(capture_of(look).of_run);
  return of_run;
}

// A single picture may be of another instant and is held back; a run of them is a sensor that moved, and is what tells
// so. Between the two the weight has no step: one that depends on itself through the noise would find no rest at it.
double WeightOf(double excess, double excess_of_run) {
  if (excess <= 1.0) return 1.0;
  return std::pow(excess, -2.0 * (1.0 - std::clamp(excess_of_run - 1.0, 0.0, 1.0)));
}

// A look whose squares are far beyond what is usual for its sensor counts less, by how far.
template <typename Looks>
std::vector<double> WeightsOfLooks(const SessionProblem& problem, const Looks& looks, const std::vector<LookFit>& fits,
                                   double least_usual) {
  const auto ratio = [&](std::size_t i) { return std::max(0.0, fits[i].squares.sum()) / fits[i].numbers.sum(); };
  std::vector<std::vector<double>> of_sensor(problem.sensors.size());
  for (std::size_t i = 0; i < looks.size(); ++i)
    of_sensor[static_cast<std::size_t>(looks[i].sensor)].push_back(ratio(i));
  std::vector<double> usual;
  for (const auto& ratios : of_sensor) usual.push_back(std::max(least_usual, ratios.empty() ? 1.0 : MedianOf(ratios)));
  std::vector<double> excess;
  for (std::size_t i = 0; i < looks.size(); ++i)
    excess.push_back(ratio(i) / (usual[static_cast<std::size_t>(looks[i].sensor)] *
                                 Squared(1 + 8 / std::sqrt(fits[i].numbers.sum()))));
  const std::vector<double> of_run = ExcessOfRun(problem, looks, excess);
  std::vector<double> weights;
  for (std::size_t i = 0; i < excess.size(); ++i) weights.push_back(WeightOf(excess[i], of_run[i]));
  return weights;
}

// Of the variance of a corner, what is the same in all pictures of a burst: the mean product of the residuals of one
// corner in two of them (intraclass correlation), over all corners, pictures and bursts of the sensor. Their own poses
// take up a part.
struct Shared {
  double products = 0.0, expected = 0.0;
};
void AddBurst(const SessionProblem& problem, const SessionState& state, const SessionFit& fit,
              const LookWeights& weights, const SensorNoise& noise, const std::vector<std::size_t>& looks,
              Shared& shared) {
  struct OfCorner {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double squares = 0.0, weight = 0.0, weight_squares = 0.0;
  };
  std::map<int, OfCorner> of_corner;
  for (const std::size_t i : looks) {
    const CornersSeen& seen = problem.corners[i];
    const double left = std::sqrt(std::max(0.0, 1 - fit.corners[i].leverage[0] / fit.corners[i].numbers[0]));
    const std::vector<Eigen::Vector2d> residuals_px = CornerResiduals(problem, state, seen, noise);
    for (std::size_t c = 0; c < residuals_px.size(); ++c) {
      const double norm = residuals_px[c].norm() / noise.sigma, weight = weights.corners[i];
      const Eigen::Vector2d r = residuals_px[c] / noise.sigma * (norm > kClip ? kClip / norm : 1.0);
      OfCorner& one = of_corner[seen.corners.idx[c]];
      one.sum += weight * r;
      one.squares += weight * weight * r.squaredNorm();
      one.weight += weight * left;
      one.weight_squares += weight * weight * left * left;
    }
  }
  for (const auto& [idx, one] : of_corner) {
    shared.products += one.sum.squaredNorm() - one.squares;
    shared.expected += 2 * (one.weight * one.weight - one.weight_squares);
  }
}

std::vector<double> BurstShares(const SessionProblem& problem, const CaptureGroups& groups, const SessionState& state,
                                const SessionFit& fit, const LookWeights& weights,
                                const std::vector<SensorNoise>& noise) {
  std::vector<Shared> shared(noise.size());
  for (const auto& looks : RepeatsOfCorners(problem, groups)) {
    const auto sensor = static_cast<std::size_t>(problem.corners[looks.front()].sensor);
    AddBurst(problem, state, fit, weights, noise[sensor], looks, shared[sensor]);
  }
  std::vector<double> shares;
  for (const Shared& one : shared)
    shares.push_back(one.expected > 0 ? std::clamp(one.products / one.expected, 0.0, kShareMax) : 0.0);
  return shares;
}

// A camera of too few looks errs as the others do in the median.
void LikeOthersWhereUntold(const std::vector<Component>& errors, std::vector<SensorNoise>& noise) {
  std::vector<double> told;
  for (std::size_t s = 0; s < noise.size(); ++s)
    if (errors[s].redundancy >= kRedundancyMin) told.push_back(noise[s].sigma_rad);
  if (told.empty()) return;
  const double median = MedianOf(told);
  for (std::size_t s = 0; s < noise.size(); ++s)
    if (errors[s].numbers > 0 && errors[s].redundancy < kRedundancyMin) noise[s].sigma_rad = median;
}

std::vector<double> WeightsInBursts(const SessionProblem& problem, const CaptureGroups& groups,
                                    const std::vector<SensorNoise>& noise) {
  std::vector<double> weights(problem.corners.size(), 1.0);
  for (const auto& looks : RepeatsOfCorners(problem, groups)) {
    const double share = noise[static_cast<std::size_t>(problem.corners[looks.front()].sensor)].burst_share;
    for (const std::size_t i : looks) weights[i] = 1 / (1 + (static_cast<double>(looks.size()) - 1) * share);
  }
  return weights;
}

}  // namespace

std::vector<SensorNoise> NoiseFrom(const SessionProblem& problem, const CaptureGroups& groups,
                                   const LookWeights& weights, const SessionFit& fit, const SessionState& state,
                                   const std::vector<SensorNoise>& before) {
  std::vector<Component> corners(before.size()), plates(before.size()), moved(before.size()), turned(before.size());
  std::vector<Component> errors(before.size());  // of looks as a whole
  const std::vector<double> by_field = FieldLeverage(problem, state, weights, fit);
  for (std::size_t i = 0; i < problem.corners.size(); ++i) {
    const CornersSeen& seen = problem.corners[i];
    const LookFit& one = fit.corners[i];
    const double field = one.numbers[0] * by_field[static_cast<std::size_t>(seen.camera)];
    corners[static_cast<std::size_t>(seen.sensor)].Add(weights.corners[i], one.squares[0], one.numbers[0],
                                                       one.leverage[0] + field);
    if (one.numbers[1] > 0)
      errors[static_cast<std::size_t>(seen.sensor)].Add(weights.corners[i], one.squares[1], one.numbers[1],
                                                        weights.corners[i] * one.leverage[1]);
  }
  for (std::size_t i = 0; i < problem.plates.size(); ++i)
    plates[static_cast<std::size_t>(problem.plates[i].sensor)].Add(weights.plates[i], fit.plates[i].squares[0], 3.0,
                                                                   fit.plates[i].leverage[0]);
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    const auto sensor = static_cast<std::size_t>(problem.poses[i].sensor);
    moved[sensor].Add(weights.poses[i], fit.poses[i].squares[0], 3.0, fit.poses[i].leverage[0]);
    turned[sensor].Add(weights.poses[i], fit.poses[i].squares[1], 3.0, fit.poses[i].leverage[1]);
  }
  const std::vector<double> shares = BurstShares(problem, groups, state, fit, weights, before);
  std::vector<SensorNoise> after = before;
  for (std::size_t s = 0; s < before.size(); ++s) {
    after[s].sigma = Updated(after[s].sigma, corners[s], kCornerSigmaMin_px);
    after[s].sigma = UpdatedLidar(after[s].sigma, plates[s]);
    after[s].sigma = Updated(after[s].sigma, moved[s], kTrackerSigmaMin);
    after[s].burst_share = shares[s];
    after[s].sigma_rad = Updated(after[s].sigma_rad, turned[s], kTrackerSigmaMin);
    after[s].sigma_rad = Updated(after[s].sigma_rad, errors[s], kLookSigmaMin_rad);
  }
  LikeOthersWhereUntold(errors, after);
  return after;
}

LookWeights WeightsFrom(const SessionProblem& problem, const CaptureGroups& groups, const SessionFit& fit,
                        const std::vector<SensorNoise>& noise) {
  // Squares of plates are less what range noise is expected to add, so their median tells little.
  return {WeightsOfLooks(problem, problem.corners, fit.corners, 0.2),
          WeightsOfLooks(problem, problem.plates, fit.plates, 1.0),
          WeightsOfLooks(problem, problem.poses, fit.poses, 0.2), WeightsInBursts(problem, groups, noise)};
}

}  // namespace rigcal::calib::joint
