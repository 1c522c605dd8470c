#include "server/formats/rig_files/frames.h"

#include <cmath>
#include <cstdio>
#include <set>

#include "server/base/text.h"
#include "server/formats/rig_axes.h"
#include "server/formats/rig_files/urdf.h"
#include "server/formats/rig_files/yaml_rigs.h"

namespace rigcal::rig_files {
namespace {

struct Neighbour {
  std::string frame;
  Se3 T_this_frame;
};
using Neighbours = std::map<std::string, std::vector<Neighbour>>;

Neighbours FixedNeighbours(const RigFile& file) {
  Neighbours neighbours;
  for (const FramePose& pose : file.poses) {
    neighbours[pose.parent];
    neighbours[pose.frame];
    if (!pose.fixed) continue;
    neighbours[pose.parent].push_back({pose.frame, pose.T_parent_frame});
    neighbours[pose.frame].push_back({pose.parent, pose.T_parent_frame.Inverse()});
  }
  return neighbours;
}

Result<RigFile> ReadUrdfRig(std::string_view text, const std::string& name) {
  RIGCAL_ASSIGN(const Urdf urdf, ReadUrdf(text, name));
  RigFile file{"urdf", {}};
  for (const UrdfJoint& joint : urdf.joints) file.poses.push_back(joint.pose);
  if (file.poses.empty()) return Fail(ErrorCode::kInvalidInput, name + " has no joint", "Give a robot with joints.");
  return file;
}

}  // namespace

Result<RigFile> ReadRigFile(std::string_view text, const std::string& name) {
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first == std::string_view::npos)
    return Fail(ErrorCode::kInvalidInput, name + " is empty", "Give a URDF, tf2, Autoware or Kalibr file.");
  return text[first] == '<' ? ReadUrdfRig(text, name) : ReadYamlRig(text, name);
}

Status CheckTree(const RigFile& file) {
  std::map<std::string, std::string> parents;
  for (const FramePose& pose : file.poses) {
    const auto [at, fresh] = parents.emplace(pose.frame, pose.parent);
    if (!fresh)
      return Fail(ErrorCode::kConflict,
                  "frame '" + Shown(pose.frame) + "' stands below '" + Shown(at->second) + "' and once more below '" +
                      Shown(pose.parent) + "'",
                  "Leave one of the two.");
  }
  std::set<std::string> finished;
  for (const auto& [frame, first] : parents) {
    std::set<std::string> path;
    std::string at = frame;
    for (auto up = parents.find(at); up != parents.end() && !finished.contains(at); up = parents.find(at)) {
      if (!path.insert(at).second)
        return Fail(ErrorCode::kConflict, "frame '" + Shown(at) + "' stands below itself",
                    "Frames are a tree: mend the file.");
      at = up->second;
    }
    finished.insert(path.begin(), path.end());
  }
  return {};
}

std::string Shown(const std::string& name) {
  constexpr std::size_t kShownMax = 80;
  return !name.empty() && name.size() <= kShownMax && IsPrintableUtf8(name) ? name : Quoted(name);
}

std::string FramesText(const RigFile& file) {
  constexpr std::size_t kNamedMax = 12, kTextMax = 600;
  std::set<std::string> frames;
  for (const FramePose& pose : file.poses) frames.insert({pose.parent, pose.frame});
  std::string text;
  std::size_t named = 0;
  for (const std::string& frame : frames) {
    if (named == kNamedMax || text.size() > kTextMax)
      return text + " and " + std::to_string(frames.size() - named) + " more";
    text += (named++ == 0 ? "" : ", ") + Shown(frame);
  }
  return text;
}

Result<std::map<std::string, Se3>> PosesIn(const RigFile& file, const std::string& root) {
  RIGCAL_TRY(CheckTree(file));
  const Neighbours neighbours = FixedNeighbours(file);
  if (!neighbours.contains(root))
    return Fail(ErrorCode::kNotFound, "the file has no frame '" + Shown(root) + "'",
                "Frames in it: " + FramesText(file) + ".");
  std::map<std::string, Se3> poses = {{root, Se3()}};
  std::vector<std::string> waiting = {root};
  while (!waiting.empty()) {
    const std::string frame = waiting.back();
    waiting.pop_back();
    const Se3 T_root_frame = poses.at(frame);
    for (const Neighbour& next : neighbours.at(frame))
      if (poses.emplace(next.frame, (T_root_frame * next.T_this_frame).Normalized()).second)
        waiting.push_back(next.frame);
  }
  return poses;
}

std::string FrameAsRead(const RigFile& file, const std::string& frame) {
  if (file.format != "autoware" || !frame.ends_with(kCameraLinkSuffix)) return frame;
  return frame.substr(0, frame.size() - kCameraLinkSuffix.size());
}

std::string WhyNoRadians(const Eigen::Vector3d& angles) {
  constexpr double kTurn_rad = 2 * M_PI * 1.001;  // of numbers with few digits
  const double largest = angles.cwiseAbs().maxCoeff();
  if (!(largest > kTurn_rad)) return "";
  char text[96];
  std::snprintf(text, sizeof text, "an angle of %.4g is more than a whole turn in radians: are these degrees?",
                largest);
  return text;
}

}  // namespace rigcal::rig_files
