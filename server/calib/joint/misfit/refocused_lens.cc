#include "server/calib/joint/misfit/refocused_lens.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rigcal::calib::joint {
namespace {

constexpr int kFocalNumbers = 2, kLensNumbers = 4;  // fx fy, and cx cy: the first of all models' intrinsics
constexpr double kFocal_ratio = 0.05, kCentre_ratio = 0.005;
constexpr double kDistortionSigmaMin = 1e-9;

const SensorId& NameOf(const SessionProblem& problem, const Where& look) {
  return problem.sensors[static_cast<std::size_t>(look.sensor)];
}

int GroupOf(const Refined& refined, const CornersSeen& look) {
  return refined.groups.group_of_place[static_cast<std::size_t>(look.place)];
}

// The lens through which the sensor of this name looked last before a group.
int LensBefore(const SessionProblem& problem, const Refined& refined, const SensorId& name, int group) {
  int lens = kNone, last = kNone;
  for (const CornersSeen& look : problem.corners)
    if (NameOf(problem, look) == name && GroupOf(refined, look) < group && look.place > last)
      lens = look.camera, last = look.place;
  return lens;
}

int ColumnOf(const SessionProblem& problem, const Layout& layout, std::size_t camera, int number) {
  const std::vector<int>& refined = problem.cameras[camera].refined;
  const auto at = std::find(refined.begin(), refined.end(), number);
  return at == refined.end() ? kNone : layout.lens[camera] + static_cast<int>(at - refined.begin());
}

Lens SecondLens(const SessionProblem& problem, const Refined& refined, std::size_t camera) {
  Lens lens = problem.cameras[camera];
  lens.is_given = lens.is_exact = lens.is_freed = false;
  const std::vector<int> before = lens.refined;
  lens.refined.resize(kLensNumbers);
  std::iota(lens.refined.begin(), lens.refined.end(), 0);
  lens.given = refined.state.intrinsics[camera];
  for (int i = 0; i < kLensNumbers; ++i)
    lens.sigma[i] = i < kFocalNumbers ? kFocal_ratio * lens.given[i] : kCentre_ratio * lens.picture.width_px;
  for (const int number : before) {
    if (number < kLensNumbers) continue;
    lens.refined.push_back(number);
    const int at = ColumnOf(problem, refined.layout, camera, number);
    lens.sigma[number] = std::max(kDistortionSigmaMin, std::sqrt(std::max(0.0, refined.covariance(at, at))));
  }
  return lens;
}

// Of (fx + fy) over twice their mean.
double VarianceOfFocal(const SessionProblem& problem, const Refined& split, std::size_t camera, double focal_px) {
  double variance_px2 = 0.0;
  for (int i = 0; i < kFocalNumbers; ++i)
    for (int j = 0; j < kFocalNumbers; ++j) {
      const int row = ColumnOf(problem, split.layout, camera, i), column = ColumnOf(problem, split.layout, camera, j);
      if (row != kNone && column != kNone) variance_px2 += 0.25 * split.covariance(row, column);
    }
  return variance_px2 / (focal_px * focal_px);
}

double FocalOf(const SessionState& state, std::size_t camera) {
  return state.intrinsics[camera].head<kFocalNumbers>().mean();
}

}  // namespace

std::optional<SessionStart> WithSecondLens(SessionStart start, const Refined& refined, int sensor, int group) {
  const SensorId name = start.problem.sensors[static_cast<std::size_t>(sensor)];
  const int first = LensBefore(start.problem, refined, name, group);
  if (first == kNone || start.problem.cameras[static_cast<std::size_t>(first)].picture.width_px <= 0)
    return std::nullopt;
  const auto camera = static_cast<std::size_t>(first);
  start.state = refined.state;
  start.noise = refined.noise;
  const int added = static_cast<int>(start.problem.cameras.size());
  start.problem.cameras.push_back(SecondLens(start.problem, refined, camera));
  start.state.intrinsics.push_back(refined.state.intrinsics[camera]);
  start.state.pupil_shift_m.push_back(refined.state.pupil_shift_m[camera]);
  if (!start.state.field_px.empty()) start.state.field_px.push_back(refined.state.field_px[camera]);
  if (!start.state.field_dof.empty()) start.state.field_dof.push_back(refined.state.field_dof[camera]);
  bool any = false;
  for (CornersSeen& look : start.problem.corners)
    if (look.camera == first && GroupOf(refined, look) >= group) look.camera = added, any = true;
  return any ? std::optional(std::move(start)) : std::nullopt;
}

FocalChange FocalChangeOf(const SessionProblem& problem, const Refined& split) {
  const std::size_t second = problem.cameras.size() - 1;
  const CornersSeen* after = nullptr;
  for (const CornersSeen& look : problem.corners)
    if (look.camera == static_cast<int>(second) && (after == nullptr || look.place < after->place)) after = &look;
  const auto first =
      static_cast<std::size_t>(LensBefore(problem, split, NameOf(problem, *after), GroupOf(split, *after)));
  const double before_px = FocalOf(split.state, first), after_px = FocalOf(split.state, second);
  FocalChange change;
  change.focal_ratio = after_px / before_px - 1;
  change.sigma_ratio =
      std::sqrt(VarianceOfFocal(problem, split, first, before_px) + VarianceOfFocal(problem, split, second, after_px));
  return change;
}

}  // namespace rigcal::calib::joint
