#include "server/formats/rig_files/urdf_patch.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "server/formats/rig_files/urdf.h"
#include "server/math/roll_pitch_yaw.h"

namespace rigcal::rig_files {
namespace {

constexpr double kSame = 1e-12;  // m and rad: as near as a file can say it
constexpr std::string_view kBlank = " \t\r\n";

// The tree of links: by link the joint above it.
class LinkTree {
 public:
  explicit LinkTree(const Urdf& urdf) : urdf_(urdf) {
    for (std::size_t k = 0; k < urdf.joints.size(); ++k) above_.emplace(urdf.joints[k].pose.frame, k);
  }
  [[nodiscard]] const UrdfJoint* Above(const std::string& link) const {
    const auto found = above_.find(link);
    return found == above_.end() ? nullptr : &urdf_.joints[found->second];
  }
  // Joints from the top of the tree down to the link.
  [[nodiscard]] std::vector<const UrdfJoint*> PathTo(const std::string& link) const {
    std::vector<const UrdfJoint*> path;
    for (const UrdfJoint* joint = Above(link); joint != nullptr; joint = Above(joint->pose.parent))
      path.push_back(joint);
    std::reverse(path.begin(), path.end());
    return path;
  }
  // The top of the links that no joint moves against this one.
  [[nodiscard]] std::string RigidTopOf(const std::string& link) const {
    std::string top = link;
    for (const UrdfJoint* joint = Above(link); joint != nullptr && joint->pose.fixed; joint = Above(top))
      top = joint->pose.parent;
    return top;
  }

 private:
  const Urdf& urdf_;
  std::map<std::string, std::size_t> above_;
};

// Text of a start tag, whose "<" is at `at`; quotes may hold ">".
std::string_view StartTag(std::string_view text, std::size_t at) {
  char quote = 0;
  for (std::size_t k = at; k < text.size(); ++k) {
    const char c = text[k];
    if (quote != 0)
      quote = c == quote ? 0 : quote;
    else if (c == '"' || c == '\'')
      quote = c;
    else if (c == '>')
      return text.substr(at, k + 1 - at);
  }
  return text.substr(at);
}

std::string TripleText(const Eigen::Vector3d& values) {
  std::string text;
  for (const double value : values) {
    std::array<char, 32> digits{};
    const auto written = std::to_chars(digits.data(), digits.data() + digits.size(), value == 0.0 ? 0.0 : value);
    text += (text.empty() ? "" : " ") + std::string(digits.data(), written.ptr);
  }
  return text;
}

// Where the value of an attribute stands in a tag, between its quotes; nothing where it is not there.
std::optional<std::pair<std::size_t, std::size_t>> ValueOf(std::string_view tag, std::string_view key) {
  std::size_t at = tag.find_first_of(kBlank);
  while (at != std::string_view::npos && (at = tag.find_first_not_of(kBlank, at)) != std::string_view::npos) {
    const std::size_t equals = tag.find('=', at), open = tag.find_first_of("\"'", at);
    if (equals == std::string_view::npos || open == std::string_view::npos) return std::nullopt;
    const std::size_t close = tag.find(tag[open], open + 1);
    if (close == std::string_view::npos) return std::nullopt;
    const std::string_view name = tag.substr(at, std::min(equals, tag.find_first_of(kBlank, at)) - at);
    if (name == key) return std::pair(open + 1, close);
    at = close + 1;
  }
  return std::nullopt;
}

// Everything but the values of xyz and rpy stays; one that is missing comes after the tag's name.
std::string WithOrigin(std::string_view tag, const Se3& T) {
  std::string changed(tag);
  const std::pair<const char*, std::string> values[] = {{"rpy", TripleText(RollPitchYawOf(T.R()))},
                                                        {"xyz", TripleText(T.p_m)}};
  for (const auto& [key, value] : values) {
    if (const auto place = ValueOf(changed, key))
      changed.replace(place->first, place->second - place->first, value);
    else
      changed.insert(std::string_view("<origin").size(), std::string(" ") + key + "=\"" + value + "\"");
  }
  return changed;
}

struct Edit {
  std::size_t at = 0, length = 0;
  std::string text;
};

class Patch {
 public:
  Patch(std::string_view text, const Urdf& urdf, const LinkPoses& calibrated)
      : text_(text), urdf_(urdf), tree_(urdf), calibrated_(calibrated), T_top_root_(PoseAsItWas(calibrated.root)) {}

  PatchedUrdf Run() {
    for (const auto& [link, pose] : calibrated_.poses) {
      if (link == calibrated_.root) continue;
      const std::string why = WhyLeft(link);
      why.empty() ? void(T_top_link_.emplace(link, T_top_root_ * pose))
                  : patched_.left_out.push_back(link + ": " + why);
    }
    T_top_link_.emplace(calibrated_.root, T_top_root_);
    for (const UrdfJoint& joint : urdf_.joints)
      if (T_top_link_.contains(joint.pose.frame)) Change(joint);
    patched_.text = Edited();
    return std::move(patched_);
  }
  [[nodiscard]] bool HasTargets() const { return T_top_link_.size() > 1; }

