// The calibrations of a robot one after the other (model/robots/calibration_series.h): read from its revisions when its
// summary is made, kept in the summary as a short text.
#pragma once

#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/model/robots/calibration_series.h"
#include "storage/store.h"

namespace rigcal::storage {

// Of the newest revisions, however many there are: a bounded number is looked at.
[[nodiscard]] Result<std::vector<CalibrationPoint>> LoadCalibrations(Store& store, const RobotId& robot);

// "1769860800 420,1777291200 -": seconds since 1970, and thousandths of a sigma or "-". Empty: none.
[[nodiscard]] std::string TextOfCalibrations(const std::vector<CalibrationPoint>& points);
// Back, to the second and the thousandth; up to the first part that is none.
[[nodiscard]] std::vector<CalibrationPoint> CalibrationsOfText(const std::string& text);

}  // namespace rigcal::storage
