// Whether the lenses that a session was refined with are any.
#pragma once

#include <optional>

#include "server/calib/joint/problem/session_problem.h"
#include "server/model/diagnosis.h"

namespace rigcal::calib::joint {

// "absurd_distortion" of the first camera whose refined lens has a number that no lens of its sphere model has, as a
// pair of it would be refused for (calib/camera/lens_bounds.h): what it projects is not what a lens sees.
[[nodiscard]] std::optional<Diagnosis> WhyNoLens(const SessionProblem& problem, const SessionState& state);

}  // namespace rigcal::calib::joint
