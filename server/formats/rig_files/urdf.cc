#include "server/formats/rig_files/urdf.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <pugixml.hpp>

#include "server/math/roll_pitch_yaw.h"
#include "server/model/plausible.h"

namespace rigcal::rig_files {
namespace {

constexpr double kNumberMax = 1e12;  // beyond: a broken tool
constexpr std::string_view kBlanks = " \t\r\n";

class UrdfReader {
 public:
  UrdfReader(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  Result<Urdf> Read() {
    pugi::xml_document document;
    const auto parsed = document.load_buffer(text_.data(), text_.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!parsed)
      return Refuse(static_cast<std::size_t>(std::max<std::ptrdiff_t>(parsed.offset, 0)),
                    std::string("no XML: ") + parsed.description(), kMend);
    const pugi::xml_node robot = document.child("robot");
    if (!robot) return Refuse(0, "no URDF: there is no <robot>", "Give a URDF file.");
    RIGCAL_TRY(CheckExpanded(robot));
    Urdf urdf;
    for (const pugi::xml_node link : robot.children("link")) urdf.links.emplace_back(link.attribute("name").value());
    for (const pugi::xml_node joint : robot.children("joint")) {
      if (urdf.joints.size() == kFramesMax)
        return Refuse(0, "more than " + std::to_string(kFramesMax) + " joints", kMend);
      RIGCAL_ASSIGN(UrdfJoint read, ReadJoint(joint));
      urdf.joints.push_back(std::move(read));
    }
    return urdf;
  }

 private:
  static constexpr const char* kMend = "Mend the file; `check_urdf FILE` reads it like ROS does.";

  [[nodiscard]] std::size_t LineOf(std::size_t at) const {
    return 1 + static_cast<std::size_t>(std::count(
                   text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(std::min(at, text_.size())), '\n'));
  }

  // Joints come in the order of the text: each line end is counted once.
  [[nodiscard]] std::size_t NextLine(std::size_t at) {
    if (at < counted_) counted_ = 0, line_ = 1;
    line_ += static_cast<std::size_t>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(counted_),
                                                 text_.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
    counted_ = at;
    return line_;
  }

  [[nodiscard]] tl::unexpected<Error> Refuse(std::size_t at, const std::string& what, const std::string& cure,
                                             ErrorCode code = ErrorCode::kInvalidInput) const {
    return Fail(code, name_ + " line " + std::to_string(LineOf(at)) + ": " + what, cure);
  }

  // Of a node's "<"; its name stands behind.
  [[nodiscard]] static std::size_t PlaceOf(const pugi::xml_node& node) {
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 1) - 1);
  }

  [[nodiscard]] Status CheckExpanded(const pugi::xml_node& robot) const {
    for (const pugi::xml_node child : robot.children())
      if (std::string_view(child.name()).rfind("xacro:", 0) == 0) return RefuseXacro(child);
    return {};
  }
  [[nodiscard]] tl::unexpected<Error> RefuseXacro(const pugi::xml_node& node) const {
    return Refuse(PlaceOf(node), "a xacro file that is not expanded",
                  "`xacro " + name_ + " > robot.urdf` expands it; give robot.urdf.", ErrorCode::kUnsupported);
  }

  Result<UrdfJoint> ReadJoint(const pugi::xml_node& node) {
    UrdfJoint joint;
    joint.name = node.attribute("name").value();
    joint.joint_at = PlaceOf(node);
    joint.line = NextLine(joint.joint_at);
    joint.pose.parent = node.child("parent").attribute("link").value();
    joint.pose.frame = node.child("child").attribute("link").value();
    joint.pose.fixed = std::string_view(node.attribute("type").value()) == "fixed";
    if (joint.pose.parent.empty() || joint.pose.frame.empty())
      return Refuse(joint.joint_at, "joint '" + Shown(joint.name) + "' lacks its parent or child link", kMend);
    const pugi::xml_node origin = node.child("origin");
    if (!origin) return joint;
    joint.has_origin = true;
    joint.origin_at = PlaceOf(origin);
    RIGCAL_ASSIGN(joint.pose.T_parent_frame, ReadOrigin(origin, joint));
    return joint;
  }

  Result<Se3> ReadOrigin(const pugi::xml_node& origin, const UrdfJoint& joint) const {
    RIGCAL_ASSIGN(const Eigen::Vector3d p_m, ReadTriple(origin, "xyz", joint));
    RIGCAL_ASSIGN(const Eigen::Vector3d rpy_rad, ReadTriple(origin, "rpy", joint));
    if (const Status plausible = CheckPlausible(p_m); !plausible)
      return Refuse(joint.origin_at, "joint '" + Shown(joint.name) + "': " + plausible.error().what,
                    plausible.error().cure);
    if (const std::string why = WhyNoRadians(rpy_rad); !why.empty())
      return Refuse(joint.origin_at, "joint '" + Shown(joint.name) + "': " + why, kMend);
    Se3 T;
    T.p_m = p_m;
    T.q = Eigen::Quaterniond(RotationOf(rpy_rad));
    return T.Normalized();
  }

  // Absent: zero, as URDF has it.
  Result<Eigen::Vector3d> ReadTriple(const pugi::xml_node& origin, const char* key, const UrdfJoint& joint) const {
    Eigen::Vector3d values = Eigen::Vector3d::Zero();
    const pugi::xml_attribute attribute = origin.attribute(key);
    if (!attribute) return values;
    std::string_view rest = attribute.value();
    if (rest.find("${") != std::string_view::npos || rest.find("$(") != std::string_view::npos)
      return RefuseXacro(origin);
    for (int axis = 0; axis < 3; ++axis) {
      rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
      if (!rest.empty() && rest.front() == '+') rest.remove_prefix(1);
      const auto [end, status] = std::from_chars(rest.data(), rest.data() + rest.size(), values[axis]);
      if (status != std::errc() || !(std::abs(values[axis]) <= kNumberMax)) return RefuseTriple(key, joint);
      rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    }
    if (rest.find_first_not_of(kBlanks) != std::string_view::npos) return RefuseTriple(key, joint);
    return values;
  }
  [[nodiscard]] tl::unexpected<Error> RefuseTriple(const char* key, const UrdfJoint& joint) const {
    return Refuse(joint.origin_at, "joint '" + Shown(joint.name) + "': " + key + " must be three numbers", kMend);
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t counted_ = 0, line_ = 1;  // line ends before this place are in the line
};

}  // namespace

Result<Urdf> ReadUrdf(std::string_view text, const std::string& name) {
  if (text.size() > kRigFileBytesMax)
    return Fail(ErrorCode::kInvalidInput, name + " is larger than " + std::to_string(kRigFileBytesMax >> 20) + " MiB",
                "Give a URDF file.");
  return UrdfReader(text, name).Read();
}

}  // namespace rigcal::rig_files
