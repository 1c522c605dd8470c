#include "client/import/pose_frames.h"

#include <algorithm>

#include "client/import/sensor_messages.h"
#include "server/base/text.h"

namespace rigcal::importing {
namespace {

constexpr const char* kSayWhich = "Set `frame` and `child_frame` in rig.yaml";

}  // namespace

std::optional<bags::StampedPose> PoseFrames::Take(bags::StampedPose pose) {
  const Frames frames{PlainFrame(pose.child), PlainFrame(pose.header.frame)};
  if (sensor_->child_frame.empty()) {
    if (!first_) first_ = frames;
    if (frames != *first_ && !other_) other_ = frames;
    return pose;
  }
  // A type of message that does not name its body, or a driver that does not name the frame, is taken at rig.yaml's
  // word.
  const bool is_its_child = frames.child.empty() || frames.child == PlainFrame(sensor_->child_frame);
  const bool is_its_frame = frames.frame.empty() || frames.frame == PlainFrame(sensor_->frame);
  if (is_its_child && is_its_frame) return pose;
  if (!other_) other_ = frames;
  return std::nullopt;
}

std::optional<bags::StampedPose> PoseFrames::Take(const std::vector<bags::StampedPose>& transforms,
                                                  std::int64_t tolerance_ns) {
  has_transforms_ = true;
  for (const bags::StampedPose& one : transforms) tree_.Add(one, false);
  const bool moves_it = std::any_of(transforms.begin(), transforms.end(), [&](const bags::StampedPose& one) {
    return tree_.IsBetween(one.child, sensor_->frame, sensor_->child_frame);
  });
  return moves_it ? tree_.Pose(sensor_->frame, sensor_->child_frame, tolerance_ns) : std::nullopt;
}

void PoseFrames::TakeStatic(const std::string& topic, const std::vector<bags::StampedPose>& transforms) {
  const std::vector<std::string> own = StaticTopicsFor(sensor_->topic);
  if (std::find(own.begin(), own.end(), topic.rfind('/', 0) == 0 ? topic : "/" + topic) == own.end()) return;
  for (const bags::StampedPose& one : transforms) tree_.Add(one, true);
}

std::string PoseFrames::Text(const Frames& frames) {
  return "the pose of " + (frames.child.empty() ? "a body without a name" : Quoted(frames.child)) + " in " +
         (frames.frame.empty() ? "a frame without a name" : Quoted(frames.frame));
}

std::string PoseFrames::Doubt() const {
  if (has_transforms_) return tree_.Doubt(sensor_->frame, sensor_->child_frame);
  if (!sensor_->child_frame.empty() || !other_) return "";
  return "its topic has " + Text(*first_) + " and " + Text(*other_) + ": nothing tells which is meant. " + kSayWhich;
}

std::string PoseFrames::WhyNone() const {
  if (has_transforms_) return tree_.WhyNone(sensor_->frame, sensor_->child_frame);
  if (!other_) return "";
  return "its topic has " + Text(*other_) + ", and not that of " + Quoted(sensor_->child_frame) + " in " +
         Quoted(sensor_->frame) + ", as rig.yaml says";
}

}  // namespace rigcal::importing
