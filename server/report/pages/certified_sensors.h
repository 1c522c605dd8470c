// The sensors on a certificate: pose, how certain it is beside the limits, and the interval that holds it.
#pragma once

#include <optional>

#include "server/report/frame/page.h"
#include "server/report/render.h"

namespace rigcal::report {

// k of U = k sigma, the half-width of the interval that holds the value with a probability of 95 %: of Student's t by
// the degrees of freedom behind the pose's covariance (JCGM 100:2008 (GUM), 6.2 and G.3). Absent where those are not
// known, and of the reference.
[[nodiscard]] std::optional<double> CoverageFactor(const SensorPose& pose);

// SENSOR, the limits and what is left out: of more sensors than a page has room for, the least certain.
void FillCertifiedSensors(Dictionary& page, const ReportInput& input);

}  // namespace rigcal::report
