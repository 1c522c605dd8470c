#include "server/report/pages/certified_sensors.h"

#include <algorithm>
#include <cmath>

#include "server/math/statistics.h"
#include "server/report/text/relied.h"
#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"
#include "server/report/text/unknown.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kCertifiedSensorsMax = 14;
constexpr double kProbability = 0.95;

// The larger of three axes, one sigma; absent: not known.
std::optional<double> WorstAxisSigma(const SensorPose& pose, int first_axis) {
  const double variance = pose.covariance.diagonal().segment<3>(first_axis).maxCoeff();
  if (!pose.covariance.diagonal().allFinite() || !(variance > 0.0)) return std::nullopt;
  return std::sqrt(variance);
}

struct CertifiedSensor {
  const SensorPose* pose = nullptr;
  bool is_reference = false;
  std::optional<double> sigma_m, sigma_rad, k;
  std::optional<PoseLimit> limit;   // of sigma; absent: there is none to hold it against
  std::optional<bool> within = {};  // that limit
  bool relied_on = true;            // by the verdict
};

std::optional<bool> IsWithin(const CertifiedSensor& sensor) {
  if (!sensor.limit || !sensor.sigma_m || !sensor.sigma_rad) return std::nullopt;
  return *sensor.sigma_m <= sensor.limit->m && *sensor.sigma_rad <= sensor.limit->rad;
}

CertifiedSensor CertifiedOf(const SensorPose& pose, const ReportInput& input) {
  CertifiedSensor sensor{&pose, pose.sensor == input.revision.reference, {}, {}, {}, {}, {}};
  if (!pose.known || sensor.is_reference) return sensor;
  sensor.sigma_m = WorstAxisSigma(pose, tangent::kTranslation);
  sensor.sigma_rad = WorstAxisSigma(pose, tangent::kRotation);
  sensor.k = CoverageFactor(pose);
  sensor.limit = ToleranceOf(input.revision, pose.sensor);
  sensor.within = IsWithin(sensor);
  sensor.relied_on = IsReliedOn(pose.sensor, input.revision.verdict, input.revision.basis);
  return sensor;
}

// In their order; of more than there is room for the unknown and least certain first.
std::vector<CertifiedSensor> SensorsToCertify(const ReportInput& input) {
  std::vector<CertifiedSensor> sensors;
  for (const SensorPose& pose : input.revision.solution.poses) sensors.push_back(CertifiedOf(pose, input));
  if (sensors.size() <= kCertifiedSensorsMax) return sensors;
  const auto doubt = [&](const CertifiedSensor& sensor) {
    if (sensor.is_reference) return -1.0;
    if (!sensor.sigma_m || !sensor.sigma_rad) return HUGE_VAL;
    const PoseLimit scale = sensor.limit.value_or(PoseLimit{1.0, 1.0});
    return std::max(*sensor.sigma_m / scale.m, *sensor.sigma_rad / scale.rad);
  };
  std::stable_sort(sensors.begin(), sensors.end(),
                   [&](const CertifiedSensor& x, const CertifiedSensor& y) { return doubt(x) > doubt(y); });
  return sensors;
}

void FillCertifiedPose(Dictionary& row, const Se3& T_ref_sensor) {
  const RollPitchYaw angles = RollPitchYawOf(T_ref_sensor.q);
  row.SetValue("X", Mm(T_ref_sensor.p_m.x()));
  row.SetValue("Y", Mm(T_ref_sensor.p_m.y()));
  row.SetValue("Z", Mm(T_ref_sensor.p_m.z()));
  row.SetValue("ROLL", Deg(angles.roll));
  row.SetValue("PITCH", Deg(angles.pitch));
  row.SetValue("YAW", Deg(angles.yaw));
}

// A small sigma is no word for a pose that the verdict does not rely on.
std::string WithinText(const CertifiedSensor& sensor) {
  if (!sensor.within) return "\xE2\x80\x93";
  if (!*sensor.within) return "no";
  return sensor.relied_on ? "yes" : "not verified";
}

void FillCertainty(Dictionary& row, const CertifiedSensor& sensor) {
  const std::string none = "\xE2\x80\x93";
  Dictionary* certainty = row.AddSectionDictionary("CERTAINTY");
  certainty->SetValue("SIGMA_MM", sensor.sigma_m ? SigmaMm(*sensor.sigma_m) : "not known");
  certainty->SetValue("SIGMA_DEG", sensor.sigma_rad ? SigmaDeg(*sensor.sigma_rad) : "not known");
  if (sensor.limit) {
    ShowValue(*certainty, "LIMIT_MM", "VALUE", SigmaMm(sensor.limit->m));
    ShowValue(*certainty, "LIMIT_DEG", "VALUE", SigmaDeg(sensor.limit->rad));
  }
  certainty->SetValue("K", sensor.k ? Fixed(*sensor.k, 2) : none);
  certainty->SetValue("U_MM", sensor.k && sensor.sigma_m ? SigmaMm(*sensor.k * *sensor.sigma_m) : none);
  certainty->SetValue("U_DEG", sensor.k && sensor.sigma_rad ? SigmaDeg(*sensor.k * *sensor.sigma_rad) : none);
  certainty->SetValue("WITHIN", WithinText(sensor));
}

}  // namespace

std::optional<double> CoverageFactor(const SensorPose& pose) {
  if (!(pose.dof > 0.0)) return std::nullopt;
  const double k = StudentQuantile(0.5 * (1.0 + kProbability), pose.dof);
  return std::isfinite(k) ? std::optional(k) : std::nullopt;
}

void FillCertifiedSensors(Dictionary& page, const ReportInput& input) {
  if (input.revision.policy) page.ShowSection("LIMITS");
  const auto why = WhyUnknown(input.revision);
  const std::vector<CertifiedSensor> sensors = SensorsToCertify(input);
  for (std::size_t i = 0; i < std::min(sensors.size(), kCertifiedSensorsMax); ++i) {
    const SensorPose& pose = *sensors[i].pose;
    Dictionary* row = page.AddSectionDictionary("SENSOR");
    row->SetValue("NAME", pose.sensor.str());
    if (!pose.known) {
      ShowValue(*row, "UNKNOWN", "WHY", why.at(pose.sensor));
      continue;
    }
    Dictionary* known = row->AddSectionDictionary("KNOWN");
    FillCertifiedPose(*known, pose.T_ref_sensor);
    sensors[i].is_reference ? known->ShowSection("FIXED") : FillCertainty(*known, sensors[i]);
  }
  if (sensors.size() > kCertifiedSensorsMax)
    ShowValue(page, "MORE_SENSORS", "COUNT", Count(sensors.size() - kCertifiedSensorsMax, "sensor", "sensors"));
  const auto lacks_k = [](const CertifiedSensor& sensor) { return sensor.sigma_m && !sensor.k; };
  if (std::any_of(sensors.begin(), sensors.end(), lacks_k)) page.ShowSection("NO_K");
}

}  // namespace rigcal::report
