#include "client/import/intake.h"

#include <map>
#include <memory>
#include <set>

#include "client/bags/messages/header.h"
#include "client/bags/messages/image.h"
#include "client/bags/messages/motion.h"
#include "client/bags/open_bag.h"
#include "client/import/files.h"
#include "client/import/frame_tree.h"
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

class Taker {
 public:
  explicit Taker(const RigMap& map) : map_(map), trees_(map.sensors.size()) {
    intake_.sensors.resize(map.sensors.size());
    for (std::size_t s = 0; s < map.sensors.size(); ++s) by_topic_[map.sensors[s].topic].push_back(s);
  }

  Status Take(const bags::Message& message) {
    const auto sensors = by_topic_.find(message.topic->name);
    const bool is_static =
        bags::KindOf(message.topic->type) == bags::MessageKind::kTransforms && EndsIn(message.topic->name, "tf_static");
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
    if (sensor.stamps_ns.empty()) LearnEncoding(sensor, message, *definition);
    const auto bytes = static_cast<std::uint32_t>(message.bytes.size());
    if (map_.sensors[s].stamp == StampSource::kLog) return KeepFile(sensor, message.log_ns, ordinal, bytes);
    const auto header = bags::ReadHeader(*message.topic, *definition, message.bytes);
    if (!header) return Refuse(sensor, Sentence(header.error()));
    if (!*header) return Refuse(sensor, "its messages have no header. Set `stamp: log` in rig.yaml");
    KeepFile(sensor, (*header)->stamp_ns, ordinal, bytes);
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
    KeepPose(s, *pose, message.log_ns, ordinal);
  }

  void TakeTransforms(std::size_t s, const bags::Value& value, std::int64_t log_ns, std::uint32_t ordinal) {
    const MappedSensor& mapped = map_.sensors[s];
    if (mapped.child_frame.empty())
      return Refuse(intake_.sensors[s], "it has the poses of many frames. Set `frame` and `child_frame` in rig.yaml");
    const auto transforms = bags::ReadTransforms(value);
    if (!transforms) return Refuse(intake_.sensors[s], Sentence(transforms.error()));
    for (const bags::StampedPose& one : *transforms) trees_[s].Add(one, false);
    const auto pose = trees_[s].Pose(mapped.frame, mapped.child_frame, map_.tolerance_ns);
    const std::vector<std::int64_t>& stamps = intake_.sensors[s].stamps_ns;
    const bool is_new =
        pose && (stamps.empty() || mapped.stamp == StampSource::kLog || pose->header.stamp_ns > stamps.back());
    if (is_new) KeepPose(s, *pose, log_ns, ordinal);
  }
  void TakeStatic(const bags::Message& message, const bags::Definition& definition) {
    const auto value = bags::Decode(*message.topic, definition, message.bytes);
    const auto transforms = value ? bags::ReadTransforms(*value) : Fail(value.error());
    if (!transforms) return;
    for (FrameTree& tree : trees_)
      for (const bags::StampedPose& one : *transforms) tree.Add(one, true);
  }

  void KeepPose(std::size_t s, const bags::StampedPose& pose, std::int64_t log_ns, std::uint32_t ordinal) {
    Keep(intake_.sensors[s], map_.sensors[s].stamp == StampSource::kLog ? log_ns : pose.header.stamp_ns, ordinal);
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
  std::vector<FrameTree> trees_;
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
