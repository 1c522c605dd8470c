#include "server/calib/joint/refine/refine.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "server/math/covariance.h"

namespace rigcal::calib::joint {
namespace {

constexpr int kIterationsMax = 12, kRoundsMax = 40, kRejectedMax = 10;
constexpr double kSettled = 1e-8, kRounding = 1e-4;  // expected gain of a step, in squared sigmas
constexpr double kSameNoise = 0.003;                 // ratio, from round to round
constexpr double kSameWeight = 0.01;
constexpr double kLookErrorStart_rad = 1e-3, kNoLookError_rad = 5e-6;
constexpr double kLeastNumbers = 36.0;  // six looks

Error NotSolvable(const std::string& why) {
  return {ErrorCode::kInvalidInput, "the joint refinement " + why, "Capture another session, from other places."};
}

struct Step {
  Eigen::VectorXd shared;
  std::vector<Vector6d> places;
  double gain = 0.0;  // expected of the cost
};

std::optional<Step> StepOf(const Linearized& linearized, int size, double damping) {
  Eigen::MatrixXd H = linearized.total.H.topLeftCorner(size, size);
  const Eigen::VectorXd b = linearized.total.b.head(size);
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
  const auto none = [](double a, double b) { return std::max(a, b) < kNoLookError_rad; };
  for (std::size_t s = 0; s < x.size(); ++s)
    if (!close(x[s].sigma, y[s].sigma) ||
        !(close(x[s].sigma_rad, y[s].sigma_rad) || none(x[s].sigma_rad, y[s].sigma_rad)))
      return false;
  return true;
}

bool Same(const std::vector<double>& x, const std::vector<double>& y) {
  return std::equal(x.begin(), x.end(), y.begin(),
                    [](double a, double b) { return std::abs(a - b) <= kSameWeight * std::max(a, b); });
}

}  // namespace

Result<Minimum> Minimize(const Linearization& of, SessionState& state) {
  auto now = Linearize(of, state);
  if (!now) return Fail(NotSolvable("has no start: a camera cannot see a corner that it saw"));
  double damping = 1e-6;
  for (int iteration = 0, rejected = 0; iteration < kIterationsMax && rejected < kRejectedMax; ++iteration) {
    const auto step = StepOf(*now, of.layout.size, damping);
    if (step && std::abs(step->gain) < kSettled) return Minimum{std::move(*now), true, iteration};
    const SessionState tried = step ? Moved(of.problem, of.layout, state, step->shared, step->places) : state;
    auto then = step ? Linearize(of, tried) : std::nullopt;
    if (!then || !(then->cost <= now->cost)) {
      damping = std::max(1e-8, 10 * damping);
      ++rejected;
      if (then && step->gain < kRounding)
        return Minimum{std::move(*now), true, iteration};  // rounding of the cost hides what is left
      continue;
    }
    damping = std::max(1e-12, damping / 10);
    rejected = 0;
    state = tried;
    now = std::move(then);
  }
  return Minimum{std::move(*now), false, kIterationsMax};
}

std::optional<OneStep> StepFrom(const SessionProblem& problem, const Refined& refined) {
  OneStep one;
  one.layout = LayoutOf(problem);
  const auto at = Linearize({problem, one.layout, refined.noise, refined.weights, refined.groups}, refined.state);
  if (!at) return std::nullopt;
  auto covariance = InverseOfDefinite(at->total.H.topLeftCorner(one.layout.size, one.layout.size));
  if (!covariance) return std::nullopt;
  one.covariance = std::move(*covariance);
  one.step = -one.covariance * at->total.b.head(one.layout.size);
  return one;
}

bool LooksErr(const SessionProblem& problem, const std::vector<SensorNoise>& noise) {
  return std::any_of(problem.corners.begin(), problem.corners.end(), [&](const CornersSeen& seen) {
    return noise[static_cast<std::size_t>(seen.sensor)].sigma_rad > 0;
  });
}

std::vector<SensorNoise> WithLooksThatErr(const SessionProblem& problem, std::vector<SensorNoise> noise) {
  for (const CornersSeen& seen : problem.corners)
    noise[static_cast<std::size_t>(seen.sensor)].sigma_rad = kLookErrorStart_rad;
  return noise;
}

double LooksBesideEachOther(const SessionProblem& problem, const Refined& refined) {
  std::vector<double> squares(problem.sensors.size(), 0.0), numbers(problem.sensors.size(), 0.0);
  for (std::size_t i = 0; i < problem.corners.size(); ++i) {
    const CornersSeen& seen = problem.corners[i];
    const auto sensor = static_cast<std::size_t>(seen.sensor);
    const auto look =
        Observe(problem, refined.layout, refined.state, seen, refined.noise[sensor], refined.weights.OfCorners(i));
    if (!look) continue;
    const Vector6d b = look->b.head<6>();
    squares[sensor] += b.dot(look->A.topLeftCorner<6, 6>().ldlt().solve(b));
    numbers[sensor] += 6 * refined.weights.OfCorners(i);
  }
  double most = 0.0;
  for (std::size_t s = 0; s < numbers.size(); ++s)
    if (numbers[s] >= kLeastNumbers) most = std::max(most, squares[s] / numbers[s]);
  return most;
}

Result<Refined> Refine(const SessionProblem& problem, const SessionState& start, const std::vector<SensorNoise>& noise,
                       const CaptureGroups& groups) {
  Refined refined{start, noise, FullWeights(problem), groups, LayoutOf(problem), {}, {}};
  if (refined.layout.size == 0 || groups.groups() == 0) return Fail(NotSolvable("has nothing to find"));
  const Linearization of{problem, refined.layout, refined.noise, refined.weights, groups};
  Approach corners(problem.corners.size()), plates(problem.plates.size()), poses(problem.poses.size());
  for (int round = 0; round < kRoundsMax; ++round) {
    RIGCAL_ASSIGN(Minimum minimum, Minimize(of, refined.state));
    refined.at_optimum = std::move(minimum.at);
    const Eigen::MatrixXd H = refined.at_optimum.total.H.topLeftCorner(refined.layout.size, refined.layout.size);
    const auto covariance = InverseOfDefinite(H);
    if (!covariance) return Fail(NotSolvable("leaves an unknown open: its captures do not tell every pose"));
    refined.covariance = *covariance;
    AddLeverage(of, refined.state, refined.covariance, refined.at_optimum);
    const std::vector<SensorNoise> updated =
        NoiseFrom(problem, groups, refined.weights, refined.at_optimum.fit, refined.state, refined.noise);
    LookWeights weights = WeightsFrom(problem, groups, refined.at_optimum.fit, updated);
    corners.Go(refined.weights.corners, weights.corners);
    plates.Go(refined.weights.plates, weights.plates);
    poses.Go(refined.weights.poses, weights.poses);
    const bool same = Same(updated, refined.noise) && Same(weights.corners, refined.weights.corners) &&
                      Same(weights.in_burst, refined.weights.in_burst) &&
                      Same(weights.plates, refined.weights.plates) && Same(weights.poses, refined.weights.poses);
    if (same && minimum.settled) return refined;
    refined.noise = updated;
    refined.weights = weights;
  }
  return Fail(NotSolvable("reached no minimum"));
}

int OpenSensor(const SessionProblem& problem, const SessionState& state, const std::vector<SensorNoise>& noise,
               const CaptureGroups& groups) {
  const Layout layout = LayoutOf(problem);
  const LookWeights weights = FullWeights(problem);
  if (layout.size == 0 || groups.groups() == 0) return kNone;
  const auto at = Linearize({problem, layout, noise, weights, groups}, state);
  if (!at) return kNone;
  const Eigen::MatrixXd H = at->total.H.topLeftCorner(layout.size, layout.size);
  if (InverseOfDefinite(H)) return kNone;
  const Eigen::VectorXd scale = UnitDiagonal(H);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(scale.asDiagonal() * H * scale.asDiagonal());
  int most = 0;
  axes.eigenvectors().col(0).cwiseAbs().maxCoeff(&most);
  for (int s = 0; s < static_cast<int>(layout.pose.size()); ++s)
    if (const int row = layout.pose[static_cast<std::size_t>(s)]; row <= most && most < row + 6) return s;
  for (const PoseTold& told : problem.poses)
    if (const int row = told.board == kNone ? kNone : layout.board[static_cast<std::size_t>(told.board)];
        row != kNone && row <= most && most < row + 6)
      return told.sensor == problem.reference ? kNone : told.sensor;
  for (const CornersSeen& seen : problem.corners)
    if (const int row = layout.lens[static_cast<std::size_t>(seen.camera)];
        row != kNone && row <= most &&
        most < row + static_cast<int>(problem.cameras[static_cast<std::size_t>(seen.camera)].refined.size()))
      return seen.sensor == problem.reference ? kNone : seen.sensor;
  return kNone;
}

}  // namespace rigcal::calib::joint
