// The numbers of a hand-eye problem as they shrink and improve, for hand_eye*.cc.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/calib/motion/camera_motion.h"
#include "server/calib/motion/hand_eye.h"
#include "server/calib/motion/motion_consensus.h"

namespace rigcal::calib {

constexpr std::size_t kHandEyeMin = 4;           // captures of both
constexpr std::size_t kHandEyeForJackknife = 5;  // fewer: the uncertainty is the model's
constexpr std::size_t kHandEyeEnough = 10;       // fewer: a note says so

constexpr int kStreamShared = 4, kStreamOffset = 3;  // count, and where the offset stands

// On the variances that a side's source lets expect.
struct SideFactor {
  double translation = 1.0, rotation = 1.0;
};

struct HandEyeWork {
  std::vector<CaptureId> captures;
  std::vector<MotionCandidates> candidates;  // side by side with the captures; covariances as their sources say
  std::optional<CameraMotion> camera_a, camera_b;
  // Of pose streams side b shares how far its world drifts from the middle of the recording to its end, and the offset
  // of the clocks.
  bool estimates_offset = false;
  std::map<CaptureId, std::string> unused;
  SideFactor factor_a, factor_b;
  std::vector<MotionChoice> choices;
  MotionProblem problem;  // what was chosen, covariances with their factors
  MotionState state;
  MotionReach reach;
  MotionFit fit;
};

// The captures in which both sides have a pose. `unused` says why the others have none.
[[nodiscard]] OrDiagnosis<HandEyeWork> CollectMotion(const HandEyeProblem& problem);
// Sets the shared parameters of both sides, from all captures but those.
void SetShared(const HandEyeWork& work, const std::set<CaptureId>& without, MotionProblem& problem);
// Chooses, solves, finds the noise and what contradicts, until nothing changes. Poses that contradict are not used.
[[nodiscard]] OrDiagnosis<void> FitMotion(const HandEyeProblem& problem, HandEyeWork& work);
[[nodiscard]] MotionNoise NoiseOf(const MotionProblem& problem);

struct MotionUncertainty {
  Uncertainty X;                // along the free directions
  double offset_sigma_s = 0.0;  // where an offset is estimated
};
// `block_of_pose`: which poses are left out together, ascending; empty: each by itself.
[[nodiscard]] Result<MotionUncertainty> JackknifeMotion(const HandEyeProblem& problem, const HandEyeWork& work,
                                                        const std::vector<std::size_t>& block_of_pose);

}  // namespace rigcal::calib
