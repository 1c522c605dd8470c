#include "server/model/robots/calibration_series.h"

#include <algorithm>

namespace rigcal {

std::vector<CalibrationPoint> CalibrationsOf(const std::vector<CalibrationPoint>& newest_first) {
  std::vector<CalibrationPoint> points;
  for (const CalibrationPoint& point : newest_first) {
    if (points.size() == kCalibrationsListedMax) break;
    if (points.empty() || point.calibrated_at.ns < points.back().calibrated_at.ns) points.push_back(point);
  }
  std::reverse(points.begin(), points.end());
  return points;
}

}  // namespace rigcal
