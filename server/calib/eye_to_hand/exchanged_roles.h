// Eye-to-hand as a hand-eye problem and back: which poses go in, what its answer means.
#pragma once

#include <set>
#include <string>

#include "server/calib/eye_to_hand/eye_to_hand.h"

namespace rigcal::calib {

// The robot's poses inverted. The base is taken at the middle of the places of its flange (the anchor, axes as the
// base's): there a turn of the flange that is told wrong does not look like a long way of the base.
struct ExchangedRoles {
  HandEyeProblem hand_eye;
  Se3 T_base_anchor;
  bool tracker_is_a = false;
};
// Exactly one side is a camera.
[[nodiscard]] ExchangedRoles WithRolesExchanged(const HandEyeProblem& problem);

// The edge's T_a_b from that of the exchanged problem.
[[nodiscard]] Se3 EdgePose(const ExchangedRoles& roles, const Se3& T_a_b);
[[nodiscard]] Se3 FlangeBoard(const ExchangedRoles& roles, const Se3& T_world_a_world_b);
// In the edge's right tangent at b: X Exp(d) T_anchor_base = X T_anchor_base Exp(Ad(T_base_anchor) d) where b is the
// base.
[[nodiscard]] Uncertainty EdgeUncertainty(const ExchangedRoles& roles, Uncertainty uncertainty);

// The camera's side, and the tracker's.
[[nodiscard]] const HandEyeSide& CameraOf(const HandEyeProblem& problem);
[[nodiscard]] const HandEyeSide& FlangeOf(const HandEyeProblem& problem);

// Captures with a pose of the flange and the board in the picture.
[[nodiscard]] std::set<CaptureId> WithPoseAndBoard(const HandEyeProblem& problem);

// other_reading.cc: whether it was not the noise that made a pair fail, but what was said of its board.
//
// Whether residuals of a motion are noise: beyond 0.1 m or 0.05 rad something is wrong.
[[nodiscard]] bool IsWithinNoise(double rms_m, double rms_rad);
// Of a failed pair's diagnosis: it may follow from the wrong reading.
[[nodiscard]] bool MayBeReadOtherwise(const std::string& code);
// Whether most captures agree with the tracker on one body with the camera, and all of the pose is told.
[[nodiscard]] bool FitsBoardThatStandsStill(HandEyeProblem problem);

// eye_to_hand_diagnoses.cc: the sentences that are not those of hand-eye.
//
// What hand-eye says, with cures for a robot that carries a board.
[[nodiscard]] Diagnosis OfFlange(Diagnosis diagnosis);
// "planar_motion", "turning_on_the_spot", "pure_translation", "straight_line". Nothing where all is known.
[[nodiscard]] std::vector<Diagnosis> OpenOfFlange(const HandEyeProblem& problem, const MotionReach& reach);
[[nodiscard]] Diagnosis FewOfFlange(const HandEyeProblem& problem, std::size_t used);  // a note
// Of an eye-to-hand pair: its board does not move with the flange.
[[nodiscard]] Diagnosis BoardStandsStill(const HandEyeProblem& problem);
// Of a tracker and a camera on one body: the board moves with the tracker.
[[nodiscard]] Diagnosis BoardOnFlange(const HandEyeProblem& problem);

}  // namespace rigcal::calib
