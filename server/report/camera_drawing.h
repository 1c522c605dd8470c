// The pictures of one camera's fit, as paths of a drawing (camera.tpl): few bytes for many corners.
#pragma once

#include "server/report/camera_shape.h"
#include "server/report/page.h"

namespace rigcal::report {

inline constexpr std::size_t kVectorsMax = 600;  // drawn, evenly chosen; those beyond three sigma all, up to as many

void FillCoverage(Dictionary& section, const CameraFit& fit);
void FillVectors(Dictionary& section, const CameraFit& fit, const ResidualShape& shape);
void FillHistogram(Dictionary& section, const ResidualShape& shape);
void FillStand(Dictionary& section, const CameraFit& fit);

// 1, 2 or 5 times a power of ten, at or below `value`; 1 of what is not positive.
[[nodiscard]] double NiceBelow(double value);

}  // namespace rigcal::report
