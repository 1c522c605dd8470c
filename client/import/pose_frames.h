// The poses that one sensor of rig.yaml has of the messages of its topic: whose, and in which frame. A topic may carry
// those of several bodies, or change its frame half-way: what is not of this sensor's frames is not taken for it, and
// where nothing tells which poses are meant, none is.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/import/frame_tree.h"
#include "client/import/rig_map.h"

namespace rigcal::importing {

class PoseFrames {
 public:
  explicit PoseFrames(const MappedSensor& sensor) : sensor_(&sensor), tree_() {}

  // Of a message with one pose. Nothing: it is another body's or in another frame than rig.yaml says.
  [[nodiscard]] std::optional<bags::StampedPose> Take(bags::StampedPose pose);
  // Of a message with the poses of many frames, for which rig.yaml has `frame` and `child_frame`. Nothing: it
  // has none of those between, or as of FrameTree::Pose.
  [[nodiscard]] std::optional<bags::StampedPose> Take(const std::vector<bags::StampedPose>& transforms,
                                                      std::int64_t tolerance_ns);
  // Transforms that hold for all time, of a topic of this name; only those of StaticTopicsFor are taken.
  void TakeStatic(const std::string& topic, const std::vector<bags::StampedPose>& transforms);

  // Why no pose that was taken can be relied on; empty: they can.
  [[nodiscard]] std::string Doubt() const;
  // Why no pose was taken, if none was; empty: nothing is known against its messages.
  [[nodiscard]] std::string WhyNone() const;

 private:
  struct Frames {
    std::string child, frame;
    friend bool operator==(const Frames&, const Frames&) = default;
  };
  [[nodiscard]] static std::string Text(const Frames& frames);

  const MappedSensor* sensor_;
  FrameTree tree_;
  bool has_transforms_ = false;
  std::optional<Frames> first_, other_;  // of messages with one pose; `other_`: that differ, from rig.yaml if it says
};

}  // namespace rigcal::importing
