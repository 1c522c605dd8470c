#include "server/calib/joint/refine.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace rigcal::calib::joint {
namespace {

constexpr int kIterationsMax = 12, kRoundsMax = 40, kRejectedMax = 10;
constexpr double kSettled = 1e-8, kRounding = 1e-4;  // expected gain of a step, in squared sigmas
constexpr double kSameNoise = 0.003;     // ratio, from round to round
constexpr double kSameWeight = 0.01;
constexpr double kCornerSigmaMin_px = 0.005, kTrackerSigmaMin = 1e-6;
constexpr double kRedundancyMin = 6.0;   // fewer residuals than this more than unknowns: noise stays as it was

Error NotSolvable(const std::string& why) {
  return {ErrorCode::kInvalidInput, "the joint refinement " + why,
          "The calibration of its pairs stands; more captures from other places would settle it."};
}

// H^-1, scaled; nothing where H is not positive definite.
std::optional<Eigen::MatrixXd> CovarianceOf(const Eigen::MatrixXd& H) {
  const Eigen::VectorXd scale = H.diagonal().unaryExpr([](double h) { return h > 0 ? 1 / std::sqrt(h) : 1.0; });
  const Eigen::LLT<Eigen::MatrixXd> llt(scale.asDiagonal() * H * scale.asDiagonal());
  if (llt.info() != Eigen::Success || llt.matrixLLT().diagonal().minCoeff() < 1e-7) return std::nullopt;
  const Eigen::MatrixXd inverse = llt.solve(Eigen::MatrixXd::Identity(H.rows(), H.cols()));
  return Eigen::MatrixXd(scale.asDiagonal() * inverse * scale.asDiagonal());
}

struct Step {
  Eigen::VectorXd shared;
  std::vector<Vector6d> places;
  double gain = 0.0;  // expected of the cost
};

std::optional<Step> StepOf(const Linearized& linearized, int size, double damping) {
  const NormalEquations total = linearized.Total();
  Eigen::MatrixXd H = total.H.topLeftCorner(size, size);
  const Eigen::VectorXd b = total.b.head(size);
  const Eigen::VectorXd diagonal = H.diagonal();
  H.diagonal() += damping * diagonal;
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(H);
  if (ldlt.info() != Eigen::Success) return std::nullopt;
  Step step;
  step.shared = -ldlt.solve(b);
  if (!step.shared.allFinite()) return std::nullopt;
  step.gain = -b.dot(step.shared);
  for (const PlaceEquations& place : linearized.places) {
    step.places.emplace_back(-place.inverse * (place.b + place.by_shared.leftCols(size) * step.shared));
    step.gain += place.b.dot(place.inverse * place.b);
  }
  return step;
}

// The minimum with noise and weights held, or what some iterations make of it: while noise is taken for smaller than it is,
// Huber's loss is followed slowly, and a better noise is the better step.
struct Minimum {
  Linearized at;
  bool settled = false;
};
Result<Minimum> Minimize(const Linearization& of, SessionState& state) {
  auto now = Linearize(of, state);
  if (!now) return Fail(NotSolvable("has no start: a camera cannot see a corner that it saw"));
  double damping = 1e-6;
  for (int iteration = 0, rejected = 0; iteration < kIterationsMax && rejected < kRejectedMax; ++iteration) {
    const auto step = StepOf(*now, of.layout.size, damping);
    if (step && std::abs(step->gain) < kSettled) return Minimum{std::move(*now), true};
    const SessionState tried = step ? Moved(of.problem, of.layout, state, step->shared, step->places) : state;
    auto then = step ? Linearize(of, tried) : std::nullopt;
    if (!then || !(then->cost <= now->cost)) {
      damping = std::max(1e-8, 10 * damping);
      ++rejected;
      if (then && step->gain < kRounding) return Minimum{std::move(*now), true};  // rounding of the cost hides what is left
      continue;
    }
    damping = std::max(1e-12, damping / 10);
    rejected = 0;
    state = tried;
    now = std::move(then);
  }
  return Minimum{std::move(*now), false};
}

double Squared(double value) { return value * value; }

struct Component {
  double squares = 0.0, redundancy = 0.0, numbers = 0.0, leverage = 0.0;
  void Add(double weight, double squares_of, double numbers_of, double leverage_of) {
    squares += weight * squares_of;
    numbers += weight * numbers_of;
    leverage += leverage_of;
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
std::vector<double> FieldLeverage(const SessionProblem& problem, const SessionState& state, const SessionFit& fit) {
  std::vector<double> numbers(problem.cameras.size(), 0.0), leverage(problem.cameras.size(), 0.0);
  for (std::size_t i = 0; i < problem.corners.size(); ++i)
    numbers[static_cast<std::size_t>(problem.corners[i].camera)] += fit.corners[i].numbers[0];
  for (std::size_t k = 0; k < state.field_dof.size(); ++k)
    if (numbers[k] > 0) leverage[k] = state.field_dof[k] / numbers[k];
  return leverage;
}

std::vector<SensorNoise> NoiseFrom(const SessionProblem& problem, const LookWeights& weights, const SessionFit& fit,
                                   const SessionState& state, const std::vector<SensorNoise>& before) {
  std::vector<Component> corners(before.size()), plates(before.size()), moved(before.size()), turned(before.size());
  const std::vector<double> by_field = FieldLeverage(problem, state, fit);
  for (std::size_t i = 0; i < problem.corners.size(); ++i) {
    const CornersSeen& seen = problem.corners[i];
    const LookFit& one = fit.corners[i];
    const double field = one.numbers[0] * by_field[static_cast<std::size_t>(seen.camera)];
    corners[static_cast<std::size_t>(seen.sensor)].Add(weights.corners[i], one.squares[0], one.numbers[0],
                                                       one.leverage[0] + field);
  }
  for (std::size_t i = 0; i < problem.plates.size(); ++i)
    plates[static_cast<std::size_t>(problem.plates[i].sensor)].Add(weights.plates[i], fit.plates[i].squares[0], 3.0,
                                                                   fit.plates[i].leverage[0]);
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    const auto sensor = static_cast<std::size_t>(problem.poses[i].sensor);
    moved[sensor].Add(weights.poses[i], fit.poses[i].squares[0], 3.0, fit.poses[i].leverage[0]);
    turned[sensor].Add(weights.poses[i], fit.poses[i].squares[1], 3.0, fit.poses[i].leverage[1]);
  }
  std::vector<SensorNoise> after = before;
  for (std::size_t s = 0; s < before.size(); ++s) {
    after[s].sigma = Updated(after[s].sigma, corners[s], kCornerSigmaMin_px);
    after[s].sigma = UpdatedLidar(after[s].sigma, plates[s]);
    after[s].sigma = Updated(after[s].sigma, moved[s], kTrackerSigmaMin);
    after[s].sigma_rad = Updated(after[s].sigma_rad, turned[s], kTrackerSigmaMin);
  }
  return after;
}

double MedianOf(std::vector<double> values) {
  if (values.empty()) return 1.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Of each look: what the least of three successive looks of its sensor exceeds, of the three that exceed most.
template <typename Looks>
std::vector<double> ExcessOfRun(const Looks& looks, const std::vector<double>& excess, std::size_t sensors) {
  std::vector<std::vector<std::size_t>> of_sensor(sensors);
  for (std::size_t i = 0; i < looks.size(); ++i) of_sensor[static_cast<std::size_t>(looks[i].sensor)].push_back(i);
  std::vector<double> of_run(looks.size(), 0.0);
  for (auto& idx : of_sensor) {
    std::stable_sort(idx.begin(), idx.end(),
                     [&](std::size_t a, std::size_t b) { return looks[a].place < looks[b].place; });
    for (std::size_t k = 0; k + 2 < idx.size(); ++k) {
      const double least = std::min({excess[idx[k]], excess[idx[k + 1]], excess[idx[k + 2]]});
      for (std::size_t i = k; i < k + 3; ++i) of_run[idx[i]] = std::max(of_run[idx[i]], least);
    }
  }
  return of_run;
}

// A single picture may be of another instant and is held back; a run of them is a sensor that moved, and is what tells so.
// Between the two the weight has no step: one that depends on itself through the noise would find no rest at it.
double WeightOf(double excess, double excess_of_run) {
  if (excess <= 1.0) return 1.0;
  return std::pow(excess, -2.0 * (1.0 - std::clamp(excess_of_run - 1.0, 0.0, 1.0)));
}

// A look whose squares are far beyond what is usual for its sensor counts less, by how far.
template <typename Looks>
std::vector<double> WeightsFrom(const Looks& looks, const std::vector<LookFit>& fits, std::size_t sensors,
                                double least_usual) {
  const auto ratio = [&](std::size_t i) { return std::max(0.0, fits[i].squares.sum()) / fits[i].numbers.sum(); };
  std::vector<std::vector<double>> of_sensor(sensors);
  for (std::size_t i = 0; i < looks.size(); ++i)
    of_sensor[static_cast<std::size_t>(looks[i].sensor)].push_back(ratio(i));
  std::vector<double> usual;
  for (const auto& ratios : of_sensor) usual.push_back(std::max(least_usual, MedianOf(ratios)));
  std::vector<double> excess;
  for (std::size_t i = 0; i < looks.size(); ++i)
    excess.push_back(ratio(i) / (usual[static_cast<std::size_t>(looks[i].sensor)] *
                                 Squared(1 + 8 / std::sqrt(fits[i].numbers.sum()))));
  const std::vector<double> of_run = ExcessOfRun(looks, excess, sensors);
  std::vector<double> weights;
  for (std::size_t i = 0; i < excess.size(); ++i) weights.push_back(WeightOf(excess[i], of_run[i]));
  return weights;
}

LookWeights WeightsOf(const SessionProblem& problem, const SessionFit& fit) {
  const std::size_t sensors = problem.sensors.size();
  // Squares of plates are less what range noise is expected to add, so their median tells little.
  return {WeightsFrom(problem.corners, fit.corners, sensors, 0.2), WeightsFrom(problem.plates, fit.plates, sensors, 1.0),
          WeightsFrom(problem.poses, fit.poses, sensors, 0.2)};
}

// Weights go towards what the residuals say by a part of the way, in logarithms: half of it wherever that turned round,
// for a weight that lets a look fit worse would else swing between two values.
class Approach {
 public:
  explicit Approach(std::size_t looks) : part_(looks, 1.0), way_(looks, 0.0) {}
  void Go(const std::vector<double>& from, std::vector<double>& to) {
    for (std::size_t i = 0; i < to.size(); ++i) {
      const double way = std::log(to[i] / from[i]);
      part_[i] = way * way_[i] < 0 ? 0.5 * part_[i] : std::min(1.0, kFaster * part_[i]);
      way_[i] = way;
      to[i] = from[i] * std::exp(part_[i] * way);
    }
  }

 private:
  static constexpr double kFaster = 1.1;
  std::vector<double> part_, way_;
};

bool Same(const std::vector<SensorNoise>& x, const std::vector<SensorNoise>& y) {
  const auto close = [](double a, double b) { return std::abs(a - b) <= kSameNoise * std::max(a, b); };
  for (std::size_t s = 0; s < x.size(); ++s)
    if (!close(x[s].sigma, y[s].sigma) || !close(x[s].sigma_rad, y[s].sigma_rad)) return false;
  return true;
}

bool Same(const std::vector<double>& x, const std::vector<double>& y) {
  return std::equal(x.begin(), x.end(), y.begin(),
                    [](double a, double b) { return std::abs(a - b) <= kSameWeight * std::max(a, b); });
}

}  // namespace

Result<Refined> Refine(const SessionProblem& problem, const SessionState& start, const std::vector<SensorNoise>& noise,
                       const std::vector<int>& group_of_place) {
  Refined refined{start, noise, FullWeights(problem), group_of_place, 0, LayoutOf(problem), {}, {}};
  refined.groups = group_of_place.empty() ? 0 : group_of_place.back() + 1;
  if (refined.layout.size == 0 || refined.groups == 0) return Fail(NotSolvable("has nothing to find"));
  const Linearization of{problem,         refined.layout,         refined.noise,
                         refined.weights, refined.group_of_place, refined.groups};
  Approach corners(problem.corners.size()), plates(problem.plates.size()), poses(problem.poses.size());
  for (int round = 0; round < kRoundsMax; ++round) {
    RIGCAL_ASSIGN(Minimum minimum, Minimize(of, refined.state));
    refined.at_optimum = std::move(minimum.at);
    const Eigen::MatrixXd H = refined.at_optimum.Total().H.topLeftCorner(refined.layout.size, refined.layout.size);
    const auto covariance = CovarianceOf(H);
    if (!covariance) return Fail(NotSolvable("leaves an unknown open: its captures do not tell every pose"));
    refined.covariance = *covariance;
    AddLeverage(of, refined.state, refined.covariance, refined.at_optimum);
    const std::vector<SensorNoise> updated = NoiseFrom(problem, refined.weights, refined.at_optimum.fit,
                                                              refined.state, refined.noise);
    LookWeights weights = WeightsOf(problem, refined.at_optimum.fit);
    corners.Go(refined.weights.corners, weights.corners);
    plates.Go(refined.weights.plates, weights.plates);
    poses.Go(refined.weights.poses, weights.poses);
    const bool same = Same(updated, refined.noise) && Same(weights.corners, refined.weights.corners) &&
                      Same(weights.plates, refined.weights.plates) && Same(weights.poses, refined.weights.poses);
    if (same && minimum.settled) return refined;
    refined.noise = updated;
    refined.weights = weights;
  }
  return Fail(NotSolvable("reached no minimum"));
}

int OpenSensor(const SessionProblem& problem, const SessionState& state, const std::vector<SensorNoise>& noise,
               const std::vector<int>& group_of_place) {
  const Layout layout = LayoutOf(problem);
  const LookWeights weights = FullWeights(problem);
  if (layout.size == 0 || group_of_place.empty()) return kNone;
  const auto at = Linearize({problem, layout, noise, weights, group_of_place, group_of_place.back() + 1}, state);
  if (!at) return kNone;
  const Eigen::MatrixXd H = at->Total().H.topLeftCorner(layout.size, layout.size);
  if (CovarianceOf(H)) return kNone;
  const Eigen::VectorXd scale = H.diagonal().unaryExpr([](double h) { return h > 0 ? 1 / std::sqrt(h) : 1.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(scale.asDiagonal() * H * scale.asDiagonal());
  int most = 0;
  axes.eigenvectors().col(0).cwiseAbs().maxCoeff(&most);
  for (int s = 0; s < static_cast<int>(layout.pose.size()); ++s)
    if (const int row = layout.pose[static_cast<std::size_t>(s)]; row <= most && most < row + 6) return s;
  for (const CornersSeen& seen : problem.corners)
    if (const int row = layout.lens[static_cast<std::size_t>(seen.camera)];
        row != kNone && row <= most &&
        most < row + static_cast<int>(problem.cameras[static_cast<std::size_t>(seen.camera)].refined.size()))
      return seen.sensor == problem.reference ? kNone : seen.sensor;
  return kNone;
}

namespace {

// Poses of the rig nearer than this to where a burst began belong to it: a slow drive is not one.
constexpr double kBurst_m = 0.01, kBurst_rad = 0.01;

}  // namespace

std::vector<int> GroupsOf(const SessionProblem& problem, const SessionState& state, int groups_max) {
  const std::size_t places = problem.capture_of_place.size();
  std::vector<int> burst(places, 0);
  for (std::size_t p = 1, first = 0; p < places; ++p) {
    const Vector6d xi = (state.T_world_ref[first].Inverse() * state.T_world_ref[p]).Log();
    const bool same = problem.capture_of_place[p] == problem.capture_of_place[p - 1] ||
                      (xi.head<3>().norm() < kBurst_m && xi.tail<3>().norm() < kBurst_rad);
    burst[p] = burst[p - 1] + (same ? 0 : 1);
    if (!same) first = p;
  }
  const int bursts = places == 0 ? 0 : burst.back() + 1;
  if (bursts > groups_max)
    for (int& b : burst) b = static_cast<int>(static_cast<std::int64_t>(b) * groups_max / bursts);
  return burst;
}

}  // namespace rigcal::calib::joint
