#include "client/import/watch.h"

#include <map>
#include <memory>
#include <variant>

#include "client/bags/messages/image.h"
#include "client/bags/open_bag.h"
#include "client/import/files.h"
#include "client/moments/picture_watcher.h"
#include "server/base/process/parallel_for.h"
#include "server/base/text.h"

namespace rigcal::importing {
namespace {

constexpr std::int64_t kWatchProgressEvery = 64;
constexpr std::size_t kHeldBytesMax = 48 << 20, kHeldPicturesMax = 256;

// A picture away from its message: as a file, or as pixels.
using Held = std::variant<std::vector<std::byte>, Pixels>;

Result<Held> HeldOf(const bags::Message& message, const bags::Value& value) {
  if (bags::KindOf(message.topic->type) == bags::MessageKind::kCompressedImage) {
    RIGCAL_ASSIGN(const bags::CompressedImage file, bags::ReadCompressedImage(value));
    return Held(std::vector<std::byte>(file.data.begin(), file.data.end()));
  }
  RIGCAL_ASSIGN(const bags::Image image, bags::ReadImage(value));
  return Held(CopyOf(image));
}

Result<detect::GreyImage> GreyOfHeld(const Held& held) {
  if (const auto* file = std::get_if<std::vector<std::byte>>(&held)) return detect::DecodeGrey(*file);
  return GreyOf(std::get<Pixels>(held).image);
}

// One camera: what waits to be looked at, and what was seen.
struct Camera {
  struct Waiting {
    std::size_t stamp_idx;
    Held picture;
  };
  std::size_t sensor = 0;
  std::size_t next = 0;  // of its intake
  moments::PictureWatcher watcher;
  std::vector<Waiting> waiting;
};

class Watch {
 public:
  Watch(const RigMap& map, const Intake& intake) : intake_(intake), watched_(map.sensors.size()) {
    for (std::size_t s = 0; s < map.sensors.size(); ++s) {
      if (map.sensors[s].kind != SensorKind::kCamera) continue;
      watched_[s].sights.resize(intake.sensors[s].stamps_ns.size());
      for (std::size_t i = 0; i < watched_[s].sights.size(); ++i)
        watched_[s].sights[i].stamp_ns = intake.sensors[s].stamps_ns[i];
      by_topic_[map.sensors[s].topic].push_back(cameras_.size());
      cameras_.push_back(
          {s, 0, moments::PictureWatcher(TargetsOf(map.header, *SensorOf(map.header, map.sensors[s].id))), {}});
    }
  }

  void Take(const bags::Message& message) {
    const auto cameras = by_topic_.find(message.topic->name);
    if (cameras == by_topic_.end()) return;
    const std::uint32_t ordinal = ordinals_[message.topic->name]++;
    for (const std::size_t c : cameras->second) {
      const std::vector<std::uint32_t>& wanted = intake_.sensors[cameras_[c].sensor].ordinals;
      if (cameras_[c].next < wanted.size() && wanted[cameras_[c].next] == ordinal) Hold(cameras_[c], message);
    }
    if (held_bytes_ >= kHeldBytesMax || held_ >= kHeldPicturesMax) LookAtHeld();
  }

  std::vector<WatchedPictures> Finish() {
    LookAtHeld();
    return std::move(watched_);
  }

 private:
  void Hold(Camera& camera, const bags::Message& message) {
    const std::size_t stamp_idx = camera.next++;
    auto& definition = definitions_[message.topic];
    if (!definition) {
      auto read = bags::DefinitionOf(*message.topic);
      if (!read) return Trouble(camera, read.error());
      definition = *read;
    }
    const auto value = bags::Decode(*message.topic, *definition, message.bytes);
    if (!value) return Trouble(camera, value.error());
    auto held = HeldOf(message, *value);
    if (!held) return Trouble(camera, held.error());
    held_bytes_ += message.bytes.size();
    ++held_;
    camera.waiting.push_back({stamp_idx, *std::move(held)});
  }

  void LookAtHeld() {
    ParallelFor(cameras_.size(), [&](std::size_t c) { RunApart([&] { LookAt(cameras_[c]); }); });
    held_bytes_ = 0, held_ = 0;
  }
  void LookAt(Camera& camera) {
    for (const Camera::Waiting& one : camera.waiting) {
      auto grey = GreyOfHeld(one.picture);
      if (!grey) {
        Trouble(camera, grey.error());
        continue;
      }
      moments::Sight& sight = watched_[camera.sensor].sights[one.stamp_idx];
      sight = camera.watcher.Look(*std::move(grey), sight.stamp_ns);
    }
    camera.waiting.clear();
  }

  void Trouble(const Camera& camera, const Error& error) {
    WatchedPictures& watched = watched_[camera.sensor];
    if (watched.unreadable++ == 0) watched.first_trouble = Sentence(error);
  }

  const Intake& intake_;
  std::vector<WatchedPictures> watched_;
  std::vector<Camera> cameras_;
  std::map<std::string, std::vector<std::size_t>> by_topic_;
  std::map<std::string, std::uint32_t> ordinals_;
  std::map<std::shared_ptr<const bags::Topic>, std::shared_ptr<const bags::Definition>> definitions_;
  std::size_t held_bytes_ = 0, held_ = 0;
};

Status CheckCount(const RigMap& map, const Intake& intake) {
  std::size_t pictures = 0;
  for (std::size_t s = 0; s < map.sensors.size(); ++s)
    if (map.sensors[s].kind == SensorKind::kCamera) pictures += intake.sensors[s].stamps_ns.size();
  if (pictures <= kWatchedPicturesMax) return {};
  return Fail(ErrorCode::kInvalidInput,
              "the bag has " + std::to_string(pictures) + " pictures; still moments are chosen of " +
                  std::to_string(kWatchedPicturesMax) + " at most",
              "Split the bag, or set `moments: all` in rig.yaml.");
}

}  // namespace

std::vector<const Target*> TargetsOf(const SessionHeader& header, const Sensor& camera) {
  return CommonTargets(header, camera, camera);
}

Result<std::vector<WatchedPictures>> WatchPictures(const std::filesystem::path& path, const RigMap& map,
                                                   const Intake& intake, const Progress& progress) {
  RIGCAL_TRY(CheckCount(map, intake));
  RIGCAL_ASSIGN(const std::unique_ptr<bags::Bag> bag, bags::OpenBag(path));
  Watch watch(map, intake);
  bags::Message message;
  for (std::int64_t count = 1; bag->Next(message); ++count) {
    watch.Take(message);
    if (count % kWatchProgressEvery == 0 && progress) progress(bag->bytes_done(), bag->bytes_total());
  }
  return watch.Finish();
}

}  // namespace rigcal::importing
