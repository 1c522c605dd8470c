#include "client/text/pose_comparison.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "server/base/limits.h"
#include "server/formats/yaml/yaml_field.h"

namespace rigcal::client {
namespace {

constexpr double kUnitTolerance = 1e-3;  // of a quaternion with few digits: it is normalised
constexpr const char* kCure =
    "Give a file with sensors: {NAME: {T_ref_sensor: {p_m: [x, y, z], q_xyzw: [x, y, z, w]}}}.";

bool ReadTriple(const Document& list, double* to) {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto value = list[k].Number();
    if (!value) return false;
    to[k] = *value;
  }
  return true;
}

std::optional<Se3> PoseOf(const Document& pose) {
  double p[3], q[3];
  const auto w = pose["q_xyzw"][3].Number();
  if (!ReadTriple(pose["p_m"], p) || !ReadTriple(pose["q_xyzw"], q) || !w) return std::nullopt;
  Se3 T;
  T.p_m = {p[0], p[1], p[2]};
  T.q = Eigen::Quaterniond(*w, q[0], q[1], q[2]);
  if (!(T.q.norm() > 0.5)) return std::nullopt;
  return T.Normalized();
}

std::optional<Vector6d> SigmaOf(const Document& sensor) {
  Vector6d sigma;
  if (!ReadTriple(sensor["sigma_m"], sigma.data()) || !ReadTriple(sensor["sigma_rad"], sigma.data() + 3))
    return std::nullopt;
  return sigma;
}

Se3 ReadPose(const formats::YamlField& field) {
  Se3 T;
  double q[4] = {0, 0, 0, 1};
  field.At("p_m").Numbers(T.p_m.data(), 3);
  const formats::YamlField quaternion = field.At("q_xyzw");
  quaternion.Numbers(q, 4);
  T.q = Eigen::Quaterniond(q[3], q[0], q[1], q[2]);
  if (!(std::abs(T.q.norm() - 1.0) <= kUnitTolerance)) quaternion.Refuse("must have unit length");
  return T.Normalized();
}

Result<std::string> TextOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(limits::kSessionYamlBytesMax + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad() || (!file.eof() && file.gcount() == 0))
    return Fail(ErrorCode::kNotFound, "file " + path + " cannot be read", "Give the name of an existing file.");
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

tl::unexpected<Error> Missing(const std::string& what) {
  return Fail(ErrorCode::kNotFound, what, "Compare poses of one rig: sensors are matched by their names.");
}

// Two revisions of a robot share measurements: so the sigma of their difference is at most about the larger one.
std::optional<Vector6d> Larger(const std::optional<Vector6d>& sigma, const std::optional<Vector6d>& other) {
  if (!sigma || !other) return sigma;
  return Vector6d(sigma->cwiseMax(*other));
}

}  // namespace

KnownPoses PosesOfRevision(const Document& revision) {
  KnownPoses poses;
  for (const Document& sensor : revision["sensors"].Items())
    if (const auto T = PoseOf(sensor["T_ref_sensor"])) poses[sensor["id"].Text()] = {*T, SigmaOf(sensor)};
  return poses;
}

Result<KnownPoses> PosesOfFile(const std::string& path) {
  RIGCAL_ASSIGN(const std::string text, TextOf(path));
  RIGCAL_ASSIGN(const auto tree, formats::ParseYaml(text, std::filesystem::path(path).filename().string(), kCure,
                                                    limits::kSessionYamlBytesMax));
  KnownPoses poses;
  for (const formats::YamlField& sensor : formats::YamlField(*tree).At("sensors").Members()) {
    const formats::YamlField field = sensor.Called("sensor '" + sensor.Key() + "'");
    auto pose = field.Find("T_ref_sensor");
    if (!pose) pose = field.Find("T_ref_nominal");
    if (pose) poses[sensor.Key()] = {ReadPose(*pose), std::nullopt};
  }
  if (tree->error) return Fail(*tree->error);
  return poses;
}

std::optional<double> PoseDifference::WorstSigmas() const {
  if (!sigma || !(sigma->minCoeff() > 0)) return std::nullopt;
  return (e.array() / sigma->array()).abs().maxCoeff();
}

Result<std::vector<PoseDifference>> ComparePoses(const KnownPoses& poses, const KnownPoses& others,
                                                 const std::string& reference) {
  const auto own = poses.find(reference), other = others.find(reference);
  if (own == poses.end() || other == others.end())
    return Missing("the reference sensor '" + reference + "' has no pose to compare with");
  const Se3 T_ref_other = own->second.T_ref_sensor * other->second.T_ref_sensor.Inverse();
  std::vector<PoseDifference> differences;
  for (const auto& [sensor, pose] : poses) {
    const auto match = others.find(sensor);
    if (sensor == reference || match == others.end()) continue;
    const Se3 T_other = T_ref_other * match->second.T_ref_sensor;
    differences.push_back(
        {sensor, (T_other.Inverse() * pose.T_ref_sensor).Log(), Larger(pose.sigma, match->second.sigma)});
  }
  if (differences.empty()) return Missing("no sensor but the reference has a pose to compare with");
  return differences;
}

}  // namespace rigcal::client
