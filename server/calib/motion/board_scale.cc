#include <cmath>

#include "server/calib/motion/hand_eye_work.h"

namespace rigcal::calib {
namespace {

constexpr int kRounds = 4;
constexpr double kSame_ratio = 1e-6;
// A board of half its size or twice as large is another mistake than one of measuring it, and a scale that is known no
// better than this says nothing.
constexpr double kScaleMax_ratio = 0.5, kScaleSigmaMax_ratio = 0.05;
constexpr double kSuspectedFrom_ratio = 0.01, kSuspectedFrom_sigmas = 4.0;

const std::optional<CameraMotion>& CameraOf(const HandEyeWork& work) {
  return work.camera_a ? work.camera_a : work.camera_b;
}

// A pull that holds the focal length leaves no pose that depends on it.
bool DoubtsFocal(const Sensor& sensor, const CameraMotion& camera) {
  return sensor.intrinsics && (!camera.camera.pull.Pulls() || camera.camera.pull.sigma[0] > 0);
}

// What the poses share so far, a given focal length that is longer by a part of it, and a larger board.
SharedJacobian SharedWithSize(const CameraMotion& camera, bool doubts_focal, const SidePose& pose) {
  const Eigen::Index own = camera.estimates_intrinsics ? pose.d_shared.cols() : 0;
  SharedJacobian shared(6, own + (doubts_focal ? 2 : 1));
  shared.leftCols(own) = pose.d_shared.leftCols(own);
  if (doubts_focal)
    shared.col(own) =
        camera.camera.intrinsics.fx_px * pose.d_shared.col(0) + camera.camera.intrinsics.fy_px * pose.d_shared.col(1);
  shared.rightCols<1>() << pose.T_world_sensor.R().transpose() * pose.T_world_sensor.p_m, Eigen::Vector3d::Zero();
  return shared;
}

// On a board that is larger by `ratio`.
SidePose Enlarged(SidePose pose, double ratio) {
  const Vector6d larger = EachAxis(1 + ratio, 1.0);
  pose.T_world_sensor.p_m *= 1 + ratio;
  pose.covariance = larger.asDiagonal() * pose.covariance * larger.asDiagonal();
  pose.d_shared = larger.asDiagonal() * pose.d_shared;
  return pose;
}

std::vector<MotionCandidates> Enlarged(const HandEyeProblem& problem, const HandEyeWork& work, double ratio) {
  const CameraMotion& camera = *CameraOf(work);
  const bool doubts_focal = DoubtsFocal(SideWithBoard(problem).sensor, camera);
  std::vector<MotionCandidates> enlarged = work.candidates;
  for (MotionCandidates& capture : enlarged)
    for (PoseCandidate& candidate : work.camera_a ? capture.a : capture.b) {
      candidate.pose = Enlarged(std::move(candidate.pose), ratio);
      candidate.pose.d_shared = SharedWithSize(camera, doubts_focal, candidate.pose);
    }
  return enlarged;
}

}  // namespace

bool BoardScale::Contradicts(const Target& board) const {
  const double sigma = std::hypot(sigma_ratio, board.square_sigma_m / board.square_m);
  return std::abs(ratio) > kSuspectedFrom_ratio && std::abs(ratio) > kSuspectedFrom_sigmas * sigma;
}

const HandEyeSide& SideWithBoard(const HandEyeProblem& problem) { return problem.a.board ? problem.a : problem.b; }

std::optional<BoardScale> FitBoardScale(const HandEyeProblem& problem, const HandEyeWork& work) {
  if (work.camera_a.has_value() == work.camera_b.has_value() || work.problem.UsedCount() < kHandEyeEnough)
    return std::nullopt;
  HandEyeWork sized = work;
  sized.asked = work.camera_a ? Asked::kBoardSizeA : Asked::kBoardSizeB;
  BoardScale scale;
  for (int round = 0; round < kRounds; ++round) {
    sized.candidates = Enlarged(problem, work, scale.ratio);
    if (!FitMotion(problem, sized)) return std::nullopt;
    const double step_ratio = AskedOf(sized, sized.state);
    scale.ratio = (1 + scale.ratio) * (1 + step_ratio) - 1;
    if (!(std::abs(scale.ratio) < kScaleMax_ratio)) return std::nullopt;
    if (std::abs(step_ratio) < kSame_ratio) break;
  }
  const auto uncertainty = JackknifeMotion(problem, sized, {});
  if (!uncertainty || !(uncertainty->asked_sigma < kScaleSigmaMax_ratio)) return std::nullopt;
  scale.sigma_ratio = uncertainty->asked_sigma;
  return scale;
}

}  // namespace rigcal::calib
