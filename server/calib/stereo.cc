#include "server/calib/stereo.h"

#include <algorithm>
#include <cmath>

#include "server/calib/diagnoses.h"
#include "server/calib/estimation.h"
#include "server/calib/joint_covariance.h"
#include "server/calib/pair_start.h"
#include "server/calib/pose_choice.h"
#include "server/calib/selection.h"

namespace rigcal::calib {
namespace {

// At the start T_a_b is still rough, so only gross contradictions count: swapped or unsynchronized pictures.
constexpr double kContradictingRatio = 6.0;        // times the median rms of the captures
constexpr double kContradictingWidthRatio = 0.02;  // and this part of the picture's width
// Two minima of a board's pose whose weighted costs differ by less than four sigma squared cannot be told apart.
constexpr double kAmbiguousCost = 16.0;
constexpr int kPoseRoundsMax = 4;

template <typename T>
using OrDiagnosis = tl::expected<T, Diagnosis>;

// The problem as it shrinks and its state as it improves: captures, views and board poses side by side.
struct Work {
  std::vector<std::size_t> used;
  std::map<std::size_t, std::string> unused;
  JointProblem joint;
  JointState state;
  int iterations = 0;

  void Drop(std::size_t position, const std::string& why) {
    unused[used[position]] = why;
    const auto at = static_cast<std::ptrdiff_t>(position);
    used.erase(used.begin() + at);
    joint.captures.erase(joint.captures.begin() + at);
    state.T_a_board.erase(state.T_a_board.begin() + at);
  }
};

std::size_t CornersOf(const JointCapture& capture) { return capture.a_px.size() + capture.b_px.size(); }

OrDiagnosis<IntrinsicsVector> StartOf(const StereoProblem& problem, const Sensor& camera, const CameraViews& views) {
  if (camera.intrinsics) return VectorOf(*camera.intrinsics);
  auto start = ZhangIntrinsics(views);
  if (start) return *start;
  Error error = start.error();
  error.what = camera.id.str() + ": " + error.what;
  return tl::unexpected(FromError(problem, "no_intrinsics", error));
}

std::optional<Se3> StartOfPair(const Work& work) {
  std::vector<PoseCandidates> candidates;
  for (const JointCapture& capture : work.joint.captures) {
    if (capture.a_px.empty() || capture.b_px.empty()) continue;
    candidates.push_back({PlanarPoses(work.state.intrinsics_a, work.joint.corners_board, capture.a_px),
                          PlanarPoses(work.state.intrinsics_b, work.joint.corners_board, capture.b_px)});
  }
  return ConsensusOf(candidates);
}

// Sets the board poses and drops the captures that no pose explains.
std::vector<CaptureId> PlaceBoards(const StereoProblem& problem, double width_px, Work& work) {
  work.state.T_a_board.resize(work.used.size());
  std::vector<double> rms_px;
  for (std::size_t k = 0; k < work.used.size(); ++k) {
    const PoseChoice choice = ChoosePose(work.joint, work.state, k, AllowedPoses(work.joint, work.state, k));
    work.state.T_a_board[k] = choice.T_a_board;
    rms_px.push_back(std::sqrt(choice.ssr_px2 / static_cast<double>(CornersOf(work.joint.captures[k]))));
  }
  std::vector<double> sorted = rms_px;
  std::sort(sorted.begin(), sorted.end());
  const double limit_px =
      std::max(kContradictingRatio * sorted[sorted.size() / 2], kContradictingWidthRatio * width_px);
  std::vector<CaptureId> contradicting;
  for (std::size_t k = work.used.size(); k-- > 0;) {
    if (rms_px[k] <= limit_px) continue;
    contradicting.insert(contradicting.begin(), problem.captures[work.used[k]].capture);
    work.Drop(k, "its pictures contradict the other captures");
  }
  return contradicting;
}

OrDiagnosis<Work> ColdStart(const StereoProblem& problem, std::vector<Diagnosis>& notes) {
  Work work;
  Selection selection = Select(problem);
  work.used = std::move(selection.used);
  work.unused = std::move(selection.unused);
  if (CountBoth(problem, work.used) < kCapturesMin)
    return tl::unexpected(TooFewCaptures(problem, CountBoth(problem, work.used)));
  work.joint = JointOf(problem, work.used);
  const CameraViews views_a = ViewsOfA(problem, work.used), views_b = ViewsOfB(problem, work.used);
  const auto intrinsics_a = StartOf(problem, problem.camera_a, views_a);
  if (!intrinsics_a) return tl::unexpected(intrinsics_a.error());
  const auto intrinsics_b = StartOf(problem, problem.camera_b, views_b);
  if (!intrinsics_b) return tl::unexpected(intrinsics_b.error());
  work.state.intrinsics_a = *intrinsics_a;
  work.state.intrinsics_b = *intrinsics_b;
  const auto T_a_b = StartOfPair(work);
  if (!T_a_b) return tl::unexpected(NoCommonView(problem));
  work.state.T_a_b = *T_a_b;
  const auto contradicting = PlaceBoards(problem, std::max(views_a.width_px, views_b.width_px), work);
  if (contradicting.empty()) return work;
  if (CountBoth(problem, work.used) < kCapturesMin) return tl::unexpected(InconsistentCaptures(problem, contradicting));
  notes.push_back(InconsistentCaptures(problem, contradicting));
  return work;
}

Work WarmStart(const StereoProblem& problem, const StereoEstimate& start) {
  Work work;
  work.state.intrinsics_a = VectorOf(problem.camera_a.intrinsics.value_or(start.intrinsics_a));
  work.state.intrinsics_b = VectorOf(problem.camera_b.intrinsics.value_or(start.intrinsics_b));
  work.state.T_a_b = start.T_a_b;
  for (std::size_t idx = 0; idx < problem.captures.size(); ++idx) {
    const auto board = start.T_a_board.find(problem.captures[idx].capture);
    if (board == start.T_a_board.end()) {
      work.unused[idx] = "not in the estimate that this one starts from";
      continue;
    }
    work.used.push_back(idx);
    work.state.T_a_board.push_back(board->second);
  }
  work.joint = JointOf(problem, work.used);
  return work;
}

OrDiagnosis<void> Refine(const StereoProblem& problem, Work& work) {
  auto solution = SolveJoint(work.joint, work.state);
  if (!solution) return tl::unexpected(FromError(problem, "no_convergence", solution.error()));
  work.state = std::move(solution->state);
  work.iterations += solution->iterations;
  return {};
}

double SumOfSquares(const Work& work) {
  double ssr_px2 = 0;
  for (std::size_t k = 0; k < work.used.size(); ++k) {
    const CaptureError error = ErrorOf(work.joint, work.state, k);
    ssr_px2 += error.a_px2 + error.b_px2;
  }
  return ssr_px2;
}

// One look at every board's other pose. Returns whether anything changed.
bool ReconsiderBoards(const StereoProblem& problem, Work& work, std::vector<CaptureId>& ambiguous) {
  const double s2_px2 = SumOfSquares(work) / (ResidualCount(work.joint) - ParameterCount(work.joint));
  bool changed = false;
  for (std::size_t k = work.used.size(); k-- > 0;) {
    std::vector<Se3> candidates = AllowedPoses(work.joint, work.state, k);
    candidates.insert(candidates.begin(), work.state.T_a_board[k]);
    const PoseChoice choice = ChoosePose(work.joint, work.state, k, candidates);
    if (choice.other_ssr_px2 - choice.ssr_px2 < kAmbiguousCost * s2_px2) {
      ambiguous.push_back(problem.captures[work.used[k]].capture);
      work.Drop(k, "two poses of the board fit equally");
      changed = true;
    } else if ((work.state.T_a_board[k].Inverse() * choice.T_a_board).Log().norm() > 1e-3) {
      work.state.T_a_board[k] = choice.T_a_board;
      changed = true;
    }
  }
  return changed;
}

// Solves, lets the joint problem decide between the two poses of every board, and solves again until nothing changes.
OrDiagnosis<void> RefineWithChoices(const StereoProblem& problem, Work& work, std::vector<Diagnosis>& notes) {
  std::vector<CaptureId> ambiguous;
  for (int round = 0; round < kPoseRoundsMax; ++round) {
    if (auto refined = Refine(problem, work); !refined) return refined;
    if (!ReconsiderBoards(problem, work, ambiguous)) break;
    std::sort(ambiguous.begin(), ambiguous.end());
    if (CountBoth(problem, work.used) < kCapturesMin) return tl::unexpected(AmbiguousPose(problem, ambiguous));
  }
  if (!ambiguous.empty()) notes.push_back(AmbiguousPose(problem, ambiguous));
  return Refine(problem, work);
}

double Rms(double sum_px2, std::size_t points) {
  return points == 0 ? 0.0 : std::sqrt(sum_px2 / static_cast<double>(points));
}

void FillResiduals(const StereoProblem& problem, const Work& work, StereoEstimate& estimate) {
  CaptureError sum;
  std::size_t points_a = 0, points_b = 0;
  std::map<std::size_t, double> rms_px;
  for (std::size_t k = 0; k < work.used.size(); ++k) {
    const CaptureError error = ErrorOf(work.joint, work.state, k);
    sum.a_px2 += error.a_px2;
    sum.b_px2 += error.b_px2;
    points_a += work.joint.captures[k].a_px.size();
    points_b += work.joint.captures[k].b_px.size();
    rms_px[work.used[k]] = Rms(error.a_px2 + error.b_px2, CornersOf(work.joint.captures[k]));
  }
  estimate.rms_a_px = Rms(sum.a_px2, points_a);
  estimate.rms_b_px = Rms(sum.b_px2, points_b);
  estimate.rms_px = Rms(sum.a_px2 + sum.b_px2, points_a + points_b);
  for (std::size_t idx = 0; idx < problem.captures.size(); ++idx) {
    const CaptureId& capture = problem.captures[idx].capture;
    if (const auto why = work.unused.find(idx); why != work.unused.end())
      estimate.residuals.push_back({capture, 0.0, false, why->second});
    else if (BothSee(problem.captures[idx], problem.board))
      estimate.residuals.push_back({capture, rms_px.at(idx), true, {}});
    else
      estimate.residuals.push_back({capture, rms_px.at(idx), true, "one camera only: used for its intrinsics"});
  }
}

OrDiagnosis<StereoEstimate> Finished(const StereoProblem& problem, const Work& work) {
  StereoEstimate estimate;
  const auto covariance = ModelCovariance(work.joint, work.state);
  if (!covariance) return tl::unexpected(IllConditioned(problem, covariance.error().what));
  estimate.C_model = covariance->block<6, 6>(kPairStart, kPairStart);
  estimate.intrinsics_a = IntrinsicsOf(work.state.intrinsics_a);
  estimate.intrinsics_b = IntrinsicsOf(work.state.intrinsics_b);
  estimate.T_a_b = work.state.T_a_b;
  estimate.iterations = work.iterations;
  for (std::size_t k = 0; k < work.used.size(); ++k)
    estimate.T_a_board[problem.captures[work.used[k]].capture] = work.state.T_a_board[k];
  FillResiduals(problem, work, estimate);
  return estimate;
}

}  // namespace

tl::expected<StereoEstimate, Diagnosis> EstimateOrDiagnose(const StereoProblem& problem, const StereoEstimate* start,
                                                           std::vector<Diagnosis>* notes) {
  std::vector<Diagnosis> ignored;
  std::vector<Diagnosis>& kept = notes != nullptr ? *notes : ignored;
  auto work = start != nullptr ? OrDiagnosis<Work>(WarmStart(problem, *start)) : ColdStart(problem, kept);
  if (!work) return tl::unexpected(work.error());
  const auto refined = start != nullptr ? Refine(problem, *work) : RefineWithChoices(problem, *work, kept);
  if (!refined) return tl::unexpected(refined.error());
  return Finished(problem, *work);
}

Result<StereoEstimate> Estimate(const StereoProblem& problem, const StereoEstimate* start) {
  auto estimate = EstimateOrDiagnose(problem, start, nullptr);
  if (!estimate) return Fail(ErrorCode::kInvalidInput, estimate.error().what, estimate.error().cure);
  return std::move(*estimate);
}

}  // namespace rigcal::calib
