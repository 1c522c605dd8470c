#include "server/calib/joint/misfit/print_strain.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "server/calib/joint/misfit/instrument_effects.h"
#include "server/calib/joint/misfit/random_effect.h"
#include "server/math/covariance.h"

namespace rigcal::calib::joint {
namespace {

// (xx - yy, 2 xy): none where the print is larger by the same in every direction.
RandomEffect UnlikeDirections(const RandomEffect& strain) {
  Eigen::Matrix<double, 2, 3> D;
  D << 1, -1, 0, 0, 0, 2;
  return {D * strain.b, D * strain.C * D.transpose()};
}

// Absent: the layout does not have it. `covariance` of the layout's unknowns.
std::optional<RandomEffect> StrainOf(std::size_t target, const Layout& layout, const SessionState& state,
                                     const Eigen::MatrixXd& covariance) {
  const int at = layout.strain[target];
  if (at == kNone) return std::nullopt;
  return RandomEffect{state.print_strain_ratio[target], covariance.block<3, 3>(at, at)};
}

bool IsSure(const std::optional<RandomEffect>& strain) {
  return strain && UnlikeDirections(*strain).SquaredSigmas() >= kSureStrain;
}

std::set<std::size_t> BoardsSeen(const SessionProblem& problem) {
  std::set<std::size_t> boards;
  for (const CornersSeen& seen : problem.corners) boards.insert(static_cast<std::size_t>(seen.target));
  return boards;
}

// What a session tells of prints, bends and slants at once, as they look a little like each other.
SessionProblem WithAllFree(SessionProblem problem) {
  for (const std::size_t board : BoardsSeen(problem)) problem.strain_sigma_ratio[board] = kAnyStrain_ratio;
  return WithEffectsFree(std::move(problem));
}

bool AnyIsStrained(const SessionProblem& problem, const Layout& layout, const SessionState& state,
                   const Eigen::MatrixXd& covariance) {
  for (std::size_t t = 0; t < problem.targets.size(); ++t)
    if (IsSure(StrainOf(t, layout, state, covariance))) return true;
  return false;
}

bool MayBeStrained(const SessionProblem& problem, const Refined& refined) {
  const auto one = StepFrom(problem, refined);
  if (!one) return false;
  return AnyIsStrained(problem, one->layout, Moved(problem, one->layout, refined.state, one->step, {}),
                       one->covariance);
}

// The columns of the board's corners are along x.
PrintStretch StretchOf(const Target& target, const RandomEffect& strain) {
  const RandomEffect unlike = UnlikeDirections(strain);
  PrintStretch stretch{target.id, std::abs(unlike.b[0]), std::sqrt(unlike.C(0, 0))};
  if (std::abs(unlike.b[1]) > std::abs(unlike.b[0]))
    return {target.id, std::abs(unlike.b[1]), std::sqrt(unlike.C(1, 1))};
  stretch.corners_along = unlike.b[0] > 0 ? target.cols : target.rows;
  stretch.corners_across = unlike.b[0] > 0 ? target.rows : target.cols;
  return stretch;
}

// Before boards held upright a lens whose fx is wrong against its fy looks as a stretched print does.
void LoosenAspect(const IntrinsicsVector& now, double ratio, Lens& lens) {
  const double sigma_px = ratio * now[0];
  if (std::find(lens.refined.begin(), lens.refined.end(), 0) == lens.refined.end()) {
    lens.refined.insert(lens.refined.begin(), 0);
    lens.given[0] = now[0];
    lens.sigma[0] = sigma_px;
  } else if (lens.sigma[0] > 0) {
    lens.sigma[0] = std::max(lens.sigma[0], sigma_px);
  }
}

std::vector<SensorId> CamerasOf(std::size_t target, const SessionProblem& problem) {
  std::set<SensorId> cameras;
  for (const CornersSeen& seen : problem.corners)
    if (seen.target == static_cast<int>(target)) cameras.insert(problem.sensors[static_cast<std::size_t>(seen.sensor)]);
  return {cameras.begin(), cameras.end()};
}

}  // namespace

double PrintStrain_ratio(const Explained& now) {
  const SessionProblem free = WithAllFree(now.start.problem);
  if (!MayBeStrained(free, now.refined)) return 0.0;
  const auto freely = Refine(free, now.refined.state, now.refined.noise, now.refined.groups);
  if (!freely) return 0.0;
  const Eigen::MatrixXd C = freely->covariance + CovarianceByFields(FindMisfits(free, *freely));
  double sum = 0.0, count = 0.0;
  for (std::size_t t = 0; t < free.targets.size(); ++t)
    if (const auto strain = StrainOf(t, freely->layout, freely->state, C); IsSure(strain))
      sum += UnlikeDirections(*strain).b.squaredNorm(), count += 1;
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

Explained WithPrintStrain(Explained now, double strain_ratio) {
  if (strain_ratio == 0.0) return now;
  SessionStart start = now.start;
  start.state = now.refined.state;
  start.noise = now.refined.noise;
  const std::set<std::size_t> boards = BoardsSeen(start.problem);
  for (const std::size_t board : boards)
    start.problem.strain_sigma_ratio[board] = std::sqrt(static_cast<double>(boards.size())) * strain_ratio;
  for (std::size_t camera = 0; camera < start.problem.cameras.size(); ++camera)
    LoosenAspect(start.state.intrinsics[camera], strain_ratio, start.problem.cameras[camera]);
  auto next = Explain(std::move(start), now.refined.groups);
  return next ? std::move(*next) : std::move(now);
}

std::vector<PrintStretch> StretchesTold(const SessionProblem& problem, const Refined& refined,
                                        const Eigen::MatrixXd& C) {
  std::vector<PrintStretch> stretches;
  for (std::size_t t = 0; t < problem.targets.size(); ++t) {
    const auto strain = StrainOf(t, refined.layout, refined.state, C);
    if (!strain || UnlikeDirections(*strain).SquaredSigmas() < kToldStrain) continue;
    stretches.push_back(StretchOf(problem.targets[t], *strain));
    stretches.back().seen_by = CamerasOf(t, problem);
  }
  std::sort(stretches.begin(), stretches.end(),
            [](const PrintStretch& x, const PrintStretch& y) { return x.board < y.board; });
  return stretches;
}

}  // namespace rigcal::calib::joint
