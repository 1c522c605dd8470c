#include "server/calib/camera/lens_trial.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "server/calib/camera/lens_bounds.h"
#include "server/calib/camera/lens_choice.h"
#include "server/calib/core/robust.h"
#include "server/calib/core/selection.h"
#include "server/calib/planes/planar_pose.h"
#include "server/math/statistics.h"

namespace rigcal::calib {
namespace {

constexpr std::size_t kViewsMost = 60, kViewsLeast = 20, kCornersMost = 6000, kTrainedLeast = 3;
constexpr int kFolds = 5, kGroupsLeast = 6;
constexpr double kHeaviestRatio = 3.0, kBetterRatio = 0.95;
constexpr double kSureProbability = 0.99865;  // three sigmas, one side
constexpr double kExact_px = 1e-4;            // nothing is told apart below
constexpr double kNoPose_px = std::numeric_limits<double>::infinity();
// Of every camera; a sphere model only where it is the camera's own.
constexpr std::array kModels = {CameraModel::kPinholeRadtan, CameraModel::kPinholeRational, CameraModel::kFisheyeKb4};
constexpr std::array kSafestFirst = {CameraModel::kPinholeRadtan, CameraModel::kFisheyeKb4,
                                     CameraModel::kPinholeRational};

// Views side by side with their groups, numbered from 0 without gaps.
struct Tried {
  CameraProblem problem;
  CameraViews views;
  std::vector<int> group;
  int groups = 0;

