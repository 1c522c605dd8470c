// The pictures of one camera's fit, as paths of a drawing (camera.tpl): few bytes for many corners.
#pragma once

#include "server/report/cameras/camera_shape.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

inline constexpr std::size_t kVectorsMax = 600;  // drawn, evenly chosen; those beyond three sigma all, up to as many

// How many corners each field of the picture had, as a map.
void FillCoverage(Dictionary& section, const CameraFit& fit);
// Residuals as vectors, magnified alike; a view without a pose draws none.
void FillVectors(Dictionary& section, const CameraFit& fit, const ResidualShape& shape);
// `shape` has kBins bins; beside them the normal distribution.
void FillHistogram(Dictionary& section, const ResidualShape& shape);
// How the boards stood, tilt and distance; nothing is shown without a view that has a pose.
void FillStand(Dictionary& section, const CameraFit& fit);

// 1, 2 or 5 times a power of ten, at or below `value`; 1 of what is not positive.
[[nodiscard]] double NiceBelow(double value);

}  // namespace rigcal::report
