#include "client/ros/broadcast.h"

#include <algorithm>
#include <utility>

#include "client/ros/ros_place.h"
#include "server/formats/export/file_text.h"

namespace rigcal::client {
namespace {

using std::chrono::milliseconds;
using RosClock = std::chrono::steady_clock;

constexpr milliseconds kNobodyNew(400);  // after so long without a new reader all that are there are met

milliseconds RosTimeLeft(RosClock::time_point end) {
  return std::max(milliseconds(0), std::chrono::duration_cast<milliseconds>(end - RosClock::now()));
}

std::string InSeconds(milliseconds time) {
  std::string text = std::to_string(time.count() / 1000);
  if (time.count() % 1000 != 0) text += "." + std::to_string(time.count() % 1000 / 100);
  return text + " s";
}

std::string NameInRos(const std::string& topic) { return "/" + topic.substr(std::string(wire::kRosTopics).size()); }

}  // namespace

Result<RosBroadcast> RosBroadcast::Open(const RosSide& side) {
  RIGCAL_ASSIGN(auto participant, OpenRosParticipant(side.domain, side.tag));
  return RosBroadcast(side, std::move(participant));
}

Result<std::vector<std::string>> RosBroadcast::Publish(const exports::Calibration& calibration) {
  std::vector<std::string> left_out;
  RIGCAL_TRY(PublishTransforms(calibration));
  if (side_.camera_info) RIGCAL_TRY(PublishCameras(calibration, left_out));
  return left_out;
}

Status RosBroadcast::PublishTransforms(const exports::Calibration& calibration) {
  if (!transforms_) {
    RIGCAL_ASSIGN(transforms_, wire::Writer<wire::RosTransforms>::Open(participant_, {}));
  }
  return transforms_->Write(TransformsOf(calibration).sample);
}

// Transforms are of use without cameras, so that there is none is said, and no error.
Status RosBroadcast::PublishCameras(const exports::Calibration& calibration, std::vector<std::string>& left_out) {
  const auto with_lens = exports::CamerasToWrite(calibration, "", left_out);
  if (!with_lens) left_out.push_back("camera_info: " + with_lens.error().what);
  std::vector<const exports::ExportedSensor*> cameras;
  if (with_lens) cameras = *with_lens;
  // Who is left out is said there; that none is left is no error either.
  static_cast<void>(exports::LeaveOutSpheres(cameras, "camera_info", left_out));
  RIGCAL_ASSIGN(const auto topics, CameraTopics(cameras));
  std::erase_if(cameras_, [&](const auto& one) { return !topics.contains(one.first); });
  for (const auto& [topic, camera] : topics) {
    if (!cameras_.contains(topic)) {
      RIGCAL_ASSIGN(auto writer, wire::Writer<wire::RosCameraInfo>::OpenCalled(participant_, topic));
      cameras_.emplace(topic, std::move(writer));
    }
    RIGCAL_TRY(cameras_.at(topic).Write(CameraInfoOf(*camera).sample));
  }
  return {};
}

void RosBroadcast::Withdraw() {
  transforms_.reset();
  cameras_.clear();
}

// A reader is told once it is met; who is met last is not known, so all that come shortly after one another are waited
// for.
Status RosBroadcast::AwaitDiscovery(milliseconds timeout) {
  const auto end = RosClock::now() + timeout;
  const Error nobody{
      ErrorCode::kUnreachable,
      "nobody in ROS domain " + std::to_string(side_.domain) + " reads /tf_static (waited " + InSeconds(timeout) + ")",
      "Start the programs that read it, check --ros-domain, or leave --once away: then it stays for who comes later."};
  if (!transforms_->WaitForReader(timeout)) return Fail(nobody);
  RIGCAL_ASSIGN(auto waitset, wire::WaitSet::Open(participant_));
  RIGCAL_TRY(waitset.Attach(transforms_->get()));
  for (auto& [topic, writer] : cameras_) RIGCAL_TRY(waitset.Attach(writer.get()));
  bool any_new = true;
  while (any_new && RosClock::now() < end) {
    RIGCAL_ASSIGN(any_new, waitset.Wait(std::min(kNobodyNew, RosTimeLeft(end))));
  }
  return {};
}

Status RosBroadcast::AwaitReaders(milliseconds timeout) {
  const auto end = RosClock::now() + timeout;
  RIGCAL_TRY(AwaitDiscovery(timeout));
  bool all = transforms_->WaitForAcks(RosTimeLeft(end)).has_value();
  for (const auto& [topic, writer] : cameras_) all = all && writer.WaitForAcks(RosTimeLeft(end)).has_value();
  if (all) return {};
  return Fail(
      ErrorCode::kUnreachable,
      "a reader in ROS domain " + std::to_string(side_.domain) + " did not acknowledge within " + InSeconds(timeout),
      "Give it longer (--timeout), or leave --once away: then it is sent until it has arrived.");
}

std::vector<std::string> RosBroadcast::Topics() const {
  std::vector<std::string> topics;
  if (transforms_) topics.push_back(NameInRos(wire::InfoOf<wire::RosTransforms>().name));
  for (const auto& [topic, writer] : cameras_) topics.push_back(NameInRos(topic));
  return topics;
}

}  // namespace rigcal::client
