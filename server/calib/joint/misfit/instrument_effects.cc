#include "server/calib/joint/misfit/instrument_effects.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "server/calib/joint/misfit/random_effect.h"
#include "server/calib/joint/problem/board_bend.h"

namespace rigcal::calib::joint {
namespace {

constexpr double kAnySlant_m = 0.1, kAnyPupilShift_m = 0.01;  // as good as not held
constexpr double kSureNumber = 9.0, kToldNumber = 16.0;

// Of a lidar or of a camera's lens one number, of a board three.
struct Effect {
  enum class Kind { kSlant, kPupil, kBend };
  Kind kind = Kind::kSlant;
  std::size_t of = 0;  // index of a sensor, a camera, a target

  [[nodiscard]] int size() const { return kind == Kind::kBend ? 3 : 1; }
  [[nodiscard]] double any_m() const {
    return kind == Kind::kBend ? kAnyBend_m : kind == Kind::kPupil ? kAnyPupilShift_m : kAnySlant_m;
  }
  [[nodiscard]] int At(const Layout& layout) const {
    return kind == Kind::kBend ? layout.bend[of] : kind == Kind::kPupil ? layout.pupil[of] : layout.slant[of];
  }
  [[nodiscard]] double& SigmaIn(SessionProblem& problem) const {
    if (kind == Kind::kPupil) return problem.cameras[of].pupil_sigma_m;
    return kind == Kind::kBend ? problem.bend_sigma_m[of] : problem.slant_bias_sigma_m[of];
  }
  [[nodiscard]] Eigen::VectorXd ValueIn(const SessionState& state) const {
    if (kind == Kind::kBend) return state.board_bend_m[of];
    return Eigen::VectorXd::Constant(1, kind == Kind::kPupil ? state.pupil_shift_m[of] : state.slant_bias_m[of]);
  }
  void ClearIn(SessionState& state) const {
    if (kind == Kind::kBend)
      state.board_bend_m[of].setZero();
    else
      (kind == Kind::kPupil ? state.pupil_shift_m : state.slant_bias_m)[of] = 0.0;
  }
};

// Which are judged at once. Pupils by themselves, after the others: what fields of lenses do looks a little like them,
// and beside them nothing is said as surely of boards.
enum class Effects { kLidarsAndBoards, kPupils };

std::vector<Effect> EffectsOf(const SessionProblem& problem, Effects which) {
  std::set<int> lidars, lenses, boards;
  for (const PlateSeen& plate : problem.plates) lidars.insert(plate.sensor);
  for (const CornersSeen& seen : problem.corners) lenses.insert(seen.camera), boards.insert(seen.target);
  std::vector<Effect> effects;
  const auto add = [&](Effect::Kind kind, const std::set<int>& all) {
    for (const int one : all) effects.push_back({kind, static_cast<std::size_t>(one)});
  };
  if (which == Effects::kPupils) {
    add(Effect::Kind::kPupil, lenses);
    return effects;
  }
  add(Effect::Kind::kSlant, lidars);
  add(Effect::Kind::kBend, boards);
  return effects;
}

SessionProblem Freed(SessionProblem problem, Effects which) {
  for (const Effect& effect : EffectsOf(problem, which))
    if (double& sigma_m = effect.SigmaIn(problem); sigma_m == 0.0) sigma_m = effect.any_m();
  return problem;
}

// Nothing where all are free already.
std::optional<Refined> RefinedFreely(const SessionProblem& problem, const Refined& refined, Effects which) {
  const std::vector<Effect> effects = EffectsOf(problem, which);
  SessionProblem free = problem;
  if (std::none_of(effects.begin(), effects.end(), [&](const Effect& one) { return one.SigmaIn(free) == 0.0; }))
    return std::nullopt;
  auto freely = Refine(Freed(problem, which), refined.state, refined.noise, refined.groups);
  return freely ? std::optional(std::move(*freely)) : std::nullopt;
}

// Odds of three and of four sigmas of one number.
bool IsTold(const RandomEffect& told) { return told.SquaredSigmas() >= (told.b.size() == 1 ? kToldNumber : kToldBend); }
// A lens that bends looks a little as one whose pupil shifts: that is taken out only where it is told and none bends,
// and else in the sigmas.
bool IsSure(const Effect& effect, const RandomEffect& told) {
  if (effect.kind == Effect::Kind::kPupil) return IsTold(told);
  return told.SquaredSigmas() >= (effect.kind == Effect::Kind::kBend ? kSureBend : kSureNumber);
}

// Absent: the layout does not have it. `by_fields` may be empty.
std::optional<RandomEffect> ToldOf(const Effect& effect, const Refined& refined, const Eigen::MatrixXd& by_fields) {
  const int at = effect.At(refined.layout), size = effect.size();
  if (at == kNone) return std::nullopt;
  RandomEffect told{effect.ValueIn(refined.state), refined.covariance.block(at, at, size, size)};
  if (by_fields.size() > 0) told.C += by_fields.block(at, at, size, size);
  return told;
}

bool AnyIsSure(const SessionProblem& problem, const Refined& freely, Effects which) {
  const std::vector<Effect> effects = EffectsOf(problem, which);
  return std::any_of(effects.begin(), effects.end(), [&](const Effect& effect) {
    const auto told = ToldOf(effect, freely, {});
    return told && IsSure(effect, *told);
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

std::optional<Refined>& FreelyIn(Explained& now, Effects which) {
  return which == Effects::kPupils ? now.with_pupils_free : now.with_effects_free;
}
const std::optional<Refined>& FreelyIn(const Explained& last, Effects which) {
  return which == Effects::kPupils ? last.with_pupils_free : last.with_effects_free;
}

// Takes out what surely is, of those judged at once.
Explained WithSureOnes(Explained now, Effects which) {
  std::optional<Refined>& freely = FreelyIn(now, which);
  freely = RefinedFreely(now.start.problem, now.refined, which);
  if (!freely || !AnyIsSure(now.start.problem, *freely, which)) return now;
  if (which == Effects::kPupils && now.misfits.any()) return now;  // what bends lenses may be all of it
  const Eigen::MatrixXd by_fields = CovarianceByFields(FindMisfits(now.start.problem, *freely));
  SessionStart start = now.start;
  start.state = freely->state;
  start.noise = freely->noise;
  bool any = false;
  for (const Effect& effect : EffectsOf(start.problem, which)) {
    const auto told = ToldOf(effect, *freely, by_fields);
    const double variance_m2 = told && IsSure(effect, *told) ? told->LikeliestVariance(effect.any_m()) : 0.0;
    effect.SigmaIn(start.problem) = std::sqrt(variance_m2);
    if (variance_m2 == 0.0) effect.ClearIn(start.state);
    any |= variance_m2 > 0.0;
  }
  if (!any) return now;
  auto next = Explain(std::move(start), now.refined.groups);
  return next ? std::move(*next) : std::move(now);
}

// What the sigma of those that were judged at once, and are no unknowns, adds to the unknowns of the layout.
Eigen::MatrixXd CovarianceBy(const Explained& last, Effects which) {
  const std::optional<Refined>& before_all = FreelyIn(last, which);
  const std::optional<Refined> freely =
      before_all ? before_all : RefinedFreely(last.start.problem, last.refined, which);
  if (!freely) return {};
  const std::vector<Effect> effects = EffectsOf(last.start.problem, which);
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

}  // namespace

SessionProblem WithEffectsFree(SessionProblem problem) { return Freed(std::move(problem), Effects::kLidarsAndBoards); }

Explained WithInstrumentEffects(Explained now) {
  return WithSureOnes(WithSureOnes(std::move(now), Effects::kLidarsAndBoards), Effects::kPupils);
}

Eigen::MatrixXd CovarianceByInstruments(const Explained& last) {
  const Eigen::MatrixXd by_others = CovarianceBy(last, Effects::kLidarsAndBoards),
                        by_pupils = CovarianceBy(last, Effects::kPupils);
  if (by_others.size() == 0) return by_pupils;
  return by_pupils.size() == 0 ? by_others : Eigen::MatrixXd(by_others + by_pupils);
}

std::vector<SlantBias> SlantsTold(const SessionProblem& problem, const Refined& refined,
                                  const Eigen::MatrixXd& by_fields) {
  std::map<SensorId, SlantBias> lidars;
  for (const Effect& effect : EffectsOf(problem, Effects::kLidarsAndBoards)) {
    const auto told = effect.kind == Effect::Kind::kSlant ? ToldOf(effect, refined, by_fields) : std::nullopt;
    if (!told || !IsTold(*told)) continue;
    const SensorId& lidar = problem.sensors[effect.of];
    lidars.try_emplace(lidar, SlantBias{lidar, -told->b[0], std::sqrt(told->C(0, 0))});
  }
  std::vector<SlantBias> slants;
  for (const auto& [lidar, slant] : lidars) slants.push_back(slant);
  return slants;
}

std::vector<PupilShift> PupilShiftsTold(const SessionProblem& problem, const Refined& refined,
                                        const Eigen::MatrixXd& by_fields) {
  std::map<SensorId, PupilShift> cameras;  // a lens that changed as it was last
  for (const Effect& effect : EffectsOf(problem, Effects::kPupils)) {
    const auto told = ToldOf(effect, refined, by_fields);
    if (!told || !IsTold(*told)) continue;
    for (const CornersSeen& seen : problem.corners)
      if (seen.camera == static_cast<int>(effect.of)) {
        const SensorId& camera = problem.sensors[static_cast<std::size_t>(seen.sensor)];
        cameras[camera] = {camera, told->b[0], std::sqrt(told->C(0, 0))};
        break;
      }
  }
  std::vector<PupilShift> shifts;
  for (const auto& [camera, shift] : cameras) shifts.push_back(shift);
  return shifts;
}

std::vector<BoardBend> BendsTold(const SessionProblem& problem, const Refined& refined,
                                 const Eigen::MatrixXd& by_fields) {
  std::vector<BoardBend> bends;
  for (const Effect& effect : EffectsOf(problem, Effects::kLidarsAndBoards)) {
    const auto told = effect.kind == Effect::Kind::kBend ? ToldOf(effect, refined, by_fields) : std::nullopt;
    if (told && IsTold(*told)) bends.push_back(BendOf(problem.targets[effect.of], *told));
  }
  std::sort(bends.begin(), bends.end(), [](const BoardBend& x, const BoardBend& y) { return x.board < y.board; });
  return bends;
}

}  // namespace rigcal::calib::joint
