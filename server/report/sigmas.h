// How far something is off, counted in its own sigmas: one scale, one limit and one colour for it on every page.
#pragma once

#include <string>

namespace rigcal::report {

inline constexpr double kOff_sigmas = 3.0;  // from here on it is "off", and red

// "fit0" below 1 sigma, "fit1" below 2, "fit2" below 3, "fit3" from there on.
[[nodiscard]] const char* SigmasClass(double in_sigmas);
// One decimal; never rounded up to the limit.
[[nodiscard]] std::string SigmasText(double in_sigmas);

}  // namespace rigcal::report
