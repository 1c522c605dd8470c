#include "server/calib/joint/refine/normal_equations.h"

#include <Eigen/Eigenvalues>

#include "server/base/process/parallel_for.h"
#include "server/math/covariance.h"

namespace rigcal::calib::joint {
namespace {

constexpr double kLeastEigenvalueRatio = 1e-10;  // of the largest eigenvalue, scaled to unit diagonal

enum class Kind { kCorners, kPlate, kPose };
struct Look {
  Kind kind;
  std::size_t idx;
};
using LooksOfPlaces = std::vector<std::vector<Look>>;

LooksOfPlaces LooksOf(const SessionProblem& problem) {
  LooksOfPlaces looks(problem.capture_of_place.size());
  const auto add = [&](Kind kind, const auto& list) {
    for (std::size_t i = 0; i < list.size(); ++i) looks[static_cast<std::size_t>(list[i].place)].push_back({kind, i});
  };
  add(Kind::kCorners, problem.corners);
  add(Kind::kPlate, problem.plates);
  add(Kind::kPose, problem.poses);
  return looks;
}

std::optional<Observation> ObserveLook(const Linearization& of, const SessionState& state, const Look& look) {
  const auto observe = [&](const auto& seen, double weight) -> std::optional<Observation> {
    return Observe(of.problem, of.layout, state, seen, of.noise[static_cast<std::size_t>(seen.sensor)], weight);
  };
  if (look.kind == Kind::kCorners) return observe(of.problem.corners[look.idx], of.weights.OfCorners(look.idx));
  if (look.kind == Kind::kPlate) return observe(of.problem.plates[look.idx], of.weights.plates[look.idx]);
  return observe(of.problem.poses[look.idx], of.weights.poses[look.idx]);
}

LookFit& FitOf(SessionFit& fit, const Look& look) {
  return (look.kind == Kind::kCorners ? fit.corners : look.kind == Kind::kPlate ? fit.plates : fit.poses)[look.idx];
}

NormalEquations Zero(const Layout& layout) {
  return {Eigen::MatrixXd::Zero(layout.columns, layout.columns), Eigen::VectorXd::Zero(layout.columns)};
}

void AddShared(const Observation& look, NormalEquations& shared) {
  for (const Column& row : look.columns) {
    const Eigen::MatrixXd half = row.by.transpose() * look.A;
    shared.b.segment(row.at, row.by.cols()) += row.by.transpose() * look.b;
    for (const Column& column : look.columns)
      shared.H.block(row.at, column.at, row.by.cols(), column.by.cols()) += half * column.by;
  }
}

Matrix6d InverseOf(const Matrix6d& H) {
  const Vector6d scale = UnitDiagonal(H);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> axes(scale.asDiagonal() * H * scale.asDiagonal());
  const double least = kLeastEigenvalueRatio * axes.eigenvalues()[5];
  const Vector6d inverse = axes.eigenvalues().unaryExpr([&](double value) { return value > least ? 1 / value : 0.0; });
  const Matrix6d half = scale.asDiagonal() * axes.eigenvectors();
  return half * inverse.asDiagonal() * half.transpose();
}

void AddToPlace(const Observation& look, Matrix6d& H, PlaceEquations& place) {
  const Eigen::MatrixXd half = look.by_place.transpose() * look.A;
  H += half * look.by_place;
  place.b += look.by_place.transpose() * look.b;
  for (const Column& column : look.columns) place.by_shared.middleCols(column.at, column.by.cols()) += half * column.by;
}

LookFit PlainFit(const Observation& look, const Look& of) {
  LookFit fit;
  fit.squares[0] = look.squares;
  fit.numbers[0] = look.numbers;
  if (of.kind == Kind::kPose) {
    fit.numbers.setConstant(3.0);
    fit.squares = look.squares_of_pose;
  }
  if (look.error) {
    fit.squares[1] = look.error->squares;
    fit.numbers[1] = 6.0;
    fit.log_det = look.error->log_det;
  }
  return fit;
}

// One place: its looks, with its pose eliminated. False where a look cannot be.
bool AddPlace(const Linearization& of, const SessionState& state, const std::vector<Look>& looks,
              NormalEquations& group, PlaceEquations& place, SessionFit& fit, double& cost) {
  place.by_shared = Eigen::MatrixXd::Zero(6, of.layout.columns);
  Matrix6d H = Matrix6d::Zero();
  for (const Look& one : looks) {
    const auto look = ObserveLook(of, state, one);
    if (!look) return false;
    AddShared(*look, group);
    AddToPlace(*look, H, place);
    FitOf(fit, one) = PlainFit(*look, one);
    cost += look->cost;
  }
  place.inverse = InverseOf(H);
  const Eigen::MatrixXd half = place.inverse * place.by_shared;
  group.H.noalias() -= place.by_shared.transpose() * half;
  group.b.noalias() -= half.transpose() * place.b;
  return true;
}

void AddPull(int at, double away, double sigma, NormalEquations& given, double& cost) {
  given.H(at, at) += 1 / (sigma * sigma);
  given.b[at] += away / (sigma * sigma);
  cost += away * away / (sigma * sigma);
}

void AddGiven(const SessionProblem& problem, const Layout& layout, const SessionState& state, Linearized& linearized) {
  linearized.given = Zero(layout);
  for (const RelativeKnown& known : problem.relatives) {
    const Observation look = Observe(layout, state, known);
    AddShared(look, linearized.given);
    linearized.cost += look.cost;
  }
  for (std::size_t c = 0; c < problem.cameras.size(); ++c)
    for (std::size_t i = 0; i < problem.cameras[c].refined.size(); ++i) {
      const int idx = problem.cameras[c].refined[i];
      if (const double sigma = problem.cameras[c].sigma[idx]; sigma > 0)
        AddPull(layout.lens[c] + static_cast<int>(i), state.intrinsics[c][idx] - problem.cameras[c].given[idx], sigma,
                linearized.given, linearized.cost);
    }
  for (std::size_t c = 0; c < problem.cameras.size(); ++c)
    if (layout.pupil[c] != kNone)
      AddPull(layout.pupil[c], state.pupil_shift_m[c], problem.cameras[c].pupil_sigma_m, linearized.given,
              linearized.cost);
  for (std::size_t t = 0; t < problem.targets.size(); ++t)
    if (layout.scale[t] != kNone)
      AddPull(layout.scale[t], state.board_scale_ratio[t],
              problem.targets[t].square_sigma_m / problem.targets[t].square_m, linearized.given, linearized.cost);
  const auto pull = [&](const std::vector<int>& at, const std::vector<double>& away, const std::vector<double>& sigma) {
    for (std::size_t s = 0; s < at.size(); ++s)
      if (at[s] != kNone) AddPull(at[s], away[s], sigma[s], linearized.given, linearized.cost);
  };
  for (std::size_t c = 0; c < problem.clocks.size(); ++c)
    if (layout.clock[c] != kNone)
      AddPull(layout.clock[c], state.clock_late_s[c], problem.clocks[c].sigma_s, linearized.given, linearized.cost);
  pull(layout.bias, state.range_bias_m, problem.range_bias_sigma_m);
  pull(layout.slant, state.slant_bias_m, problem.slant_bias_sigma_m);
  const auto pull_three = [&](const std::vector<int>& at, const std::vector<Eigen::Vector3d>& away,
                              const std::vector<double>& sigma) {
    for (std::size_t t = 0; t < at.size(); ++t)
      for (int i = 0; at[t] != kNone && i < 3; ++i)
        AddPull(at[t] + i, away[t][i], sigma[t], linearized.given, linearized.cost);
  };
  pull_three(layout.bend, state.board_bend_m, problem.bend_sigma_m);
  pull_three(layout.strain, state.print_strain_ratio, problem.strain_sigma_ratio);
}

// Of the own unknowns of a look, from those of the session and of its place.
Eigen::MatrixXd OwnCovariance(const Observation& look, const Eigen::MatrixXd& shared, const Eigen::MatrixXd& cross,
                              const Matrix6d& place) {
  Eigen::MatrixXd own = look.by_place * place * look.by_place.transpose();
  for (const Column& row : look.columns) {
    if (row.at + row.by.cols() > shared.rows()) continue;  // is never moved
    const Eigen::MatrixXd with_place = row.by * cross.middleRows(row.at, row.by.cols()) * look.by_place.transpose();
    own += with_place + with_place.transpose();
    for (const Column& column : look.columns)
      if (column.at + column.by.cols() <= shared.rows())
        own += row.by * shared.block(row.at, column.at, row.by.cols(), column.by.cols()) * column.by.transpose();
  }
  return own;
}

// Leverage of a look that counts less as others share its errors. Its place, which it alone tells, takes up as much of
// them as of errors of its own; what captures share takes up more than its weight says, by that weight.
double InBurst(double leverage, double weight, const Observation& look, const Matrix6d& place_alone) {
  if (weight == 1.0) return leverage;
  const double by_place = (look.A * look.by_place * place_alone * look.by_place.transpose()).trace();
  return by_place + (leverage - by_place) / weight;
}

// Of its error as a whole, of the six numbers that say it is none: tr(P C), C = K + by_own C_own by_own^T.
double LeverageOfError(const LookError& error, const Eigen::MatrixXd& own) {
  return error.held + error.information.dot((error.by_own * own * error.by_own.transpose()).diagonal());
}

}  // namespace

LookWeights FullWeights(const SessionProblem& problem) {
  return {std::vector<double>(problem.corners.size(), 1.0), std::vector<double>(problem.plates.size(), 1.0),
          std::vector<double>(problem.poses.size(), 1.0), std::vector<double>(problem.corners.size(), 1.0)};
}

std::optional<Linearized> Linearize(const Linearization& of, const SessionState& state) {
  const LooksOfPlaces looks = LooksOf(of.problem);
  Linearized linearized;
  linearized.groups.assign(static_cast<std::size_t>(of.groups.groups()), {});
  linearized.places.resize(looks.size());
  linearized.fit = {std::vector<LookFit>(of.problem.corners.size()), std::vector<LookFit>(of.problem.plates.size()),
                    std::vector<LookFit>(of.problem.poses.size())};
  std::vector<double> cost(linearized.groups.size(), 0.0);
  std::vector<char> seen(linearized.groups.size(), 1);
  ParallelFor(linearized.groups.size(), [&](std::size_t g) {
    linearized.groups[g] = Zero(of.layout);
    for (std::size_t p = 0; p < looks.size() && seen[g]; ++p)
      if (of.groups.group_of_place[p] == static_cast<int>(g))
        seen[g] = AddPlace(of, state, looks[p], linearized.groups[g], linearized.places[p], linearized.fit, cost[g]);
  });
  for (std::size_t g = 0; g < cost.size(); ++g) {
    if (!seen[g]) return std::nullopt;
    linearized.cost += cost[g];
  }
  AddGiven(of.problem, of.layout, state, linearized);
  linearized.total = linearized.given;
  for (const NormalEquations& group : linearized.groups) {
    linearized.total.H += group.H;
    linearized.total.b += group.b;
  }
  return linearized;
}

void AddLeverage(const Linearization& of, const SessionState& state, const Eigen::MatrixXd& covariance,
                 Linearized& linearized) {
  const LooksOfPlaces looks = LooksOf(of.problem);
  ParallelFor(looks.size(), [&](std::size_t p) {
    const PlaceEquations& place = linearized.places[p];
    const Eigen::MatrixXd K = place.inverse * place.by_shared.leftCols(covariance.rows());
    const Eigen::MatrixXd cross = -covariance * K.transpose();
    const Matrix6d of_place = place.inverse - K * cross;
    for (const Look& one : looks[p]) {
      const auto look = ObserveLook(of, state, one);
      if (!look) continue;
      const Eigen::MatrixXd own = OwnCovariance(*look, covariance, cross, of_place);
      const Eigen::VectorXd share = (look->A * own).diagonal();
      LookFit& fit = FitOf(linearized.fit, one);
      if (one.kind == Kind::kPose)
        fit.leverage << share.head<3>().sum(), share.tail<3>().sum();
      else if (one.kind == Kind::kPlate)
        fit.leverage[0] = share.sum();
      else
        fit.leverage[0] = InBurst(share.sum(), of.weights.in_burst[one.idx], *look, place.inverse);
      if (!look->error) continue;
      const Eigen::MatrixXd by_place_alone = look->by_place * place.inverse * look->by_place.transpose();
      const double others = 1 - of.weights.in_burst[one.idx];  // as InBurst: a place is as well known by one of a burst
      fit.leverage[1] = LeverageOfError(*look->error, own - others * by_place_alone);
      fit.leverage[0] += of.weights.corners[one.idx] * (6.0 - fit.leverage[1]);
    }
  });
}

}  // namespace rigcal::calib::joint
