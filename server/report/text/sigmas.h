// How far something is off, counted in its own sigmas: one scale, one limit and one colour for it on every page.
#pragma once

#include <string>

#include "server/formats/documents.h"
#include "server/model/robots/robot_summary.h"

namespace rigcal::report {

// What a sensor's sigmas are held against; absent: the revision is from before policies.
[[nodiscard]] std::optional<PoseLimit> ToleranceOf(const formats::RevisionInput& revision, const SensorId& sensor);
// The class, and with it the colour, of every figure that is counted in its own sigmas: "fit0" (blue) below 1, "fit1"
// (teal) below 2, "fit2" (amber) below kOff_sigmas, "fit3" (red) from there on and for what is no number. Of figures
// that are chance alone (normal) one in 3 is beyond 1, one in 22 beyond 2, one in 370 beyond 3: amber is worth a look,
// red is hardly chance. Verdicts have colours of their own (pass, warn, fail), for what the policy makes of it.
// web-static/sigmas.js is the same scale for scripts.
[[nodiscard]] const char* SigmasClass(double in_sigmas);
// One decimal; never rounded up to the limit.
[[nodiscard]] std::string SigmasText(double in_sigmas);

}  // namespace rigcal::report
