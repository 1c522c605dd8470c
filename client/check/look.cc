#include "client/check/look.h"

#include <mutex>

#include "client/check/edge_width.h"
#include "server/base/files/durable_file.h"
#include "server/base/limits.h"
#include "server/base/process/parallel_for.h"
#include "server/detect/board.h"
#include "server/formats/clouds/cloud.h"
#include "server/formats/clouds/cloud_oddities.h"
#include "server/formats/sessions/payload_path.h"
#include "server/formats/sessions/poses.h"
#include "server/formats/sessions/session_folder.h"

namespace rigcal::check {
namespace {

namespace fs = std::filesystem;

// A picture that cannot be read, as detect::Detect tells it.
PictureSeen UnreadablePicture(const std::string& path, const Error& error, const std::vector<const Target*>& targets) {
  PictureSeen picture;
  picture.path = path;
  picture.why_not = error.what + "; " + error.cure;
  for (const Target* target : targets) {
    BoardView& view = picture.seen[target->id].view;
    view.target = target->id;
    view.why_not = picture.why_not;
  }
  return picture;
}

// One of a payload; its place in SessionSeen is made before, so that threads do not meet.
struct FileToLookAt {
  const Payload* payload = nullptr;
  const Sensor* sensor = nullptr;
  PictureSeen* picture = nullptr;
  CloudSeen* cloud = nullptr;
  PoseTable* poses = nullptr;
  std::vector<const Target*> targets;
};

FileToLookAt FileOf(const Payload& payload, SessionSeen& session) {
  FileToLookAt file;
  file.payload = &payload;
  file.sensor = SensorOf(session.manifest.header, payload.sensor);
  if (file.sensor->kind == SensorKind::kCamera) {
    file.picture = &session.pictures[payload.sensor][payload.capture];
    file.targets = CommonTargets(session.manifest.header, *file.sensor, *file.sensor);
  } else if (file.sensor->kind == SensorKind::kLidar) {
    file.cloud = &session.clouds[payload.sensor][payload.capture];
  } else {
    file.poses = &session.poses[payload.sensor];
  }
  return file;
}

// The survey has read the table before.
void LookAtPoses(const std::string& text, const FileToLookAt& file) {
  auto table = formats::ReadPoses(text, file.sensor->kind, file.payload->path);
  if (table) *file.poses = *std::move(table);
}

void LookAtFile(const fs::path& folder, const FileToLookAt& file) {
  const auto text = ReadFile(folder / file.payload->path, static_cast<std::size_t>(limits::kPayloadBytesMax));
  const auto encoded = text ? std::as_bytes(std::span(*text)) : std::span<const std::byte>();
  const std::string& path = file.payload->path;
  if (file.picture != nullptr)
    *file.picture =
        text ? LookAtPicture(encoded, path, file.targets) : UnreadablePicture(path, text.error(), file.targets);
  else if (file.cloud != nullptr && text)
    *file.cloud = LookAtCloud(encoded, path, file.sensor->layout);
  else if (file.cloud != nullptr)
    *file.cloud = {path, Sentence(text.error()), "", 0};
  else if (text)
    LookAtPoses(*text, file);
}

}  // namespace

PictureSeen LookAtPicture(std::span<const std::byte> encoded, const std::string& path,
                          const std::vector<const Target*>& targets) {
  const auto image = detect::DecodeGrey(encoded);
  if (!image) return UnreadablePicture(path, image.error(), targets);
  PictureSeen picture{path, "", image->width_px, image->height_px, {}};
  for (const Target* target : targets) {
    TargetSeen& seen = picture.seen[target->id];
    seen.view = detect::FindIn(*image, *target);
    if (seen.view.found) seen.edge_px = EdgeWidth_px(*image, seen.view, *target);
  }
  return picture;
}

CloudSeen LookAtCloud(std::span<const std::byte> bytes, const std::string& path,
                      const std::optional<CloudLayout>& layout) {
  const auto cloud = formats::ReadCloud(bytes, formats::SuffixOf(path), path, layout);
  if (!cloud) return {path, Sentence(cloud.error()), "", 0};
  return {path, "", formats::OdditiesOf(*cloud), cloud->points_m.size()};
}

Result<SessionSeen> Look(const fs::path& folder, const LookProgress& progress) {
  RIGCAL_ASSIGN(auto survey, formats::SurveySessionFolder(folder, progress.bytes));
  SessionSeen session;
  session.manifest = std::move(survey.manifest);
  session.refusals = std::move(survey.refusals);
  std::vector<FileToLookAt> files;
  for (const Payload& payload : session.manifest.payloads) files.push_back(FileOf(payload, session));
  std::mutex mutex;
  std::int64_t looked_at = 0;
  ParallelFor(files.size(), [&](std::size_t i) {
    RunApart([&] { LookAtFile(folder, files[i]); });
    const std::lock_guard lock(mutex);
    ++looked_at;
    if (progress.files) progress.files(looked_at, static_cast<std::int64_t>(files.size()));
  });
  return session;
}

}  // namespace rigcal::check
