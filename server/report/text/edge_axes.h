// Uncertainty of an edge in words: sigma per axis, "free" where nothing was observed.
#pragma once

#include <string>

#include "server/model/edges/edge.h"

namespace rigcal::report {

[[nodiscard]] std::string AxisSigmaText(const Uncertainty& uncertainty, int axis);  // mm, deg or "free"
// Of the three axes from `first_axis` on; names the free ones: "0.21", "0.21, free: rz", "free". `unit` follows the
// number.
[[nodiscard]] std::string LargestSigma(const Uncertainty& uncertainty, int first_axis, const std::string& unit = "");
// "0.21 / 0.30 / free" of the three axes from `first_axis` on.
[[nodiscard]] std::string ThreeSigmas(const Uncertainty& uncertainty, int first_axis);
// The largest known of them, in mm or deg as a plain number to sort by; empty if all are free.
[[nodiscard]] std::string SigmaKey(const Uncertainty& uncertainty, int first_axis);
// "All 6 directions are observed, ..." or what is free; and where sigma comes from.
[[nodiscard]] std::string ObservabilityText(const Edge& edge);

}  // namespace rigcal::report