 private:
  [[nodiscard]] Se3 PoseAsItWas(const std::string& link) const {
    Se3 T_top_link;
    for (const UrdfJoint* joint : tree_.PathTo(link)) T_top_link = T_top_link * joint->pose.T_parent_frame;
    return T_top_link;
  }
  // Below the last link that is calibrated the file's own joints go on.
  [[nodiscard]] Se3 PoseToBe(const std::string& link) const {
    Se3 T_top_link;
    for (const UrdfJoint* joint : tree_.PathTo(link)) {
      const auto known = T_top_link_.find(joint->pose.frame);
      T_top_link = known == T_top_link_.end() ? T_top_link * joint->pose.T_parent_frame : known->second;
    }
    return T_top_link;
  }

  [[nodiscard]] std::string WhyLeft(const std::string& link) const {
    const UrdfJoint* joint = tree_.Above(link);
    const bool exists =
        joint != nullptr || std::find(urdf_.links.begin(), urdf_.links.end(), link) != urdf_.links.end();
    if (!exists) return "the file has no link of that name";
    if (joint == nullptr) return "its link is the top of the robot: take it as --root";
    if (!joint->pose.fixed) return "joint '" + joint->name + "' above it moves";
    if (tree_.RigidTopOf(link) != tree_.RigidTopOf(calibrated_.root))
      return "a joint between it and " + calibrated_.root + " moves";
    return "";
  }

  void Change(const UrdfJoint& joint) {
    const Se3 T_parent_link = (PoseToBe(joint.pose.parent).Inverse() * T_top_link_.at(joint.pose.frame)).Normalized();
    const Vector6d step = (joint.pose.T_parent_frame.Inverse() * T_parent_link).Log();
    if (step.head<3>().norm() < kSame && step.tail<3>().norm() < kSame) return;
    OriginChange change{joint.name, joint.pose.frame, joint.line, "", "", step.head<3>().norm(), step.tail<3>().norm()};
    if (joint.has_origin) {
      change.before = std::string(StartTag(text_, joint.origin_at));
      change.after = WithOrigin(change.before, T_parent_link);
      change.line +=
          static_cast<std::size_t>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(joint.joint_at),
                                              text_.begin() + static_cast<std::ptrdiff_t>(joint.origin_at), '\n'));
      edits_.push_back({joint.origin_at, change.before.size(), change.after});
    } else {
      change.after = WithOrigin("<origin/>", T_parent_link);
      Insert(joint, change.after);
    }
    patched_.changes.push_back(std::move(change));
  }

  // As the first child of its joint, on a line of its own where the next one is.
  void Insert(const UrdfJoint& joint, const std::string& tag) {
    const std::size_t end = joint.joint_at + StartTag(text_, joint.joint_at).size();
    const std::size_t next = std::min(text_.find_first_not_of(kBlank, end), text_.size());
    edits_.push_back({end, 0, std::string(text_.substr(end, next - end)) + tag});
  }

  [[nodiscard]] std::string Edited() {
    std::sort(edits_.begin(), edits_.end(), [](const Edit& a, const Edit& b) { return a.at < b.at; });
    std::string text;
    std::size_t at = 0;
    for (const Edit& edit : edits_) {
      text.append(text_.substr(at, edit.at - at)).append(edit.text);
      at = edit.at + edit.length;
    }
    return text.append(text_.substr(at));
  }

  std::string_view text_;
  const Urdf& urdf_;
  LinkTree tree_;
  const LinkPoses& calibrated_;
  Se3 T_top_root_;                         // as the file has it
  std::map<std::string, Se3> T_top_link_;  // of calibrated links, as they are to be
  std::vector<Edit> edits_;
  PatchedUrdf patched_;
};

std::string LinkNames(const Urdf& urdf) {
  RigFile file;
  for (const std::string& link : urdf.links) file.poses.push_back({link, link, {}});
  return FramesText(file);
}

}  // namespace

Result<PatchedUrdf> PatchUrdf(std::string_view text, const std::string& name, const LinkPoses& calibrated) {
  RIGCAL_ASSIGN(const Urdf urdf, ReadUrdf(text, name));
  if (std::find(urdf.links.begin(), urdf.links.end(), calibrated.root) == urdf.links.end())
    return Fail(ErrorCode::kNotFound, name + " has no link '" + calibrated.root + "', the root of the calibration",
                "Name a sensor that has one with --root, or its link with --frame SENSOR=LINK. Links: " +
                    LinkNames(urdf) + ".");
  RigFile tree{"urdf", {}};
  for (const UrdfJoint& joint : urdf.joints) tree.poses.push_back(joint.pose);
  if (!tree.poses.empty()) RIGCAL_TRY(CheckTree(tree));
  Patch patch(text, urdf, calibrated);
  PatchedUrdf patched = patch.Run();
  if (patch.HasTargets()) return patched;
  return Fail(ErrorCode::kInvalidInput,
              "no joint of " + name + " can take a pose of the calibration: " +
                  (patched.left_out.empty() ? "there is no other sensor" : patched.left_out.front()),
              "Name links with --frame SENSOR=LINK. Links: " + LinkNames(urdf) + ".");
}

}  // namespace rigcal::rig_files
