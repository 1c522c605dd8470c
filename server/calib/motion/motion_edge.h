// What the finished edges of all pairs that motion tells share: hand-eye, and eye-to-hand, whose problem is the same
// with the roles exchanged.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/calib/motion/hand_eye.h"

namespace rigcal::calib {

// Of which a side has a picture or a pose.
[[nodiscard]] std::set<CaptureId> CapturesOfSides(const HandEyeProblem& problem);
// Takes captures out of both sides.
void DropFromSides(HandEyeProblem& problem, const std::set<CaptureId>& left_out);

// By the problem's method; of pose streams, which have no captures, nothing tells how many there are.
[[nodiscard]] Edge UnsolvedMotionEdge(const HandEyeProblem& problem);
// Why, behind positions that look like millimetres and before what pictures do not show.
[[nodiscard]] Edge FailedMotionEdge(const HandEyeProblem& problem, std::vector<Diagnosis> why);

// What the files of both sides hold (AddFilesFound); of pose streams nothing.
void AddFilesOfSides(const HandEyeProblem& problem, Edge& edge);
// The residual of each capture in the unit of the method, or why it was not used.
void AddCapturesOfSides(const HandEyeProblem& problem,
                        const std::function<std::optional<double>(const CaptureId&)>& residual,
                        const std::map<CaptureId, std::string>& unused, Edge& edge);

// "motion_rms_m", "noise_a_m", "board_scale_ratio", ...; units last.
struct MotionMetrics {
  double rms_m = 0.0, rms_rad = 0.0;  // of Log((Z B)^-1 A X)
  SideNoise noise_a, noise_b;
  const MotionReach& reach;
  std::optional<BoardScale> board_scale;
};
void AddMotionMetrics(const HandEyeProblem& problem, const MotionMetrics& metrics, Edge& edge);

}  // namespace rigcal::calib
