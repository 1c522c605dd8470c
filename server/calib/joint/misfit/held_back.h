// Looks that contradict all others and count less than half: of another instant, of another board, or of a sensor that
// was moved; where they are its last, nothing tells which.
#pragma once

#include "server/calib/joint/problem/session_start.h"
#include "server/calib/joint/refine/refine.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::calib::joint {

// By sensor, then capture; once for each look.
[[nodiscard]] std::vector<HeldBackLook> LooksHeldBack(const SessionProblem& problem, const Refined& refined);

// Likewise, of cameras: looks that never were in the problem, as nothing told where their board stood, or as the start
// has it behind the camera.
[[nodiscard]] std::vector<HeldBackLook> LooksLeftOut(const SessionStart& start);

// By sensor: those of whose looks half or more are held back in each of their last captures, and those whose last
// capture is a change that is none of chance (ScanForLateMoves).
[[nodiscard]] std::vector<LateContradiction> LateContradictions(const SessionProblem& problem, const Refined& refined);

}  // namespace rigcal::calib::joint
