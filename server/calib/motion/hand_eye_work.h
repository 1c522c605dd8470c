// The numbers of a hand-eye problem as they shrink and improve, for hand_eye*.cc.
#pragma once

#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/calib/motion/camera_motion.h"
#include "server/calib/motion/hand_eye.h"
#include "server/calib/motion/motion_consensus.h"

namespace rigcal::calib {

static_assert(RowOf(Method::kNonOverlapping).captures == RowOf(Method::kTrackerCamera).captures);
constexpr std::size_t kHandEyeMin = RowOf(Method::kTrackerCamera).captures.least;  // captures of both
constexpr std::size_t kHandEyeForJackknife = 5;  // fewer: the uncertainty is the model's
constexpr std::size_t kHandEyeEnough = RowOf(Method::kTrackerCamera).captures.enough;  // fewer: a note says so

constexpr int kStreamShared = 4;

// What is asked for beside X and Z, as the last shared parameter of a side: of pose streams the offset of their clocks
// (b), of a camera how much larger its board is than given.
enum class Asked { kNothing, kClockOffset, kBoardSizeA, kBoardSizeB };

// On the variances that a side's source lets expect.
struct SideFactor {
  double translation = 1.0, rotation = 1.0;
};

struct HandEyeWork {
  std::vector<CaptureId> captures;
  std::vector<MotionCandidates> candidates;  // side by side with the captures; covariances as their sources say
  std::optional<CameraMotion> camera_a, camera_b;
  // Of pose streams side b shares how far its world drifts from the middle of the recording to its end, too.
  Asked asked = Asked::kNothing;
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
// Of the poses used, one sigma per axis; of several sides together, all `used` long.
[[nodiscard]] MotionNoise NoiseOf(std::initializer_list<const MotionSide*> sides, const std::vector<char>& used);
// Zero where nothing is asked for.
[[nodiscard]] double AskedOf(const HandEyeWork& work, const MotionState& state);

struct MotionUncertainty {
  Uncertainty X;             // along the free directions
  double asked_sigma = 0.0;  // of what is asked for beside it
};
// `block_of_pose`: which poses are left out together, ascending; empty: each by itself.
[[nodiscard]] Result<MotionUncertainty> JackknifeMotion(const HandEyeProblem& problem, const HandEyeWork& work,
                                                        const std::vector<std::size_t>& block_of_pose);

// board_scale.cc: of a camera and a tracker, from what FitMotion() made of them.
//
// A camera measures its way in squares of its board: where these are larger by r than given, it is (1 + r) times as far
// from the board's origin as it seems, and A_k X = Z B_k holds with that on its side; of the motion from one capture to
// another, with the camera as b, (R_A - I) t_X = (1 + r) R_X t_B - t_A. r is one more unknown of the same problem, its
// sigma by the same blocks. Given focal lengths are not relied on, as wrong ones make a camera's way longer, too.
// Nothing where both sides are of one kind, where captures are few, or where the motion does not tell.
[[nodiscard]] std::optional<BoardScale> FitBoardScale(const HandEyeProblem& problem, const HandEyeWork& work);
// Of a camera and a tracker, the camera.
[[nodiscard]] const HandEyeSide& SideWithBoard(const HandEyeProblem& problem);

// hand_eye_diagnoses.cc: the sentences. Each names the sensors and captures it is about, and what to do.
//
// `both`: captures with a pose each, those that repeat another left out; `repeated`: how many those are.
[[nodiscard]] Diagnosis TooFewMotions(const HandEyeProblem& problem, std::size_t both, std::size_t repeated);
// Of pose streams: places of the path at which both have a pose, in the time that both recorded.
[[nodiscard]] Diagnosis TooFewSamples(const HandEyeProblem& problem, std::size_t samples, std::size_t needed,
                                      double common_s);
[[nodiscard]] Diagnosis FewMotions(const HandEyeProblem& problem, std::size_t used);  // a note
// A camera that gives no poses: its own diagnosis, and for which pair.
[[nodiscard]] Diagnosis CameraFailed(const HandEyeProblem& problem, const HandEyeSide& side, const Diagnosis& why);
[[nodiscard]] Diagnosis MotionsContradict(const HandEyeProblem& problem, std::size_t captures);
[[nodiscard]] Diagnosis CapturesContradict(const HandEyeProblem& problem, const std::vector<CaptureId>& captures);
[[nodiscard]] Diagnosis MotionNotSolvable(const HandEyeProblem& problem, const Error& error);
[[nodiscard]] Diagnosis HighMotionResidual(const HandEyeProblem& problem, const HandEyeEstimate& estimate);
[[nodiscard]] Diagnosis MotionOfOtherSize(const HandEyeProblem& problem, const BoardScale& scale);
[[nodiscard]] Diagnosis NoMotion(const HandEyeProblem& problem);
// Codes "planar_motion", "turning_on_the_spot", "pure_translation", "straight_line": notes on a good edge that say
// which direction is not known. Nothing where all are.
[[nodiscard]] std::vector<Diagnosis> OpenDirections(const HandEyeProblem& problem, const MotionReach& reach);
// "board_layout", "picture_unreadable", "board_not_found": of the cameras.
[[nodiscard]] std::vector<Diagnosis> MissedViews(const HandEyeProblem& problem);
// Constants that were given without a sigma: notes on a good edge.
[[nodiscard]] std::vector<Diagnosis> TakenAsExact(const HandEyeProblem& problem);
// Two pose streams whose turns have nothing in common: too short, too still, or not of the same time.
[[nodiscard]] Diagnosis NoCommonTime(const HandEyeProblem& problem, double correlation_ratio);

}  // namespace rigcal::calib
