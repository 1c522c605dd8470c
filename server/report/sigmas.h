// How far something is off, counted in its own sigmas: one scale, one limit and one colour for it on every page.
#pragma once

#include <string>

#include "server/formats/documents.h"
#include "server/model/robot_summary.h"

namespace rigcal::report {

// What a sensor's sigmas are held against; absent: the revision is from before policies.
[[nodiscard]] std::optional<PoseLimit> ToleranceOf(const formats::RevisionInput& revision, const SensorId& sensor);
// "fit0" below 1 sigma, "fit1" below 2, "fit2" below kOff_sigmas, "fit3", which is red, from there on.
[[nodiscard]] const char* SigmasClass(double in_sigmas);
// One decimal; never rounded up to the limit.
[[nodiscard]] std::string SigmasText(double in_sigmas);

}  // namespace rigcal::report
