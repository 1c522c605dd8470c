#include "server/calib/motion/hand_eye.h"

#include <algorithm>
#include <cmath>

#include "server/calib/camera/camera_diagnoses.h"
#include "server/calib/motion/hand_eye_work.h"
#include "server/calib/motion/stream_motion.h"

namespace rigcal::calib {
namespace {

// What a stream's poses are taken to be good for until their residuals say.
constexpr double kStreamSigma_m = 0.005, kStreamSigma_rad = 0.005;
constexpr double kCorrelationLeast_ratio = 0.3;
constexpr int kOffsetRoundsMax = 6;
constexpr double kOffsetSame_s = 1e-5;
constexpr std::size_t kStreamBlocks = 20;  // stretches of time that are left out one at a time
constexpr std::size_t kStreamSamplesMin = 2 * kStreamBlocks;

SideNoise SideNoiseOf(const MotionSide& side, const std::vector<char>& used, double factor) {
  const MotionNoise noise = NoiseOf({&side}, used);
  return {noise.translation_m, noise.rotation_rad, factor};
}

HandEyeEstimate EstimateOf(const HandEyeWork& work) {
  HandEyeEstimate estimate;
  estimate.T_a_b = work.state.X;
  estimate.T_world_a_world_b = work.state.Z;
  estimate.reach = work.reach;
  estimate.noise_a = SideNoiseOf(work.problem.a, work.problem.used, work.factor_a.translation);
  estimate.noise_b = SideNoiseOf(work.problem.b, work.problem.used, work.factor_b.translation);
  estimate.unused = work.unused;
  estimate.captures = work.problem.UsedCount();
  double sum_m2 = 0, sum_rad2 = 0;
  for (std::size_t k = 0; k < work.captures.size(); ++k) {
    const Vector6d r = MotionResidual(work.problem, work.state, k);
    if (!work.problem.used[k]) {
      estimate.unused[work.captures[k]] = "contradicts the other captures";
      continue;
    }
    estimate.residuals[work.captures[k]] = r;
    sum_m2 += r.head<3>().squaredNorm();
    sum_rad2 += r.tail<3>().squaredNorm();
  }
  const double count = static_cast<double>(std::max<std::size_t>(1, estimate.captures));
  estimate.rms_m = std::sqrt(sum_m2 / count);
  estimate.rms_rad = std::sqrt(sum_rad2 / count);
  return estimate;
}

void AddDisagreement(const HandEyeSide& side, const std::optional<CameraMotion>& camera,
                     std::vector<Diagnosis>& notes) {
  if (!camera) return;
  if (auto why = WhyGivenDisagree(side.sensor, camera->camera.intrinsics)) notes.push_back(std::move(*why));
}

OrDiagnosis<HandEyeResult> ResultOf(const HandEyeProblem& problem, const HandEyeWork& work,
                                    const std::vector<std::size_t>& block_of_pose) {
  auto uncertainty = JackknifeMotion(problem, work, block_of_pose);
  if (!uncertainty) return tl::unexpected(MotionNotSolvable(problem, uncertainty.error()));
  HandEyeResult result{EstimateOf(work), std::move(uncertainty->X), OpenDirections(problem, work.reach), {}, {}};
  if (work.camera_a) result.camera_a = work.camera_a->camera;
  if (work.camera_b) result.camera_b = work.camera_b->camera;
  if (work.asked == Asked::kClockOffset) result.estimate.offset_sigma_s = uncertainty->asked_sigma;
  AddDisagreement(problem.a, work.camera_a, result.notes);
  AddDisagreement(problem.b, work.camera_b, result.notes);
  return result;
}

OrDiagnosis<HandEyeResult> FromCaptures(const HandEyeProblem& problem) {
  auto work = CollectMotion(problem);
  if (!work) return tl::unexpected(work.error());
  if (auto fitted = FitMotion(problem, *work); !fitted) return tl::unexpected(fitted.error());
  if (2 * work->problem.UsedCount() < work->captures.size())
    return tl::unexpected(MotionsContradict(problem, work->captures.size()));
  auto result = ResultOf(problem, *work, {});
  if (!result) return result;
  result->estimate.board_scale = FitBoardScale(problem, *work);
  std::vector<CaptureId> contradicting;
  for (std::size_t k = 0; k < work->captures.size(); ++k)
    if (!work->problem.used[k]) contradicting.push_back(work->captures[k]);
  if (!contradicting.empty()) result->notes.push_back(CapturesContradict(problem, contradicting));
  return result;
}

std::string SampleName(std::size_t k) {
  std::string digits = std::to_string(k);
  return std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits;
}

// Odometry drifts: b's world moves against a's in proportion to time, from the left of its poses. A larger offset looks
// at b earlier.
SharedJacobian SharedOf(const CommonPoses& common, std::size_t k) {
  const double middle_s = (common.times_s.front() + common.times_s.back()) / 2;
  const double half_s = std::max(1e-9, (common.times_s.back() - common.times_s.front()) / 2);
  const Matrix6d from_left = Adjoint(common.b[k].T_world_body.Inverse());
  SharedJacobian shared(6, kStreamShared);
  shared << (common.times_s[k] - middle_s) / half_s * from_left.leftCols<3>(), -common.b[k].twist;
  return shared;
}

void SetSamples(const CommonPoses& common, HandEyeWork& work) {
  work.captures.clear();
  work.candidates.clear();
  const Matrix6d covariance =
      EachAxis(kStreamSigma_m * kStreamSigma_m, kStreamSigma_rad * kStreamSigma_rad).asDiagonal();
  for (std::size_t k = 0; k < common.a.size(); ++k) {
    work.captures.emplace_back(SampleName(k));
    MotionCandidates sample;
    sample.a.push_back({{common.a[k], covariance, SharedJacobian(6, 0)}});
    sample.b.push_back({{common.b[k].T_world_body, covariance, SharedOf(common, k)}});
    work.candidates.push_back(std::move(sample));
  }
}

// Contiguous stretches with equally many samples.
std::vector<std::size_t> BlocksOf(std::size_t samples) {
  std::vector<std::size_t> blocks;
  for (std::size_t k = 0; k < samples; ++k) blocks.push_back(k * kStreamBlocks / samples);
  return blocks;
}

OrDiagnosis<HandEyeResult> FromStreams(const HandEyeProblem& problem) {
  const PoseTable &a = problem.a.poses, &b = problem.b.poses;
  const auto clocks = CorrelateClocks(a, b);
  if (!clocks || clocks->correlation_ratio < kCorrelationLeast_ratio)
    return tl::unexpected(NoCommonTime(problem, clocks ? clocks->correlation_ratio : 0.0));
  double offset_s = clocks->offset_s;
  HandEyeWork work;
  work.asked = Asked::kClockOffset;
  for (int round = 0; round < kOffsetRoundsMax; ++round) {
    SetSamples(PosesInCommon(a, b, offset_s), work);
    if (work.captures.size() < kStreamSamplesMin)
      return tl::unexpected(
          TooFewSamples(problem, work.captures.size(), kStreamSamplesMin, SecondsInCommon(a, b, offset_s)));
    if (auto fitted = FitMotion(problem, work); !fitted) return tl::unexpected(fitted.error());
    const double shift_s = AskedOf(work, work.state);
    offset_s += shift_s;
    if (std::abs(shift_s) < kOffsetSame_s) break;
  }
  if (2 * work.problem.UsedCount() < work.captures.size())
    return tl::unexpected(MotionsContradict(problem, work.captures.size()));
  auto result = ResultOf(problem, work, BlocksOf(work.captures.size()));
  if (!result) return result;
  result->estimate.offset_s = offset_s + 1e-9 * static_cast<double>(a.front().stamp.ns - b.front().stamp.ns);
  return result;
}

}  // namespace

OrDiagnosis<HandEyeResult> EstimateHandEye(const HandEyeProblem& problem) {
  return problem.method == Method::kPoseStreams ? FromStreams(problem) : FromCaptures(problem);
}

}  // namespace rigcal::calib
