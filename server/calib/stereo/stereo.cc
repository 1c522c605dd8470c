#include "server/calib/stereo/stereo.h"

#include <algorithm>
#include <cmath>

#include "server/calib/camera/lens_bounds.h"
#include "server/calib/core/diagnoses.h"
#include "server/calib/core/joint_covariance.h"
#include "server/calib/core/selection.h"
#include "server/calib/stereo/observability.h"
#include "server/calib/stereo/pair_start.h"
#include "server/calib/stereo/stereo_work.h"

namespace rigcal::calib {
namespace {

// Two poses of the cameras, from a board turned or not, whose costs differ by less than ten sigma squared are not told
// apart: errors within a picture are correlated, so a few sigma come by chance.
constexpr double kAmbiguousTurnCost = 100.0;
constexpr double kVarianceMin_px2 = 1e-4;  // no corner is known better than to a hundredth of a pixel
// Of two such poses the nearer to the nominal one wins if the other is so much farther (units of Discrepancy).
constexpr double kFartherRatio = 2.0, kFartherAtLeast = 1.0;

// The joint refinement from one T_a_b.
struct Attempt {
  StereoWork work;
  std::vector<Diagnosis> notes;
  OrDiagnosis<void> status;
};

OrDiagnosis<void> Solve(const StereoProblem& problem, double width_px, Attempt& attempt) {
  const auto contradicting = PlaceBoards(problem, width_px, attempt.work);
  if (!contradicting.empty()) {
    if (CountBoth(problem, attempt.work.used) < kCapturesMin)
      return tl::unexpected(InconsistentCaptures(problem, contradicting));
    attempt.notes.push_back(InconsistentCaptures(problem, contradicting));
  }
  return RefineWithChoices(problem, attempt.work, attempt.notes);
}

// More captures first, then the smaller residuals; what failed last.
bool Better(const StereoProblem& problem, const Attempt& left, const Attempt& right) {
  if (left.status.has_value() != right.status.has_value()) return left.status.has_value();
  if (!left.status) return false;
  const std::size_t both_left = CountBoth(problem, left.work.used), both_right = CountBoth(problem, right.work.used);
  if (both_left != both_right) return both_left > both_right;
  return SumOfSquares_px2(left.work.joint, left.work.state) < SumOfSquares_px2(right.work.joint, right.work.state);
}

bool FitsEqually(const StereoProblem& problem, const Attempt& best, const Attempt& other) {
  if (!other.status || CountBoth(problem, other.work.used) != CountBoth(problem, best.work.used)) return false;
  const double variance_px2 = std::max(kVarianceMin_px2, best.work.Variance_px2());
  return SumOfSquares_px2(other.work.joint, other.work.state) - SumOfSquares_px2(best.work.joint, best.work.state) <
         kAmbiguousTurnCost * variance_px2;
}

// Two attempts may end in the same minimum.
bool IsNew(const Attempt& attempt, const std::vector<Attempt>& others, double distance_m) {
  return std::all_of(others.begin(), others.end(), [&](const Attempt& other) {
    return Discrepancy(other.work.state.T_a_b, attempt.work.state.T_a_b, distance_m) >= 1.0;
  });
}

// The attempt nearest to the nominal pose; none if there is no nominal pose or another is about as near.
std::optional<std::size_t> ByNominalPose(const StereoProblem& problem, const std::vector<Attempt>& attempts,
                                         double distance_m) {
  if (!problem.camera_a.T_ref_nominal || !problem.camera_b.T_ref_nominal) return std::nullopt;
  const Se3 nominal = problem.camera_a.T_ref_nominal->Inverse() * *problem.camera_b.T_ref_nominal;
  std::vector<std::pair<double, std::size_t>> away;
  for (std::size_t i = 0; i < attempts.size(); ++i)
    away.emplace_back(Discrepancy(nominal, attempts[i].work.state.T_a_b, distance_m), i);
  std::sort(away.begin(), away.end());
  const double nearest = away[0].first, next = away[1].first;
  if (next < kFartherRatio * nearest || next < nearest + kFartherAtLeast) return std::nullopt;
  return away[0].second;
}

OrDiagnosis<Attempt> BestOf(const StereoProblem& problem, std::vector<Attempt> attempts, double distance_m) {
  std::stable_sort(attempts.begin(), attempts.end(),
                   [&](const Attempt& left, const Attempt& right) { return Better(problem, left, right); });
  if (!attempts[0].status) return tl::unexpected(attempts[0].status.error());
  std::vector<Attempt> equal;
  for (Attempt& attempt : attempts)
    if (equal.empty() || (FitsEqually(problem, equal[0], attempt) && IsNew(attempt, equal, distance_m)))
      equal.push_back(std::move(attempt));
  if (equal.size() == 1) return std::move(equal[0]);
  if (const auto nearest = ByNominalPose(problem, equal, distance_m)) return std::move(equal[*nearest]);
  return tl::unexpected(AmbiguousBoard(problem, CountBoth(problem, equal[0].work.used), equal.size()));
}

OrDiagnosis<StereoWork> SolvedFromScratch(const StereoProblem& problem, std::vector<Diagnosis>& notes) {
  RIGCAL_ASSIGN(const auto start, ColdStart(problem));
  std::vector<Attempt> attempts;
  for (const Se3& T_a_b : start.T_a_b) {
    attempts.push_back({start.work, {}, {}});
    attempts.back().work.state.T_a_b = T_a_b;
    attempts.back().status = Solve(problem, start.width_px, attempts.back());
  }
  RIGCAL_ASSIGN(auto best, BestOf(problem, std::move(attempts), start.distance_m));
  notes.insert(notes.end(), best.notes.begin(), best.notes.end());
  return std::move(best.work);
}

OrDiagnosis<StereoWork> SolvedFrom(const StereoProblem& problem, const StereoEstimate& start) {
  StereoWork work = WarmStart(problem, start);
  if (auto refined = Refine(problem, work); !refined) return tl::unexpected(refined.error());
  return work;
}

std::size_t CornersOf(const JointCapture& capture) { return capture.a.size() + capture.b.size(); }

double Rms(double sum_px2, std::size_t points) {
  return points == 0 ? 0.0 : std::sqrt(sum_px2 / static_cast<double>(points));
}

void FillResiduals(const StereoProblem& problem, const StereoWork& work, StereoEstimate& estimate) {
  CaptureError sum;
  std::size_t points_a = 0, points_b = 0;
  std::map<std::size_t, double> rms_px;
  for (std::size_t k = 0; k < work.used.size(); ++k) {
    const CaptureError error = ErrorOf(work.joint, work.state, k);
    sum.a_px2 += error.a_px2;
    sum.b_px2 += error.b_px2;
    points_a += work.joint.captures[k].a.size();
    points_b += work.joint.captures[k].b.size();
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

std::optional<Diagnosis> WhyDistortionOpen(const StereoProblem& problem, const StereoWork& work,
                                           const JointCovariance& covariance) {
  const Eigen::VectorXd variances = covariance.captures.diagonal();
  std::optional<Diagnosis> why;
  if (work.joint.a.IsFree())
    why =
        WhyDistortionOpen(problem.camera_a.id, work.joint.a.model, variances.segment<kIntrinsicsMax>(kIntrinsicsAStart),
                          ViewsOf(problem, work.used, &StereoCapture::a), work.state.intrinsics_a);
  if (!why && work.joint.b.IsFree())
    why =
        WhyDistortionOpen(problem.camera_b.id, work.joint.b.model, variances.segment<kIntrinsicsMax>(kIntrinsicsBStart),
                          ViewsOf(problem, work.used, &StereoCapture::b), work.state.intrinsics_b);
  return why;
}

// Of a camera whose intrinsics are not held.
std::optional<Diagnosis> WhyAbsurd(const StereoProblem& problem, const StereoWork& work) {
  std::optional<Diagnosis> why;
  if (!HoldsIntrinsics(problem.camera_a))
    why = WhyAbsurd(problem.camera_a, work.state.intrinsics_a, ViewsOf(problem, work.used, &StereoCapture::a));
  if (!why && !HoldsIntrinsics(problem.camera_b))
    why = WhyAbsurd(problem.camera_b, work.state.intrinsics_b, ViewsOf(problem, work.used, &StereoCapture::b));
  return why;
}

OrDiagnosis<StereoEstimate> Finished(const StereoProblem& problem, const StereoWork& work) {
  StereoEstimate estimate;
  const auto covariance = ModelCovariance(work.joint, work.state);
  if (!covariance) return tl::unexpected(IllConditioned(problem, covariance.error().what));
  if (auto open = WhyDistortionOpen(problem, work, *covariance)) return tl::unexpected(std::move(*open));
  estimate.C_model = covariance->captures.block<6, 6>(kPairStart, kPairStart);
  estimate.shifts_a = covariance->shifts_a;
  estimate.shifts_b = covariance->shifts_b;
  estimate.corner_sigma_px = std::max(work.joint.a.pull.corner_sigma_px, work.joint.b.pull.corner_sigma_px);
  estimate.intrinsics_a = IntrinsicsOf(work.joint.a.model, work.state.intrinsics_a);
  estimate.intrinsics_b = IntrinsicsOf(work.joint.b.model, work.state.intrinsics_b);
  estimate.T_a_b = work.state.T_a_b;
  estimate.iterations = work.iterations;
  for (std::size_t k = 0; k < work.used.size(); ++k) {
    const CaptureId& capture = problem.captures[work.used[k]].capture;
    estimate.T_a_board[capture] = work.state.T_a_board[k];
    if (work.turns_b[k] != 0) estimate.turn_b[capture] = work.turns_b[k];
  }
  FillResiduals(problem, work, estimate);
  return estimate;
}

}  // namespace

OrDiagnosis<StereoEstimate> EstimateOrDiagnose(const StereoProblem& problem, const StereoEstimate* start,
                                               std::vector<Diagnosis>* notes) {
  std::vector<Diagnosis> ignored;
  std::vector<Diagnosis>& kept = notes != nullptr ? *notes : ignored;
  RIGCAL_ASSIGN(const auto work, start != nullptr ? SolvedFrom(problem, *start) : SolvedFromScratch(problem, kept));
  auto estimate = Finished(problem, work);
  if (estimate && start == nullptr)
    if (auto absurd = WhyAbsurd(problem, work)) return tl::unexpected(std::move(*absurd));
  return estimate;
}

Result<StereoEstimate> Estimate(const StereoProblem& problem, const StereoEstimate* start) {
  auto estimate = EstimateOrDiagnose(problem, start, nullptr);
  if (!estimate) return Fail(ErrorCode::kInvalidInput, estimate.error().what, estimate.error().cure);
  return std::move(*estimate);
}

}  // namespace rigcal::calib
