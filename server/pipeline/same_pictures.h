// Captures in which two sensors have one and the same file: a copying mistake, and no measurement.
#pragma once

#include <vector>

#include "server/calib/stereo/stereo.h"

namespace rigcal::pipeline {

// By the digests of the manifest; in the manifest's order.
[[nodiscard]] std::vector<CaptureId> SamePictures(const Manifest& manifest, const SensorPair& pair);
void LeaveOut(const std::vector<CaptureId>& same, calib::StereoProblem& problem);
// The edge says which captures were left out ("same_picture") and lists them as not used. Nothing if `same` is empty.
void TellLeftOut(const std::vector<CaptureId>& same, Edge& edge);

}  // namespace rigcal::pipeline
