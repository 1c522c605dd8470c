// The lenses that a session was refined with, and whether they are any.
#pragma once

#include <optional>

#include "server/calib/joint/refine/refine.h"
#include "server/model/diagnosis.h"
#include "server/model/sensors/refined_lens.h"

namespace rigcal::calib::joint {

// "absurd_distortion" of the first camera whose refined lens has a number that no lens of its sphere model has, as a
// pair of it would be refused for (calib/camera/lens_bounds.h): what it projects is not what a lens sees.
[[nodiscard]] std::optional<Diagnosis> WhyNoLens(const SessionProblem& problem, const SessionState& state);

// By camera: those with refined numbers; of a lens that changed the one that was looked through last. `covariance`: of
// all unknowns of the layout.
[[nodiscard]] std::vector<RefinedLens> LensesTold(const SessionProblem& problem, const Refined& refined,
                                                  const Eigen::MatrixXd& covariance);

}  // namespace rigcal::calib::joint
