// Tells the programs of a ROS 2 robot a calibration: /tf_static, and camera_info of each camera where that is wanted.
// One thread.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/ros/messages.h"
#include "idl/dds.h"

namespace rigcal::client {

struct RosSide {
  int domain = 0;            // ROS_DOMAIN_ID; RIGCAL_DOMAIN does not count
  std::string tag = {};      // DDS discovery tag; programs of ROS 2 have none
  bool camera_info = false;  // publish that, too
};

class RosBroadcast {
 public:
  [[nodiscard]] static Result<RosBroadcast> Open(const RosSide& side);
  // From now on, for readers that are there and that come later, until the next call. Whose topics are gone get nothing
  // new. Gives sentences without a full stop: what is left out beside what `calibration` says itself.
  [[nodiscard]] Result<std::vector<std::string>> Publish(const exports::Calibration& calibration);
  // Who comes later is told nothing any more; readers keep what they have: ROS 2 cannot take a static transform back.
  void Withdraw();
  // Until every reader that discovery shows has all that was published; kUnreachable where none of /tf_static is there,
  // or one does not acknowledge, within `timeout`.
  [[nodiscard]] Status AwaitReaders(std::chrono::milliseconds timeout);

  [[nodiscard]] bool is_published() const { return transforms_.has_value(); }
  [[nodiscard]] int domain() const { return side_.domain; }
  // As ROS 2 names them: "/tf_static", "/front_left/camera_info".
  [[nodiscard]] std::vector<std::string> Topics() const;

 private:
  using CameraWriters = std::map<std::string, wire::Writer<wire::RosCameraInfo>>;  // by topic
  RosBroadcast(const RosSide& side, wire::Participant participant)
      : side_(side), participant_(std::move(participant)) {}
  [[nodiscard]] Status PublishTransforms(const exports::Calibration& calibration);
  [[nodiscard]] Status PublishCameras(const exports::Calibration& calibration, std::vector<std::string>& left_out);
  [[nodiscard]] Status AwaitDiscovery(std::chrono::milliseconds timeout);

  RosSide side_;
  wire::Participant participant_;
  std::optional<wire::Writer<wire::RosTransforms>> transforms_ = {};
  CameraWriters cameras_ = {};
};

}  // namespace rigcal::client