  [[nodiscard]] int FoldOf(std::size_t view) const { return group[view] * kFolds / groups; }
};

// Fits all views; what of it is fitted again.
struct Lens {
  JointCamera camera;
  CameraEstimate fit;
};

// Of each view left out, bounded; empty: the lens cannot be judged.
using LeftOut_px = std::vector<double>;

std::size_t CountOf(const CameraProblem& problem) {
  std::size_t corners = 0;
  for (const auto& [capture, view] : problem.views) corners += view.corners_px.size();
  const std::size_t mean = std::max<std::size_t>(1, corners / std::max<std::size_t>(1, problem.views.size()));
  return std::clamp(kCornersMost / mean, kViewsLeast, kViewsMost);
}

Tried TriedOf(const CameraProblem& problem, const std::map<CaptureId, int>& group_of_capture) {
  Tried tried{{problem.camera, problem.board, {}}, {}, {}, 0};
  for (const auto& view : problem.views)
    if (group_of_capture.contains(view.first) && WhyUnusable(view.second, problem.board).empty())
      tried.problem.views.push_back(view);
  tried.problem.views = SpreadOver(tried.problem.views, CountOf(tried.problem));
  tried.views = ViewsOf(tried.problem);
  std::map<int, int> number;
  for (const auto& view : tried.problem.views) number[group_of_capture.at(view.first)] = 0;
  for (auto& [group, count] : number) count = tried.groups++;
  for (const auto& view : tried.problem.views) tried.group.push_back(number.at(group_of_capture.at(view.first)));
  return tried;
}

const CaptureId& CaptureOf(const Tried& tried, std::size_t view) { return tried.problem.views[view].first; }

// The intrinsics without the views of a fold; nothing where they are not told.
std::optional<IntrinsicsVector> FittedWithout(const Tried& tried, const Lens& lens, int fold) {
  JointState state;
  state.intrinsics_a = VectorOf(lens.fit.intrinsics);
  if (!lens.camera.estimate) return state.intrinsics_a;
  JointProblem joint = OneCamera(tried.views, true);
  joint.a = lens.camera;
  joint.captures.clear();
  for (std::size_t k = 0; k < tried.views.seen.size(); ++k) {
    const auto board = lens.fit.T_cam_board.find(CaptureOf(tried, k));
    if (tried.FoldOf(k) == fold || board == lens.fit.T_cam_board.end()) continue;
    joint.captures.push_back({tried.views.seen[k], {}});
    state.T_a_board.push_back(board->second);
  }
  if (joint.captures.size() < kTrainedLeast) return std::nullopt;
  const auto solved = SolveJoint(joint, state);
  if (!solved || !solved->state.intrinsics_a.allFinite()) return std::nullopt;
  return solved->state.intrinsics_a;
}

double RmsOfView_px(const Tried& tried, const Lens& lens, const IntrinsicsVector& intrinsics, std::size_t view) {
  CameraViews one = tried.views;
  one.model = lens.camera.model;
  one.seen = {tried.views.seen[view]};
  const JointProblem joint = OneCamera(one, false);
  JointState state;
  state.intrinsics_a = intrinsics;
  state.T_a_board.resize(1);
  std::vector<Se3> poses = lens.fit.PosesOf(CaptureOf(tried, view));
  if (poses.empty()) poses = AllowedPoses(joint, state, 0);
  const PoseChoice choice = ChoosePose(joint, state, 0, poses);
  if (!std::isfinite(choice.ssr_px2)) return kNoPose_px;
  return std::max(kExact_px, std::sqrt(choice.ssr_px2 / static_cast<double>(one.seen.front().size())));
}

LeftOut_px LeftOutOf(const Tried& tried, const Lens& lens) {
  LeftOut_px rms_px(tried.views.seen.size(), kNoPose_px);
  for (int fold = 0; fold < kFolds; ++fold) {
    const auto intrinsics = FittedWithout(tried, lens, fold);
    if (!intrinsics) return {};
    for (std::size_t k = 0; k < rms_px.size(); ++k)
      if (tried.FoldOf(k) == fold) rms_px[k] = RmsOfView_px(tried, lens, *intrinsics, k);
  }
  const double middle_px = MedianOf(rms_px);
  if (!std::isfinite(middle_px)) return {};
  for (double& one : rms_px) one = std::min(one, kHeaviestRatio * middle_px);
  return rms_px;
}

// Over corners.
double Rms_px(const Tried& tried, const LeftOut_px& of_views) {
  double squares_px2 = 0, corners = 0;
  for (std::size_t k = 0; k < of_views.size(); ++k) {
    const auto count = static_cast<double>(tried.views.seen[k].size());
    squares_px2 += count * of_views[k] * of_views[k];
    corners += count;
  }
  return std::sqrt(squares_px2 / corners);
}

// Mean over the views of each group of log(other / one).
std::vector<double> GainByGroup(const Tried& tried, const LeftOut_px& one, const LeftOut_px& other) {
  std::vector<double> gain(static_cast<std::size_t>(tried.groups)), views(gain.size());
  for (std::size_t k = 0; k < one.size(); ++k) {
    const auto group = static_cast<std::size_t>(tried.group[k]);
    gain[group] += std::log(other[k] / one[k]);
    views[group] += 1;
  }
  for (std::size_t g = 0; g < gain.size(); ++g) gain[g] /= views[g];
  return gain;
}

bool SurelyBetter(const Tried& tried, const LeftOut_px& one, const LeftOut_px& other) {
  if (one.empty() || other.empty()) return false;
  if (!(Rms_px(tried, one) <= kBetterRatio * Rms_px(tried, other))) return false;
  const std::vector<double> gain = GainByGroup(tried, one, other);
  const auto groups = static_cast<double>(gain.size());
  const double mean = std::accumulate(gain.begin(), gain.end(), 0.0) / groups;
  double squares = 0;
  for (const double value : gain) squares += (value - mean) * (value - mean);
  const double error = std::sqrt(squares / (groups - 1) / groups);
  return mean > StudentQuantile(kSureProbability, groups - 1) * error;
}

Lens InUse(const Sensor& camera, const CameraEstimate& present) {
  Lens lens{{}, present};
  lens.camera.model = present.intrinsics.model;
  lens.camera.estimate = !HoldsIntrinsics(camera);
  lens.camera.pull = present.pull;
  if (present.pull.Pulls()) lens.camera.held = HeldOf(camera);
  return lens;
}

struct Judged {
  LensCandidate candidate;
  LeftOut_px of_views;
};

Judged JudgedAs(const Tried& tried, CameraModel model) {
  Judged judged{{model, std::nullopt, false}, {}};
  auto fit = EstimateCameraAs(tried.problem, model);
  if (!fit) {
    judged.candidate.absurd = fit.error().code == kAbsurdDistortionCode;
    return judged;
  }
  Lens lens{{}, std::move(*fit)};
  lens.camera.model = model;
  judged.of_views = LeftOutOf(tried, lens);
  if (!judged.of_views.empty()) judged.candidate.left_out_rms_px = Rms_px(tried, judged.of_views);
  return judged;
}

// Of models that foretell alike: lower is preferred.
int Preference(CameraModel own, CameraModel model) {
  if (model == own) return -2;
  if (own == CameraModel::kPinholeRadtan && model == CameraModel::kPinholeRational) return -1;
  return static_cast<int>(std::find(kSafestFirst.begin(), kSafestFirst.end(), model) - kSafestFirst.begin());
}

std::vector<CameraModel> ModelsFor(CameraModel own) {
  std::vector<CameraModel> models(kModels.begin(), kModels.end());
  if (std::find(models.begin(), models.end(), own) == models.end()) models.push_back(own);
  return models;
}

std::optional<CameraModel> ProposedOf(const Tried& tried, const std::vector<Judged>& all, const LeftOut_px& in_use,
                                      CameraModel own) {
  std::vector<const Judged*> better;
  for (const Judged& one : all)
    if (SurelyBetter(tried, one.of_views, in_use)) better.push_back(&one);
  if (better.empty()) return std::nullopt;
  const Judged* best = *std::min_element(better.begin(), better.end(), [](const Judged* x, const Judged* y) {
    return *x->candidate.left_out_rms_px < *y->candidate.left_out_rms_px;
  });
  std::erase_if(better, [&](const Judged* one) { return SurelyBetter(tried, best->of_views, one->of_views); });
  return (*std::min_element(better.begin(), better.end(),
                            [&](const Judged* x, const Judged* y) {
                              return Preference(own, x->candidate.model) < Preference(own, y->candidate.model);
                            }))
      ->candidate.model;
}

}  // namespace

LensTrial TryLenses(const CameraProblem& problem, const CameraEstimate& present,
                    const std::map<CaptureId, int>& group_of_capture) {
  LensTrial trial;
  const Tried tried = TriedOf(problem, group_of_capture);
  if (tried.groups < kGroupsLeast) return trial;
  const LeftOut_px in_use = LeftOutOf(tried, InUse(problem.camera, present));
  if (in_use.empty()) return trial;
  const CameraModel own = present.intrinsics.model;
  trial.given = problem.camera.intrinsics.has_value();
  trial.captures = static_cast<int>(tried.views.seen.size());
  trial.own_left_out_rms_px = Rms_px(tried, in_use);
  std::vector<Judged> all;
  for (const CameraModel model : ModelsFor(own)) {
    if (model == own && !trial.given)
      all.push_back({{model, trial.own_left_out_rms_px, false}, in_use});
    else
      all.push_back(JudgedAs(tried, model));
    trial.candidates.push_back(all.back().candidate);
  }
  trial.proposed = ProposedOf(tried, all, in_use, own);
  return trial;
}

}  // namespace rigcal::calib
