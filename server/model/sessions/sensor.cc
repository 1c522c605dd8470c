#include <algorithm>
#include <cmath>
#include <utility>

#include "server/base/text.h"
#include "server/model/plausible.h"
#include "server/model/sessions/session.h"

namespace rigcal {
namespace {

Status Refuse(const Sensor& sensor, const std::string& what, const std::string& cure) {
  return Fail(ErrorCode::kInvalidInput, "sensor " + sensor.id.str() + ": " + what, cure);
}

// What a kind of sensor does not have would be believed and have no effect.
Status CheckKind(const Sensor& sensor) {
  const std::string kind =
      "a " + std::string(sensor.kind == SensorKind::kPoseStream ? "pose stream" : NameOf(sensor.kind));
  const bool looks = sensor.kind == SensorKind::kCamera || sensor.kind == SensorKind::kLidar;
  if (sensor.kind != SensorKind::kCamera && (sensor.intrinsics || sensor.intrinsics_sigma))
    return Refuse(sensor, kind + " has no intrinsics", "Leave 'intrinsics' away.");
  if (sensor.kind != SensorKind::kLidar && sensor.layout)
    return Refuse(sensor, kind + " has no clouds", "Leave 'fields' and 'point_type' away.");
  if (!looks && sensor.sees) return Refuse(sensor, kind + " sees no target", "Leave 'sees' away.");
  return {};
}

std::string NamesOf(CameraModel model) {
  std::string names;
  for (const std::string& name : DistortionNames(model)) names += (names.empty() ? "" : " ") + name;
  return names;
}

Status CheckIntrinsics(const Sensor& sensor) {
  if (!sensor.intrinsics) return {};
  const CameraIntrinsics& camera = *sensor.intrinsics;
  for (double focal_px : {camera.fx_px, camera.fy_px})
    if (!(focal_px > 0.0 && std::isfinite(focal_px)))
      return Refuse(sensor, "intrinsics: a focal length is not positive", "Give fx and fy in pixels.");
  for (double value_px : {camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px})
    if (std::abs(value_px) > kFocalMax_px)
      return Refuse(sensor, "intrinsics: a value is beyond a million pixels", "Give fx, fy, cx and cy in pixels.");
  if (camera.model != sensor.camera_model || camera.distortion.size() != DistortionCount(camera.model))
    return Refuse(sensor, "intrinsics: distortion does not fit the model " + NameOf(sensor.camera_model),
                  "Give " + NamesOf(sensor.camera_model) + ".");
  const bool finite = std::isfinite(camera.cx_px) && std::isfinite(camera.cy_px) &&
                      std::all_of(camera.distortion.begin(), camera.distortion.end(),
                                  [](double coefficient) { return std::isfinite(coefficient); });
  if (!finite)
    return Refuse(sensor, "intrinsics: a value is not finite",
                  "Give cx, cy in pixels and " + NamesOf(camera.model) + ".");
  const std::string why = WhyNoSphere(camera);
  if (!why.empty())
    return Refuse(sensor, "intrinsics: " + why,
                  "Give " + NamesOf(camera.model) + " in this order, as the calibration of this lens has them.");
  return {};
}

Status CheckIntrinsicsSigma(const Sensor& sensor) {
  if (!sensor.intrinsics_sigma) return {};
  const std::vector<double>& sigma = *sensor.intrinsics_sigma;
  if (!sensor.intrinsics) return Refuse(sensor, "sigma is given without intrinsics", "Give both, or leave both away.");
  const std::size_t count = 4 + DistortionCount(sensor.camera_model);
  const bool good = sigma.size() == count && std::all_of(sigma.begin(), sigma.end(), [](double value) {
                      return value >= 0.0 && std::isfinite(value);
                    });
  if (!good)
    return Refuse(sensor, "intrinsics: sigma is not " + std::to_string(count) + " finite numbers >= 0",
                  "Give one standard deviation each for fx fy cx cy " + NamesOf(sensor.camera_model) + ".");
  return {};
}

// Of a given constant that only one kind of sensor has; `name` ends in its unit.
Status CheckSigma(const Sensor& sensor, const std::string& name, const std::optional<double>& sigma, SensorKind kind,
                  const std::string& cure) {
  constexpr double kSigmaMax = 1.0;
  if (!sigma) return {};
  if (sensor.kind != kind) return Refuse(sensor, name + " is for " + NameOf(kind) + "s only", "Leave it away.");
  if (*sigma >= 0 && *sigma <= kSigmaMax) return {};
  return Refuse(sensor, name + " " + std::to_string(*sigma) + " is out of range", cure);
}

Status CheckGivenSigmas(const Sensor& sensor) {
  RIGCAL_TRY(
      CheckSigma(sensor, "range_bias_sigma_m", sensor.range_bias_sigma_m, SensorKind::kLidar,
                 "Give the standard deviation in metres, 0 to 1; the data sheet's range accuracy is a good value."));
  return CheckSigma(sensor, "clock_sigma_s", sensor.clock_sigma_s, SensorKind::kTracker,
                    "Give the standard deviation in seconds, 0 to 1; 0 where one signal releases all.");
}

Status CheckLayout(const Sensor& sensor) {
  if (!sensor.layout) return {};
  const Status valid = Validate(*sensor.layout);
  return valid ? Status{} : Refuse(sensor, valid.error().what, valid.error().cure);
}

Status CheckNominalPose(const Sensor& sensor) {
  if (!sensor.T_ref_nominal) return {};
  const Status good = CheckGivenPose(*sensor.T_ref_nominal);
  return good ? Status{} : Refuse(sensor, "nominal " + good.error().what, good.error().cure);
}

Status CheckPart(const Sensor& sensor) {
  constexpr std::size_t kPartBytesMax = 256;
  for (const auto& [name, text] : {std::pair{"serial", &sensor.serial}, std::pair{"firmware", &sensor.firmware}})
    if (text->size() > kPartBytesMax || !IsPrintableUtf8(*text))
      return Refuse(sensor, std::string(name) + " " + Quoted(*text) + " is not one line of readable text",
                    "Use at most " + std::to_string(kPartBytesMax) + " bytes of UTF-8 without control characters.");
  return {};
}

}  // namespace

Status Validate(const Sensor& sensor) {
  RIGCAL_TRY(CheckName(SensorTag::kKind, sensor.id.str()));
  RIGCAL_TRY(CheckKind(sensor));
  RIGCAL_TRY(CheckIntrinsics(sensor));
  RIGCAL_TRY(CheckIntrinsicsSigma(sensor));
  RIGCAL_TRY(CheckGivenSigmas(sensor));
  RIGCAL_TRY(CheckLayout(sensor));
  RIGCAL_TRY(CheckPart(sensor));
  return CheckNominalPose(sensor);
}

}  // namespace rigcal
