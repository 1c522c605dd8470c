#include <algorithm>
#include <cmath>

#include "server/calib/camera/camera_diagnoses.h"
#include "server/calib/camera/camera_fit.h"
#include "server/calib/camera/lens_choice.h"
#include "server/calib/core/diagnoses.h"
#include "server/calib/core/leave_one_out.h"
#include "server/calib/core/pair_edge.h"
#include "server/calib/core/selection.h"
#include "server/calib/stereo/moved_pair.h"
#include "server/calib/stereo/stereo.h"
#include "server/calib/stereo/stereo_work.h"
#include "server/math/jackknife.h"

namespace rigcal::calib {
namespace {

constexpr std::size_t kWorstShown = 3;
constexpr double kSuspiciousRatio = 0.5;  // of the residual that is refused

void AddMissed(const StereoProblem& problem, std::vector<Diagnosis>& diagnoses) {
  for (const auto camera : {&StereoCapture::a, &StereoCapture::b}) Append(Missed(problem, camera), diagnoses);
}

Edge EdgeOf(const StereoProblem& problem) {
  return UnsolvedEdge(problem.camera_a.id, problem.camera_b.id, Method::kStereo, problem.captures.size());
}

void AddFiles(const StereoProblem& problem, Edge& edge) {
  for (const auto& [camera, side] : {std::pair{&StereoCapture::a, "_a"}, {&StereoCapture::b, "_b"}}) {
    FilesFound found;
    for (std::size_t idx = 0; idx < problem.captures.size(); ++idx)
      if (const std::optional<BoardView>& view = problem.captures[idx].*camera)
        found.Add(idx, view->found || view->image_width_px > 0, Sees(view, problem.board));
    AddFilesFound(found, side, edge);
  }
}

Edge FailedEdge(const StereoProblem& problem, std::vector<Diagnosis> diagnoses) {
  Edge edge = EdgeOf(problem);
  const Selection selection = Select(problem);
  for (std::size_t idx = 0; idx < problem.captures.size(); ++idx) {
    const auto why = selection.unused.find(idx);
    edge.captures.push_back({problem.captures[idx].capture, 0.0, false,
                             why == selection.unused.end() ? "the pair was not solved" : why->second});
  }
  edge.figures["captures_both"] = static_cast<double>(CountBoth(problem, selection.used));
  AddFiles(problem, edge);
  AddMissed(problem, diagnoses);
  return FailedFor(std::move(diagnoses), std::move(edge));
}

std::map<CaptureId, Se3> BoardsOfB(const StereoEstimate& estimate) {
  std::map<CaptureId, Se3> T_b_board;
  for (const auto& [capture, T_a_board] : estimate.T_a_board) T_b_board[capture] = estimate.T_a_b.Inverse() * T_a_board;
  return T_b_board;
}

// Of both cameras. Without an estimate: what was seen.
std::vector<CameraFit> FitsOf(const StereoProblem& problem, const StereoEstimate* estimate) {
  const CameraProblem a = CameraOf(problem, &StereoCapture::a), b = CameraOf(problem, &StereoCapture::b);
  if (estimate == nullptr) return {SeenBy(a), SeenBy(b)};
  return {FitOf(a, estimate->intrinsics_a, estimate->T_a_board),
          FitOf(b, estimate->intrinsics_b, BoardsOfB(*estimate), estimate->turn_b)};
}

double HighestRms_px(const StereoProblem& problem) {
  int width_px = 0;
  for (const StereoCapture& capture : problem.captures)
    for (const auto& view : {capture.a, capture.b})
      if (view) width_px = std::max(width_px, view->image_width_px);
  return HighRms_px(width_px);
}

Diagnosis LensAsCure(const StereoProblem& problem, Diagnosis diagnosis) {
  return WithLensAsCure(std::move(diagnosis),
                        {{"_a", CameraOf(problem, &StereoCapture::a)}, {"_b", CameraOf(problem, &StereoCapture::b)}});
}

// Residuals that are not refused yet, where the lens is what they come from.
void AddLensSuspicions(const StereoProblem& problem, const StereoEstimate& estimate, std::vector<Diagnosis>& notes) {
  for (const auto& [camera, rms_px] :
       {std::pair{&StereoCapture::a, estimate.rms_a_px}, {&StereoCapture::b, estimate.rms_b_px}}) {
    if (!(rms_px > kSuspiciousRatio * HighestRms_px(problem))) continue;
    const CameraProblem one = CameraOf(problem, camera);
    if (const auto lens = FindBetterLens(one)) notes.push_back(LensSuspected(one, rms_px, *lens));
  }
}

std::vector<CaptureId> WorstOf(const StereoEstimate& estimate) {
  std::vector<CaptureResidual> used;
  for (const CaptureResidual& residual : estimate.residuals)
    if (residual.used) used.push_back(residual);
  std::stable_sort(used.begin(), used.end(), [](const auto& left, const auto& right) { return left.rms > right.rms; });
  std::vector<CaptureId> worst;
  for (std::size_t i = 0; i < std::min(kWorstShown, used.size()); ++i) worst.push_back(used[i].capture);
  return worst;
}

// What a reader of a good edge should know.
void AddNotes(const StereoProblem& problem, std::size_t both, std::vector<Diagnosis>& notes) {
  if (both < kCapturesEnough) notes.push_back(FewCaptures(problem, both));
  AddMissed(problem, notes);
  if (const auto repeated = Select(problem).repeated; !repeated.empty())
    notes.push_back(IdenticalCaptures(problem, repeated));
  for (const Sensor* camera : {&problem.camera_a, &problem.camera_b})
    if (camera->intrinsics && !camera->intrinsics_sigma) notes.push_back(IntrinsicsTakenAsExact(camera->id));
}

void AddDisagreement(const Sensor& camera, const CameraIntrinsics& refined, std::vector<Diagnosis>& notes) {
  if (auto why = WhyGivenDisagree(camera, refined)) notes.push_back(std::move(*why));
}

// Jackknife sigma over model sigma, mean over the directions in which the model has unit sigma. 1: the model's noise
// explains the scatter between captures.
double SigmaRatio(const Matrix6d& C_jack, const Matrix6d& C_model) {
  return std::sqrt(C_model.ldlt().solve(C_jack).trace() / 6);
}

void AddMetrics(const StereoEstimate& estimate, std::size_t both, Edge& edge) {
  const auto used = std::count_if(estimate.residuals.begin(), estimate.residuals.end(),
                                  [](const CaptureResidual& residual) { return residual.used; });
  edge.figures["rms_px"] = estimate.rms_px;
  edge.figures["rms_a_px"] = estimate.rms_a_px;
  edge.figures["rms_b_px"] = estimate.rms_b_px;
  edge.figures["captures_used"] = static_cast<double>(used);
  edge.figures["captures_both"] = static_cast<double>(both);
  edge.figures["captures_total"] = static_cast<double>(estimate.residuals.size());
  edge.figures["iterations"] = estimate.iterations;
  AddIntrinsicsFigures(estimate.intrinsics_a, "_a", edge);
  AddIntrinsicsFigures(estimate.intrinsics_b, "_b", edge);
  const std::vector<Vector6d> d = VectorsOf(edge.uncertainty.blocks);
  if (!d.empty()) edge.figures["model_sigma_ratio"] = SigmaRatio(JackknifeCovariance(d), estimate.C_model);
}

std::size_t CountBoth(const StereoProblem& problem, const StereoEstimate& estimate) {
  return static_cast<std::size_t>(
      std::count_if(problem.captures.begin(), problem.captures.end(), [&](const StereoCapture& capture) {
        return estimate.T_a_board.count(capture.capture) > 0 && BothSee(capture, problem.board);
      }));
}

Edge GoodEdge(const StereoProblem& problem, const StereoEstimate& estimate, Uncertainty uncertainty,
              std::vector<Diagnosis> notes) {
  Edge edge = Good(estimate.T_a_b, std::move(uncertainty), std::move(notes), EdgeOf(problem));
  edge.captures = estimate.residuals;
  const std::size_t both = CountBoth(problem, estimate);
  AddNotes(problem, both, edge.diagnoses);
  AddLensSuspicions(problem, estimate, edge.diagnoses);
  AddDisagreement(problem.camera_a, estimate.intrinsics_a, edge.diagnoses);
  AddDisagreement(problem.camera_b, estimate.intrinsics_b, edge.diagnoses);
  AddMetrics(estimate, both, edge);
  AddFiles(problem, edge);
  return edge;
}

// No pose fits, or a good part of the captures contradicts the others.
bool FitsNoOnePose(const StereoProblem& problem, const OrDiagnosis<StereoEstimate>& estimate, double limit_px) {
  if (!estimate) return estimate.error().code == "inconsistent_captures" || estimate.error().code == "no_convergence";
  return !(estimate->rms_px <= limit_px) ||
         CountBoth(problem, *estimate) + kPartCapturesMin <= CountBoth(problem, Select(problem).used);
}

// Of two poses neither is the pair's: what was measured before the move is past, and of after it nothing checks the
// other.
Edge MovedEdge(const StereoProblem& problem, const PairMove& move) {
  Edge edge = FailedEdge(problem, {PairMoved(problem, move)});
  edge.figures["moved_after_idx"] = static_cast<double>(move.last_before_idx);
  edge.figures["moved_from_idx"] = static_cast<double>(move.first_after_idx);
  return edge;
}

Edge Solved(const StereoProblem& problem, std::vector<CameraFit>* fits) {
  if (fits) *fits = FitsOf(problem, nullptr);
  if (auto diagnoses = Observability(problem); !diagnoses.empty()) return FailedEdge(problem, std::move(diagnoses));
  std::vector<Diagnosis> notes;
  const auto estimate = EstimateOrDiagnose(problem, nullptr, &notes);
  const double limit_px = HighestRms_px(problem);
  if (FitsNoOnePose(problem, estimate, limit_px))
    if (const auto move = FindPairMove(problem, limit_px)) return MovedEdge(problem, *move);
  if (!estimate) return FailedEdge(problem, {LensAsCure(problem, estimate.error())});
  if (fits) *fits = FitsOf(problem, &*estimate);
  if (!(estimate->rms_px <= limit_px)) {
    const Diagnosis high = HighResidual(problem, estimate->rms_px, limit_px, WorstOf(*estimate));
    notes.insert(notes.begin(), LensAsCure(problem, high));
    Edge edge = FailedEdge(problem, std::move(notes));
    edge.captures = estimate->residuals;
    edge.figures["rms_px"] = estimate->rms_px;
    return edge;
  }
  auto uncertainty = Jackknife(problem, *estimate);
  if (!uncertainty)
    return FailedEdge(problem, {LensAsCure(problem, IllConditioned(problem, uncertainty.error().what))});
  return GoodEdge(problem, *estimate, std::move(*uncertainty), std::move(notes));
}

// A description that more pictures contradict than bear out is not the board's: what the others would give is of
// chance.
bool ShowsOtherBoard(const StereoProblem& problem) {
  std::ptrdiff_t contradicting = 0, seeing = 0;
  for (const StereoCapture& capture : problem.captures)
    for (const auto* view : {&capture.a, &capture.b}) {
      if (Sees(*view, problem.board))
        ++seeing;
      else if (*view && ShowsOtherLayout(**view))
        ++contradicting;
    }
  return contradicting > seeing;
}

}  // namespace

Edge EstimateEdge(const StereoProblem& problem, std::vector<CameraFit>* fits) {
  const auto estimate = [&](const StereoProblem& chosen) {
    return ShowsOtherBoard(chosen) ? FailedEdge(chosen, {}) : Solved(chosen, fits);
  };
  const auto failed = [&](const Error& error) { return FailedEdge(problem, {FromError(problem, "internal", error)}); };
  return EdgeOfChosen(problem, CapturesOf(problem), SeenByBoth(problem), DropCaptures<StereoProblem>, estimate, failed);
}

}  // namespace rigcal::calib
