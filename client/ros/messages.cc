#include "client/ros/messages.h"

#include <algorithm>
#include <vector>

#include "server/formats/export/file_text.h"
#include "server/formats/export/ros_camera.h"

namespace rigcal::client {
namespace {

constexpr std::int64_t kNsPerS = 1'000'000'000;

// What the pointers of a message refer to.
struct RosMemory {
  std::string frame;
  std::vector<std::string> children = {};
  std::vector<geometry_msgs_msg_dds__TransformStamped_> transforms = {};
  std::vector<double> numbers = {};
  std::string words = {};
};

void SetHeader(std_msgs_msg_dds__Header_& header, std::string& frame, Stamp stamp) {
  header.stamp.sec = static_cast<std::int32_t>(stamp.ns / kNsPerS);
  header.stamp.nanosec = static_cast<std::uint32_t>(stamp.ns % kNsPerS);
  header.frame_id = frame.data();
}

geometry_msgs_msg_dds__Transform_ TransformOf(const Se3& T) {
  return {{T.p_m.x(), T.p_m.y(), T.p_m.z()}, {T.q.x(), T.q.y(), T.q.z(), T.q.w()}};
}

void CopyRows(const Eigen::MatrixXd& matrix, double* to) {
  const std::vector<double> rows = exports::RowsOf(matrix);
  std::copy(rows.begin(), rows.end(), to);
}

// Every character that is not allowed is an underscore, of several in a row the first.
std::string RosName(const std::string& sensor) {
  std::string name;
  for (const char c : sensor) {
    const bool is_word = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (is_word || name.empty() || name.back() != '_') name += is_word ? c : '_';
  }
  const bool is_first_allowed = !name.empty() && !(name.front() >= '0' && name.front() <= '9') && name.front() != '_';
  return is_first_allowed ? name : "camera" + std::string(name.front() == '_' ? "" : "_") + name;
}

}  // namespace

wire::Owned<wire::RosTransforms> TransformsOf(const exports::Calibration& calibration, Stamp stamp) {
  auto memory = std::make_shared<RosMemory>(RosMemory{calibration.root_frame()});
  std::vector<const exports::ExportedSensor*> children;
  for (const exports::ExportedSensor& sensor : calibration.sensors)
    if (sensor.sensor != calibration.root) children.push_back(&sensor);
  for (const exports::ExportedSensor* sensor : children) memory->children.push_back(sensor->frame);
  for (std::size_t i = 0; i < children.size(); ++i) {
    geometry_msgs_msg_dds__TransformStamped_ one{};
    SetHeader(one.header, memory->frame, stamp);
    one.child_frame_id = memory->children[i].data();
    one.transform = TransformOf(children[i]->T_root_sensor);
    memory->transforms.push_back(one);
  }
  wire::Owned<wire::RosTransforms> message;
  message.sample.transforms._length = message.sample.transforms._maximum =
      static_cast<std::uint32_t>(memory->transforms.size());
  message.sample.transforms._buffer = memory->transforms.data();
  message.memory = std::move(memory);
  return message;
}

wire::Owned<wire::RosCameraInfo> CameraInfoOf(const exports::ExportedSensor& camera, Stamp stamp) {
  exports::RosCamera ros = exports::RosCameraOf(*camera.camera);
  auto memory = std::make_shared<RosMemory>(RosMemory{camera.frame});
  memory->numbers = std::move(ros.D);
  memory->words = std::move(ros.distortion_model);
  wire::Owned<wire::RosCameraInfo> message;
  wire::RosCameraInfo& info = message.sample;
  SetHeader(info.header, memory->frame, stamp);
  info.width = static_cast<std::uint32_t>(ros.width_px);
  info.height = static_cast<std::uint32_t>(ros.height_px);
  info.distortion_model = memory->words.data();
  info.d._length = info.d._maximum = static_cast<std::uint32_t>(memory->numbers.size());
  info.d._buffer = memory->numbers.data();
  CopyRows(ros.K, info.k);
  CopyRows(ros.R, info.r);
  CopyRows(ros.P, info.p);
  message.memory = std::move(memory);
  return message;
}

Result<std::map<std::string, const exports::ExportedSensor*>> CameraTopics(
    const std::vector<const exports::ExportedSensor*>& cameras) {
  std::map<std::string, const exports::ExportedSensor*> topics;
  for (const exports::ExportedSensor* camera : cameras) {
    const std::string topic = wire::kRosTopics + RosName(camera->sensor.str()) + "/camera_info";
    const auto [taken, is_new] = topics.emplace(topic, camera);
    if (!is_new)
      return Fail(ErrorCode::kInvalidInput,
                  "cameras '" + taken->second->sensor.str() + "' and '" + camera->sensor.str() +
                      "' would both have the topic " + topic,
                  "Leave --camera-info away, or name the cameras so that they differ by letters or digits.");
  }
  return topics;
}

}  // namespace rigcal::client
