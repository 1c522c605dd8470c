// A camera whose lens changed during the session, focused anew or zoomed: before boards at one distance that looks like
// a move along the line of sight, (1 + ratio) f for z / (1 + ratio).
#pragma once

#include <optional>

#include "server/calib/joint/problem/session_start.h"
#include "server/calib/joint/refine/refine.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::calib::joint {

// Looks by `sensor`, under whichever of its poses, from `group` of captures on become those through another lens than
// before, the last of the problem's cameras, started from what is refined: focal lengths and principal point of its
// own, within 5 % and 0.5 % of the picture's width, and the distortion of the one before, as well as that is known.
// Nothing where the sensor took no picture before, or its size is not known.
[[nodiscard]] std::optional<SessionStart> WithSecondLens(SessionStart start, const Refined& refined, int sensor,
                                                         int group);

// By how much the last lens of the problem, refined, is longer than that of the same sensor's looks before.
[[nodiscard]] FocalChange FocalChangeOf(const SessionProblem& problem, const Refined& split);

}  // namespace rigcal::calib::joint
