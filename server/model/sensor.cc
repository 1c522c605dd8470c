#include <algorithm>
#include <cmath>

#include "server/model/session.h"

namespace rigcal {
namespace {

constexpr std::size_t kIntrinsicsCount = 9;  // fx fy cx cy k1 k2 p1 p2 k3

Status Refuse(const Sensor& sensor, const std::string& what, const std::string& cure) {
  return Fail(ErrorCode::kInvalidInput, "sensor " + sensor.id.str() + ": " + what, cure);
}

Status CheckKind(const Sensor& sensor) {
  if (sensor.kind == SensorKind::kCamera) return {};
  return Fail(ErrorCode::kUnsupported,
              "sensor " + sensor.id.str() + ": kind " + NameOf(sensor.kind) + " is not supported",
              "This version calibrates sensors of kind camera; leave the sensor away.");
}

Status CheckIntrinsics(const Sensor& sensor) {
  if (!sensor.intrinsics) return {};
  const PinholeRadtan& camera = *sensor.intrinsics;
  for (double focal_px : {camera.fx_px, camera.fy_px})
    if (!(focal_px > 0.0 && std::isfinite(focal_px)))
      return Refuse(sensor, "intrinsics: a focal length is not positive", "Give fx and fy in pixels.");
  const bool finite = std::isfinite(camera.cx_px) && std::isfinite(camera.cy_px) &&
                      std::all_of(camera.distortion.begin(), camera.distortion.end(),
                                  [](double coefficient) { return std::isfinite(coefficient); });
  if (!finite) return Refuse(sensor, "intrinsics: a value is not finite", "Give cx, cy in pixels and k1 k2 p1 p2 k3.");
  return {};
}

Status CheckIntrinsicsSigma(const Sensor& sensor) {
  if (!sensor.intrinsics_sigma) return {};
  const std::vector<double>& sigma = *sensor.intrinsics_sigma;
  if (!sensor.intrinsics)
    return Refuse(sensor, "intrinsics_sigma is given without intrinsics", "Give both, or leave both away.");
  const bool good = sigma.size() == kIntrinsicsCount && std::all_of(sigma.begin(), sigma.end(), [](double value) {
                      return value >= 0.0 && std::isfinite(value);
                    });
  if (!good)
    return Refuse(sensor, "intrinsics_sigma is not 9 finite numbers >= 0",
                  "Give one standard deviation each for fx fy cx cy k1 k2 p1 p2 k3.");
  return {};
}

Status CheckNominalPose(const Sensor& sensor) {
  constexpr double kUnitTolerance = 1e-6;
  if (!sensor.T_ref_nominal) return {};
  const Se3& T = *sensor.T_ref_nominal;
  if (!T.p_m.allFinite()) return Refuse(sensor, "nominal p_m is not finite", "Give 3 finite numbers in metres.");
  if (!(std::abs(T.q.norm() - 1.0) <= kUnitTolerance))
    return Refuse(sensor, "nominal q_xyzw is not a unit quaternion", "Normalise it; the order is x y z w.");
  return {};
}

}  // namespace

Status Validate(const Sensor& sensor) {
  RIGCAL_TRY(CheckName(SensorTag::kKind, sensor.id.str()));
  RIGCAL_TRY(CheckKind(sensor));
  RIGCAL_TRY(CheckIntrinsics(sensor));
  RIGCAL_TRY(CheckIntrinsicsSigma(sensor));
  return CheckNominalPose(sensor);
}

}  // namespace rigcal
