#include "server/calib/joint/misfit/instrument_effects.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "server/calib/joint/misfit/random_effect.h"
#include "server/calib/joint/problem/board_bend.h"

namespace rigcal::calib::joint {
namespace {

constexpr double kAnySlant_m = 0.1;  // as good as not held
constexpr double kSureSlant = 9.0, kToldSlant = 16.0;

// Of a lidar, one number, or of a board, three.
struct Effect {
  bool is_bend = false;
  std::size_t of = 0;  // a sensor's index; of a bend a target's

  [[nodiscard]] int size() const { return is_bend ? 3 : 1; }
  [[nodiscard]] double any_m() const { return is_bend ? kAnyBend_m : kAnySlant_m; }
  [[nodiscard]] int At(const Layout& layout) const { return is_bend ? layout.bend[of] : layout.slant[of]; }
  [[nodiscard]] double& SigmaIn(SessionProblem& problem) const {
    return is_bend ? problem.bend_sigma_m[of] : problem.slant_bias_sigma_m[of];
  }
  [[nodiscard]] Eigen::VectorXd ValueIn(const SessionState& state) const {
    if (is_bend) return state.board_bend_m[of];
    return Eigen::VectorXd::Constant(1, state.slant_bias_m[of]);
  }
  void ClearIn(SessionState& state) const {
    if (is_bend)
      state.board_bend_m[of].setZero();
    else
      state.slant_bias_m[of] = 0.0;
  }
};

std::vector<Effect> EffectsOf(const SessionProblem& problem) {
  std::set<int> lidars, boards;
  for (const PlateSeen& plate : problem.plates) lidars.insert(plate.sensor);
  for (const CornersSeen& seen : problem.corners) boards.insert(seen.target);
  std::vector<Effect> effects;
  for (const int lidar : lidars) effects.push_back({false, static_cast<std::size_t>(lidar)});
  for (const int board : boards) effects.push_back({true, static_cast<std::size_t>(board)});
  return effects;
}

// Nothing where all are free already.
std::optional<Refined> RefinedFreely(const SessionProblem& problem, const Refined& refined) {
  const std::vector<Effect> effects = EffectsOf(problem);
  SessionProblem free = problem;
  if (std::none_of(effects.begin(), effects.end(), [&](const Effect& one) { return one.SigmaIn(free) == 0.0; }))
    return std::nullopt;
  auto freely = Refine(WithEffectsFree(problem), refined.state, refined.noise, refined.groups);
  return freely ? std::optional(std::move(*freely)) : std::nullopt;
}

// Odds of three and of four sigmas of one number.
bool IsSure(const RandomEffect& told) { return told.SquaredSigmas() >= (told.b.size() == 1 ? kSureSlant : kSureBend); }
bool IsTold(const RandomEffect& told) { return told.SquaredSigmas() >= (told.b.size() == 1 ? kToldSlant : kToldBend); }

// Absent: the layout does not have it. `by_fields` may be empty.
std::optional<RandomEffect> ToldOf(const Effect& effect, const Refined& refined, const Eigen::MatrixXd& by_fields) {
  const int at = effect.At(refined.layout), size = effect.size();
  if (at == kNone) return std::nullopt;
  RandomEffect told{effect.ValueIn(refined.state), refined.covariance.block(at, at, size, size)};
  if (by_fields.size() > 0) told.C += by_fields.block(at, at, size, size);
  return told;
}

bool AnyIsSure(const SessionProblem& problem, const Refined& freely) {
  const std::vector<Effect> effects = EffectsOf(problem);
  return std::any_of(effects.begin(), effects.end(), [&](const Effect& effect) {
    const auto told = ToldOf(effect, freely, {});
    return told && IsSure(*told);
  });
}

// From the lowest to the highest of the plate's corners, middles of edges and centre.
BoardBend BendOf(const Target& target, const RandomEffect& told) {
  const Eigen::Vector2d half = PlateSize_m(target) / 2;
  Eigen::Vector3d lowest = Eigen::Vector3d::Zero(), highest = Eigen::Vector3d::Zero();
  bool any = false;
  for (const double x : {-1.0, 0.0, 1.0})
    for (const double y : {-1.0, 0.0, 1.0}) {
      const Eigen::Vector3d q =
          BendShape(target, PlateCentreOf(target) + Eigen::Vector3d(x * half.x(), y * half.y(), 0));
      if (!any || q.dot(told.b) < lowest.dot(told.b)) lowest = q;
      if (!any || q.dot(told.b) > highest.dot(told.b)) highest = q;
      any = true;
    }
  const Eigen::Vector3d q = highest - lowest;
  return {target.id, q.dot(told.b), std::sqrt(q.dot(told.C * q))};
}

}  // namespace

SessionProblem WithEffectsFree(SessionProblem problem) {
  for (const Effect& effect : EffectsOf(problem))
    if (double& sigma_m = effect.SigmaIn(problem); sigma_m == 0.0) sigma_m = effect.any_m();
  return problem;
}

Explained WithInstrumentEffects(Explained now) {
  now.with_effects_free = RefinedFreely(now.start.problem, now.refined);
  const std::optional<Refined>& freely = now.with_effects_free;
  if (!freely || !AnyIsSure(now.start.problem, *freely)) return now;
  const Eigen::MatrixXd by_fields = CovarianceByFields(FindMisfits(now.start.problem, *freely));
  SessionStart start = now.start;
  start.state = freely->state;
  start.noise = freely->noise;
  bool any = false;
  for (const Effect& effect : EffectsOf(start.problem)) {
    const auto told = ToldOf(effect, *freely, by_fields);
    const double variance_m2 = told && IsSure(*told) ? told->LikeliestVariance(effect.any_m()) : 0.0;
    effect.SigmaIn(start.problem) = std::sqrt(variance_m2);
    if (variance_m2 == 0.0) effect.ClearIn(start.state);
    any |= variance_m2 > 0.0;
  }
  if (!any) return now;
  auto next = Explain(std::move(start), now.refined.groups);
  return next ? std::move(*next) : std::move(now);
}

Eigen::MatrixXd CovarianceByInstruments(const Explained& last) {
  const std::optional<Refined> freely =
      last.with_effects_free ? last.with_effects_free : RefinedFreely(last.start.problem, last.refined);
  if (!freely) return {};
  const std::vector<Effect> effects = EffectsOf(last.start.problem);
  // Effects are the last unknowns, so those before them stand where they do without.
  int before = freely->layout.size;
  for (const Effect& effect : effects)
    if (const int at = effect.At(freely->layout); at != kNone) before = std::min(before, at);
  // By how much effects of one metre move the unknowns where nobody takes them out: all together, as lidars that share
  // boards err alike.
  std::vector<int> rows;
  std::vector<double> variances_m2;
  for (const Effect& effect : effects) {
    const auto told = ToldOf(effect, *freely, {});
    if (!told || effect.At(last.refined.layout) != kNone) continue;
    const double variance_m2 = told->LikeliestVariance(effect.any_m());
    for (int i = 0; i < effect.size(); ++i)
      rows.push_back(effect.At(freely->layout) + i), variances_m2.push_back(variance_m2);
  }
  const Eigen::MatrixXd among = freely->covariance(rows, rows);
  const Eigen::MatrixXd with = freely->covariance(rows, Eigen::seqN(0, before));
  const Eigen::MatrixXd moves = among.ldlt().solve(with).transpose();
  const int size = last.refined.layout.size;
  Eigen::MatrixXd added = Eigen::MatrixXd::Zero(size, size);
  added.topLeftCorner(before, before) =
      moves * Eigen::Map<const Eigen::VectorXd>(variances_m2.data(), moves.cols()).asDiagonal() * moves.transpose();
  return added;
}

std::vector<SlantBias> SlantsTold(const SessionProblem& problem, const Refined& refined,
                                  const Eigen::MatrixXd& by_fields) {
  std::map<SensorId, SlantBias> lidars;
  for (const Effect& effect : EffectsOf(problem)) {
    const auto told = effect.is_bend ? std::nullopt : ToldOf(effect, refined, by_fields);
    if (!told || !IsTold(*told)) continue;
    const SensorId& lidar = problem.sensors[effect.of];
    lidars.try_emplace(lidar, SlantBias{lidar, -told->b[0], std::sqrt(told->C(0, 0))});
  }
  std::vector<SlantBias> slants;
  for (const auto& [lidar, slant] : lidars) slants.push_back(slant);
  return slants;
}

std::vector<BoardBend> BendsTold(const SessionProblem& problem, const Refined& refined,
                                 const Eigen::MatrixXd& by_fields) {
  std::vector<BoardBend> bends;
  for (const Effect& effect : EffectsOf(problem)) {
    const auto told = effect.is_bend ? ToldOf(effect, refined, by_fields) : std::nullopt;
    if (told && IsTold(*told)) bends.push_back(BendOf(problem.targets[effect.of], *told));
  }
  std::sort(bends.begin(), bends.end(), [](const BoardBend& x, const BoardBend& y) { return x.board < y.board; });
  return bends;
}

}  // namespace rigcal::calib::joint
