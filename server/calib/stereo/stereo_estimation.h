// The estimate, or the diagnosis of why there is none.
#pragma once

#include <tl/expected.hpp>

#include "server/calib/stereo/stereo.h"

namespace rigcal::calib {

// As Estimate() of stereo.h. What was left out on the way (contradicting or ambiguous captures) has its reason in
// `estimate.residuals`, and its diagnosis in `notes` if that is not null.
[[nodiscard]] tl::expected<StereoEstimate, Diagnosis> EstimateOrDiagnose(const StereoProblem& problem,
                                                                         const StereoEstimate* start,
                                                                         std::vector<Diagnosis>* notes);

}  // namespace rigcal::calib
