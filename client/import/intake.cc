#include "client/import/intake.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>

#include "client/bags/messages/header.h"
#include "client/bags/messages/image.h"
#include "client/bags/messages/motion.h"
#include "client/bags/open_bag.h"
#include "client/import/files.h"
#include "client/import/pose_frames.h"
#include "client/import/sensor_messages.h"
#include "client/import/topic_tally.h"
#include "server/base/near_names.h"
#include "server/base/text.h"
#include "server/formats/edges/first_three.h"

namespace rigcal::importing {
namespace {

constexpr std::int64_t kProgressEvery = 256;

bool HasPoses(SensorKind kind) { return kind == SensorKind::kTracker || kind == SensorKind::kPoseStream; }

bool EndsIn(const std::string& text, std::string_view end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// Where drivers send the camera info of pictures: beside them, and of "/left/image_raw/compressed" beside the others.
std::string CameraInfoTopicOf(std::string pictures) {
  if (EndsIn(pictures, "/compressed")) pictures.resize(pictures.rfind('/'));
  const std::size_t end = pictures.rfind('/');
  return (end == std::string::npos ? "" : pictures.substr(0, end + 1)) + "camera_info";
}

class Taker {
 public:
  explicit Taker(const RigMap& map) : map_(map), frames_(map.sensors.begin(), map.sensors.end()) {
    intake_.sensors.resize(map.sensors.size());
    for (std::size_t s = 0; s < map.sensors.size(); ++s) by_topic_[map.sensors[s].topic].push_back(s);
    for (const MappedSensor& sensor : map.sensors)
      if (sensor.kind == SensorKind::kCamera) infos_[CameraInfoTopicOf(sensor.topic)];
  }

  Status Take(const bags::Message& message) {
    const auto sensors = by_topic_.find(message.topic->name);
    const bool is_static =
        bags::KindOf(message.topic->type) == bags::MessageKind::kTransforms && EndsIn(message.topic->name, "tf_static");
    if (bags::KindOf(message.topic->type) == bags::MessageKind::kCameraInfo) TakeInfo(message);
    if (sensors == by_topic_.end() && !is_static) return {};
    const bags::Definition* definition = DefinitionOf(message.topic);
    if (is_static && definition != nullptr) TakeStatic(message, *definition);
    if (sensors == by_topic_.end()) return {};
    for (const std::size_t s : sensors->second) {
      TakeFor(s, message, definition);
      if (++taken_ > kStampsMax)
        return Fail(ErrorCode::kInvalidInput,
                    "the sensors of the rig have more than " + std::to_string(kStampsMax) + " messages in this bag",
                    "Split the bag, or take a fast topic out of rig.yaml.");
    }
    return {};
  }
  Intake Finish(const bags::Bag& bag) {
    intake_.damage = bag.Unread().All();
    for (std::size_t s = 0; s < map_.sensors.size(); ++s)
      if (HasPoses(map_.sensors[s].kind)) SettlePoses(s);
    for (std::size_t s = 0; s < map_.sensors.size(); ++s) TellCameraChange(s);
    return std::move(intake_);
  }
  void Begin(std::int64_t log_ns) {
    intake_.first = Stamp{began_ ? std::min(intake_.first.ns, log_ns) : log_ns}, began_ = true;
  }

 private:
  // Null: it has none, and every message of it is refused.
  const bags::Definition* DefinitionOf(const std::shared_ptr<const bags::Topic>& topic) {
    const auto known = definitions_.find(topic);
    if (known != definitions_.end()) return known->second.get();
    auto definition = bags::DefinitionOf(*topic);
    if (!definition) trouble_[topic->name] = Sentence(definition.error());
    return (definitions_[topic] = definition ? *definition : nullptr).get();
  }

  void TakeFor(std::size_t s, const bags::Message& message, const bags::Definition* definition) {
    SensorIntake& sensor = intake_.sensors[s];
    const std::uint32_t ordinal = sensor.messages++;
    if (definition == nullptr) return Refuse(sensor, trouble_[message.topic->name]);
    if (HasPoses(map_.sensors[s].kind)) return TakePoses(s, message, *definition, ordinal);
    if (const std::string why = WhyNoFile(s, message.topic->type); !why.empty()) return Refuse(sensor, why);
    if (sensor.stamps_ns.empty()) LearnEncoding(sensor, message, *definition);
    const auto bytes = static_cast<std::uint32_t>(message.bytes.size());
    if (map_.sensors[s].stamp == StampSource::kLog)
      return KeepFile(sensor, OnRigClock(s, message.log_ns), ordinal, bytes);
    const auto header = bags::ReadHeader(*message.topic, *definition, message.bytes);
    if (!header) return Refuse(sensor, Sentence(header.error()));
    if (!*header) return Refuse(sensor, "its messages have no header. Set `stamp: log` in rig.yaml");
    KeepFile(sensor, OnRigClock(s, (*header)->stamp_ns), ordinal, bytes);
  }

  // A camera has no clouds, and a lidar no pictures.
  [[nodiscard]] std::string WhyNoFile(std::size_t s, const std::string& type) const {
    const std::vector<bags::MessageKind> kinds = KindsFor(map_.sensors[s]);
    if (std::find(kinds.begin(), kinds.end(), bags::KindOf(type)) != kinds.end()) return "";
    return "messages of type " + Quoted(type) + " are nothing that a " + NameOf(map_.sensors[s].kind) +
           " has: it takes " + TypesText(kinds);
  }

  void TakeInfo(const bags::Message& message) {
    const auto watch = infos_.find(message.topic->name);
    const bags::Definition* definition = watch == infos_.end() ? nullptr : DefinitionOf(message.topic);
    if (definition == nullptr) return;
    const auto value = bags::Decode(*message.topic, *definition, message.bytes);
    const auto info = value ? bags::ReadCameraInfo(*value) : Fail(value.error());
    if (info) watch->second.Add(*info, message.log_ns);
  }
  void TellCameraChange(std::size_t s) {
    if (map_.sensors[s].kind != SensorKind::kCamera) return;
    const std::string topic = CameraInfoTopicOf(map_.sensors[s].topic), change = infos_[topic].Change();
    if (!change.empty()) intake_.sensors[s].camera_change = topic + " " + change;
  }

  // Demosaiced, or with the colours that YUV shares, a picture is larger than its message.
  static void LearnEncoding(SensorIntake& sensor, const bags::Message& message, const bags::Definition& definition) {
    if (bags::KindOf(message.topic->type) != bags::MessageKind::kImage) return;
    const auto value = bags::Decode(*message.topic, definition, message.bytes);
    const auto image = value ? bags::ReadImage(*value) : Fail(value.error());
    if (image) sensor.file_ratio = PngBytesRatio(image->encoding);
  }

  void TakePoses(std::size_t s, const bags::Message& message, const bags::Definition& definition,
                 std::uint32_t ordinal) {
    SensorIntake& sensor = intake_.sensors[s];
    const auto value = bags::Decode(*message.topic, definition, message.bytes);
    if (!value) return Refuse(sensor, Sentence(value.error()));
    const bags::MessageKind kind = bags::KindOf(message.topic->type);
    if (kind == bags::MessageKind::kTransforms) return TakeTransforms(s, *value, message.log_ns, ordinal);
    if (kind != bags::MessageKind::kPose && kind != bags::MessageKind::kOdometry)
      return Refuse(sensor, "messages of type " + Quoted(message.topic->type) + " have no pose");
    const auto pose = bags::ReadPose(*value);
    if (!pose) return Refuse(sensor, Sentence(pose.error()));
    if (const auto own = frames_[s].Take(*pose)) KeepPose(s, *own, message.log_ns, ordinal);
  }

  void TakeTransforms(std::size_t s, const bags::Value& value, std::int64_t log_ns, std::uint32_t ordinal) {
    if (map_.sensors[s].child_frame.empty())
      return Refuse(intake_.sensors[s], "it has the poses of many frames. Set `frame` and `child_frame` in rig.yaml");
    const auto transforms = bags::ReadTransforms(value);
    if (!transforms) return Refuse(intake_.sensors[s], Sentence(transforms.error()));
    const auto pose = frames_[s].Take(*transforms, map_.tolerance_ns);
    if (!pose) return;
    const std::vector<std::int64_t>& stamps = intake_.sensors[s].stamps_ns;
    if (stamps.empty() || OnRigClock(s, *pose, log_ns) > stamps.back()) KeepPose(s, *pose, log_ns, ordinal);
  }
  void TakeStatic(const bags::Message& message, const bags::Definition& definition) {
    const auto value = bags::Decode(*message.topic, definition, message.bytes);
    const auto transforms = value ? bags::ReadTransforms(*value) : Fail(value.error());
    if (!transforms) return;
    for (PoseFrames& frames : frames_) frames.TakeStatic(message.topic->name, *transforms);
  }
  // Once all came: in doubt whose poses they are the sensor has none, and where it has none it is told why.
  void SettlePoses(std::size_t s) {
    SensorIntake& sensor = intake_.sensors[s];
    std::string why = frames_[s].Doubt();
    if (why.empty() && sensor.stamps_ns.empty() && sensor.refused == 0) why = frames_[s].WhyNone();
    if (why.empty()) return;
    sensor.stamps_ns.clear(), sensor.ordinals.clear(), sensor.poses.clear();
    sensor.refused = sensor.messages, sensor.first_refusal = why;
  }

  [[nodiscard]] std::int64_t OnRigClock(std::size_t s, const bags::StampedPose& pose, std::int64_t log_ns) const {
    return OnRigClock(s, map_.sensors[s].stamp == StampSource::kLog ? log_ns : pose.header.stamp_ns);
  }
  [[nodiscard]] std::int64_t OnRigClock(std::size_t s, std::int64_t stamp_ns) const {
    return stamp_ns - std::llround(map_.sensors[s].clock_offset_s.value_or(0.0) * 1e9);
  }
  void KeepPose(std::size_t s, const bags::StampedPose& pose, std::int64_t log_ns, std::uint32_t ordinal) {
    Keep(intake_.sensors[s], OnRigClock(s, pose, log_ns), ordinal);
    intake_.sensors[s].poses.push_back(pose.T_frame_child);
  }
  static void Keep(SensorIntake& sensor, std::int64_t stamp_ns, std::uint32_t ordinal) {
    sensor.stamps_ns.push_back(stamp_ns);
    sensor.ordinals.push_back(ordinal);
  }
  static void KeepFile(SensorIntake& sensor, std::int64_t stamp_ns, std::uint32_t ordinal, std::uint32_t bytes) {
    Keep(sensor, stamp_ns, ordinal);
    sensor.message_bytes.push_back(bytes);
  }
  static void Refuse(SensorIntake& sensor, const std::string& why) {
    if (sensor.refused++ == 0) sensor.first_refusal = why;
  }

  const RigMap& map_;
  Intake intake_;
  bool began_ = false;
  std::size_t taken_ = 0;
  std::map<std::string, std::vector<std::size_t>> by_topic_;
  std::map<std::shared_ptr<const bags::Topic>, std::shared_ptr<const bags::Definition>> definitions_;
  std::map<std::string, std::string> trouble_;
  std::vector<PoseFrames> frames_;                // of each sensor
  std::map<std::string, CameraInfoWatch> infos_;  // of the cameras, by topic
};

Status CheckTopics(const bags::Bag& bag, const RigMap& map) {
  std::set<std::string> there;
  for (const auto& topic : bag.Topics())
    if (IsPrintableUtf8(topic->name)) there.insert(topic->name);
  const std::vector<std::string> names(there.begin(), there.end());
  for (const MappedSensor& sensor : map.sensors) {
    if (there.count(sensor.topic) > 0) continue;
    const std::string near = Suggestion(NearestNames(sensor.topic, names));
    return Fail(
        ErrorCode::kInvalidInput,
        "the bag has no topic " + Quoted(sensor.topic) + ", which rig.yaml has for " + Quoted(sensor.id.str()) + near,
        "It has " +
            (names.empty() ? "none"
                           : formats::FirstThree(names.size(), [&](std::size_t i) { return Quoted(names[i]); })) +
            "; `rigcal import BAG --list` shows them.");
  }
  return {};
}

}  // namespace

Result<Intake> TakeIn(const std::filesystem::path& path, const RigMap& map, const Progress& progress) {
  RIGCAL_ASSIGN(const std::unique_ptr<bags::Bag> bag, bags::OpenBag(path));
  Taker taker(map);
  bags::Message message;
  for (std::int64_t count = 1; bag->Next(message); ++count) {
    taker.Begin(message.log_ns);
    RIGCAL_TRY(taker.Take(message));
    if (count % kProgressEvery == 0 && progress) progress(bag->bytes_done(), bag->bytes_total());
  }
  RIGCAL_TRY(CheckTopics(*bag, map));
  return taker.Finish(*bag);
}

}  // namespace rigcal::importing
