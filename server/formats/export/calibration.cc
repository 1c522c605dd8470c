#include "server/formats/export/calibration.h"

#include <algorithm>
#include <set>

#include "server/math/covariance.h"

namespace rigcal::exports {
namespace {

constexpr std::size_t kFrameNameMax = 256;

std::string SensorNames(const Calibration& calibration) {
  std::string names;
  for (const ExportedSensor& sensor : calibration.sensors) names += (names.empty() ? "" : ", ") + sensor.sensor.str();
  return names;
}

std::string WhyNotWhole(const SensorPose& pose, const std::optional<Eigen::Matrix3d>& R_ref_robot) {
  if (!pose.measured_part) return "its pose is not known";
  std::string open;
  for (const std::string& name : NamesOfOpen(AxesOf(pose, R_ref_robot), pose.unobservable_basis.size()))
    open += (open.empty() ? "" : " and ") + InSentence(name);
  return open + " was not measured";
}

const formats::SensorFacts* FactsOf(const std::optional<formats::SensorFactsOfRevision>& facts,
                                    const SensorId& sensor) {
  if (!facts) return nullptr;
  const auto found = std::find_if(facts->sensors.begin(), facts->sensors.end(),
                                  [&](const formats::SensorFacts& one) { return one.sensor == sensor; });
  return found == facts->sensors.end() ? nullptr : &*found;
}

ExportedSensor SensorOf(const SensorPose& pose, const formats::SensorFacts* facts) {
  ExportedSensor sensor{pose.sensor, pose.sensor.str(), {}, pose.T_ref_sensor.Normalized(), pose.covariance};
  if (facts == nullptr) return sensor;
  sensor.kind = facts->kind;
  const bool has_lens = facts->camera && facts->camera->source != IntrinsicsSource::kNone;
  if (has_lens && facts->camera->width_px > 0 && facts->camera->height_px > 0) sensor.camera = facts->camera;
  return sensor;
}

void LeaveOut(const SensorId& sensor, const std::string& why, Calibration& calibration) {
  calibration.left_out.push_back(sensor.str() + ": " + why);
  calibration.without_pose.emplace(sensor, why);
}

void PutFirst(const SensorId& root, std::vector<ExportedSensor>& sensors) {
  std::stable_partition(sensors.begin(), sensors.end(), [&](const ExportedSensor& one) { return one.sensor == root; });
}

bool IsFrameName(const std::string& name) {
  constexpr std::string_view kAllowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./";
  return !name.empty() && name.size() <= kFrameNameMax && name.find_first_not_of(kAllowed) == std::string::npos;
}

}  // namespace

const ExportedSensor* Calibration::Find(const SensorId& sensor) const {
  const auto found =
      std::find_if(sensors.begin(), sensors.end(), [&](const ExportedSensor& one) { return one.sensor == sensor; });
  return found == sensors.end() ? nullptr : &*found;
}

Result<Calibration> CalibrationOf(const formats::RevisionInput& revision,
                                  const std::optional<formats::SensorFactsOfRevision>& facts) {
  Calibration calibration;
  calibration.robot = revision.robot;
  calibration.root = revision.reference;
  for (const SensorPose& pose : revision.solution.poses) {
    if (pose.known)
      calibration.sensors.push_back(SensorOf(pose, FactsOf(facts, pose.sensor)));
    else
      LeaveOut(pose.sensor, WhyNotWhole(pose, revision.solution.R_ref_robot), calibration);
  }
  if (calibration.Find(calibration.root) == nullptr || calibration.sensors.size() < 2)
    return Fail(ErrorCode::kNotFound,
                "this revision of " + revision.robot.str() + " has no whole pose beside its reference",
                "`rigcal show` says why; push a session that ties its sensors.");
  PutFirst(calibration.root, calibration.sensors);
  if (!facts)
    calibration.left_out.push_back(
        "kinds of sensors and intrinsics of cameras: this rigcald is older and does not tell them");
  return calibration;
}

Result<Calibration> Rebased(Calibration calibration, const SensorId& root,
                            const std::map<SensorId, Matrix6d>& relative) {
  if (root == calibration.root) return calibration;
  const ExportedSensor* found = calibration.Find(root);
  if (found == nullptr)
    return Fail(ErrorCode::kNotFound,
                "'" + root.str() + "' is no sensor of " + calibration.robot.str() + " with a whole pose",
                "Give one of " + SensorNames(calibration) + " as --root.");
  const Se3 T_old_root = found->T_root_sensor, T_root_old = T_old_root.Inverse();
  const Matrix6d C_old_root = found->covariance;
  std::vector<ExportedSensor> sensors;
  for (ExportedSensor& sensor : calibration.sensors) {
    const auto told = relative.find(sensor.sensor);
    const bool is_root = sensor.sensor == root, was_root = sensor.sensor == calibration.root;
    if (!is_root && !was_root && told == relative.end()) {
      LeaveOut(sensor.sensor, "how well its pose in " + root.str() + " is known cannot be told", calibration);
      continue;
    }
    sensor.covariance = is_root    ? Matrix6d(Matrix6d::Zero())
                        : was_root ? InverseCovariance(T_old_root, C_old_root)
                                   : told->second;
    sensor.T_root_sensor = is_root ? Se3() : (T_root_old * sensor.T_root_sensor).Normalized();
    sensors.push_back(std::move(sensor));
  }
  calibration.sensors = std::move(sensors);
  calibration.root = root;
  PutFirst(root, calibration.sensors);
  return calibration;
}

Status RenameFrames(Calibration& calibration, const std::map<SensorId, std::string>& frames) {
  for (const auto& [sensor, frame] : frames) {
    if (calibration.Find(sensor) == nullptr)
      return Fail(ErrorCode::kNotFound,
                  "'" + sensor.str() + "' is no sensor of " + calibration.robot.str() + " with a whole pose",
                  "Name one of " + SensorNames(calibration) + ".");
    if (!IsFrameName(frame))
      return Fail(ErrorCode::kInvalidInput,
                  "the frame name '" + frame.substr(0, 64) + "' has characters that files cannot hold",
                  "Use letters, digits and _ - . / only.");
  }
  std::set<std::string> taken;
  for (ExportedSensor& sensor : calibration.sensors) {
    if (const auto name = frames.find(sensor.sensor); name != frames.end()) sensor.frame = name->second;
    if (!taken.insert(sensor.frame).second)
      return Fail(ErrorCode::kInvalidInput, "two sensors would have the frame '" + sensor.frame + "'",
                  "Give each its own.");
  }
  return {};
}

}  // namespace rigcal::exports
