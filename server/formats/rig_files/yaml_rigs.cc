#include "server/formats/rig_files/yaml_rigs.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "server/formats/rig_axes.h"
#include "server/formats/yaml/yaml_field.h"
#include "server/math/roll_pitch_yaw.h"
#include "server/model/plausible.h"

namespace rigcal::rig_files {
namespace {

using formats::YamlField;
using formats::YamlNode;

constexpr double kUnitTolerance = 1e-3;  // of numbers with few digits: they are normalised
constexpr std::size_t kYamlBytesMax = 4u << 20;
constexpr const char* kYamlCure =
    "Give a URDF, a YAML of tf2 transforms, Autoware's sensor_kit_calibration.yaml or Kalibr's camchain.yaml.";

Eigen::Vector3d ReadAxes(const YamlField& map, const char* x, const char* y, const char* z) {
  const double values[] = {map.At(x).Number(), map.At(y).Number(), map.At(z).Number()};
  return {values[0], values[1], values[2]};
}

void CheckPlace(const YamlField& field, const Eigen::Vector3d& p_m) {
  if (const Status plausible = CheckPlausible(p_m); !plausible) field.Refuse(plausible.error());
}

FramePose ReadTransformStamped(const YamlField& item) {
  FramePose pose;
  pose.parent = item.At("header").At("frame_id").Text();
  pose.frame = item.At("child_frame_id").Text();
  const YamlField transform = item.At("transform").Called("transform of '" + Shown(pose.frame) + "'");
  pose.T_parent_frame.p_m = ReadAxes(transform.At("translation"), "x", "y", "z");
  CheckPlace(transform, pose.T_parent_frame.p_m);
  const YamlField rotation = transform.At("rotation");
  pose.T_parent_frame.q.vec() = ReadAxes(rotation, "x", "y", "z");
  pose.T_parent_frame.q.w() = rotation.At("w").Number();
  if (!(std::abs(pose.T_parent_frame.q.norm() - 1.0) <= kUnitTolerance)) rotation.Refuse("must have unit length");
  pose.T_parent_frame = pose.T_parent_frame.Normalized();
  return pose;
}

RigFile ReadTf2(const YamlField& root) {
  RigFile file{"tf2", {}};
  for (const YamlField& item : root.At("transforms").Items()) file.poses.push_back(ReadTransformStamped(item));
  return file;
}

FramePose ReadKitFrame(const std::string& parent, const YamlField& field) {
  FramePose pose{parent, field.Key(), {}};
  const YamlField frame = field.Called("frame '" + Shown(field.Key()) + "'");
  frame.AllowOnly({"x", "y", "z", "roll", "pitch", "yaw"});  // "x: 0,5" in braces has a key 5
  pose.T_parent_frame.p_m = ReadAxes(frame, "x", "y", "z");
  CheckPlace(frame, pose.T_parent_frame.p_m);
  const Eigen::Vector3d rpy_rad = ReadAxes(frame, "roll", "pitch", "yaw");
  if (const std::string why = WhyNoRadians(rpy_rad); !why.empty()) frame.Refuse(why);
  pose.T_parent_frame.q = Eigen::Quaterniond(RotationOf(rpy_rad));
  pose.T_parent_frame = pose.T_parent_frame.Normalized();
  const std::size_t end = pose.frame.size() - std::min(pose.frame.size(), kCameraLinkSuffix.size());
  if (end > 0 && std::string_view(pose.frame).substr(end) == kCameraLinkSuffix) {
    pose.frame.resize(end);
    pose.T_parent_frame = (pose.T_parent_frame * LinkOfOptical()).Normalized();
  }
  return pose;
}

RigFile ReadAutoware(const YamlField& root) {
  RigFile file{"autoware", {}};
  for (const YamlField& parent : root.Members())
    for (const YamlField& frame : parent.Members()) file.poses.push_back(ReadKitFrame(parent.Key(), frame));
  return file;
}

// Four rows of four, the last 0 0 0 1, a rotation on the left.
Se3 ReadMatrix(const YamlField& field) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  const std::vector<YamlField> rows = field.Items();
  if (rows.size() != 4) {
    field.Refuse("must be 4 rows of 4 numbers");
    return {};
  }
  for (Eigen::Index row = 0; row < 4; ++row) {
    double values[4] = {};
    rows[static_cast<std::size_t>(row)].Numbers(values, 4);
    for (Eigen::Index column = 0; column < 4; ++column) matrix(row, column) = values[column];
  }
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const bool orthonormal =
      (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= kUnitTolerance && R.determinant() > 0;
  const bool rigid =
      orthonormal && (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() <= kUnitTolerance;
  if (!rigid) {
    field.Refuse("is no rotation and translation");
    return {};
  }
  CheckPlace(field, matrix.topRightCorner<3, 1>());
  return Se3::FromMatrix(matrix).Normalized();
}

// By their numbers: files sort cam10 before cam2. A chain in which one is missing does not tell where the next one is.
std::vector<YamlField> CamerasInOrder(const YamlField& root) {
  std::map<std::int64_t, YamlField> cameras;
  for (const YamlField& member : root.Members()) {
    std::int64_t number = -1;
    const std::string& key = member.Key();
    const char* const end = key.data() + key.size();
    const bool is_camera =
        key.rfind("cam", 0) == 0 && std::from_chars(key.data() + 3, end, number).ptr == end && number >= 0;
    if (!is_camera) {
      member.Refuse("a camera chain has cam0, cam1, ... and not '" + Shown(key) + "'");
      return {};
    }
    cameras.emplace(number, member);
  }
  std::vector<YamlField> ordered;
  for (const auto& [number, camera] : cameras) {
    if (number != static_cast<std::int64_t>(ordered.size()))
      camera.Refuse("cam" + std::to_string(ordered.size()) + " is missing before it");
    ordered.push_back(camera);
  }
  return ordered;
}

RigFile ReadKalibr(const YamlField& root) {
  RigFile file{"kalibr", {}};
  std::string before;
  for (const YamlField& member : CamerasInOrder(root)) {
    const YamlField camera = member.Called("camera '" + Shown(member.Key()) + "'");
    const auto named = camera.Find("rigcal_frame");
    const std::string frame = named ? named->Text() : member.Key();
    if (!before.empty())
      file.poses.push_back({before, frame, ReadMatrix(camera.At("T_cn_cnm1")).Inverse().Normalized()});
    before = frame;
  }
  return file;
}

}  // namespace

Result<RigFile> ReadYamlRig(std::string_view text, const std::string& name) {
  RIGCAL_ASSIGN(const auto tree, formats::ParseYaml(text, name, kYamlCure, kYamlBytesMax));
  const YamlField root(*tree);
  const std::vector<YamlNode>& keys = tree->root.items;
  RigFile file;
  if (tree->root.kind != YamlNode::Kind::kMap || keys.empty())
    root.Refuse("is no rig: there are no keys");
  else if (root.Find("transforms"))
    file = ReadTf2(root);
  else if (keys.front().key == "cam0")
    file = ReadKalibr(root);
  else
    file = ReadAutoware(root);
  if (!tree->error && file.poses.empty()) root.Refuse("has no pose of a frame");
  if (tree->error) return Fail(*tree->error);
  return file;
}

}  // namespace rigcal::rig_files
