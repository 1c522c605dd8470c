#include "server/pipeline/reports/clouds.h"

#include <array>
#include <map>
#include <span>

#include "server/base/files/durable_file.h"
#include "server/base/limits.h"
#include "server/base/process/out_of_memory.h"
#include "server/base/process/parallel_for.h"
#include "server/cloud/blend.h"
#include "server/cloud/overlay.h"
#include "server/cloud/point_files.h"
#include "server/cloud/render.h"
#include "server/detect/pictures/grey_image.h"
#include "server/formats/clouds/cloud.h"
#include "server/formats/clouds/cloud_oddities.h"
#include "server/formats/sessions/payload_path.h"
#include "server/pipeline/edges/decoding.h"
#include "server/pipeline/edges/lost_payloads.h"
#include "server/pipeline/reports/cloud_choice.h"

namespace rigcal::pipeline {
namespace {

namespace fs = std::filesystem;

struct Work {
  storage::Store& store;
  const fs::path& folder;
  Stamp now;
  report::CloudSection section;
  std::map<SensorId, report::CameraOverlay> overlays;
};

Result<Cloud> CloudOf(storage::Store& store, const Payload& payload, const std::optional<CloudLayout>& layout) {
  RIGCAL_ASSIGN(const std::string bytes, LoadPayload(store.blobs(), payload));
  return formats::ReadCloud(std::as_bytes(std::span(bytes)), formats::SuffixOf(payload.path), payload.path, layout);
}

Result<Picture> PictureOf(storage::Store& store, const Payload& payload) {
  RIGCAL_ASSIGN(const std::string bytes, LoadPayload(store.blobs(), payload));
  return detect::DecodeColour(std::as_bytes(std::span(bytes)));
}

Status WriteBelow(const fs::path& folder, const std::string& name, const std::string& bytes) {
  std::error_code error;
  fs::create_directories((folder / name).parent_path(), error);
  if (error)
    return Fail(ErrorCode::kStorage, "the report folder " + folder.string() + " cannot be written: " + error.message(),
                "Check free space and permissions of the data folder.");
  return WriteDurably(folder / name, bytes);
}

// What the disk has not kept is asked for again, and the report made anew when it is there.
Status Note(Work& work, const Payload& payload, const Error& error) {
  if (error.code == ErrorCode::kUnreachable) return Fail(error);
  std::vector<LostFile> lost;
  if (error.code == ErrorCode::kStorage) {
    RIGCAL_ASSIGN(lost, FindLost(work.store, {&payload}));
  }
  RIGCAL_TRY(AppendLost(work.store, lost, std::nullopt, work.now));
  work.section.notes.push_back(
      payload.path + " is not shown: " +
      (lost.empty() ? Sentence(error) : "the server's disk has not kept it. Push the session again."));
  return {};
}

// Replaces the overlay of the camera if this lidar has more points in its picture.
Status WriteOverlay(Work& work, const CloudChoice& choice, const PlacedCamera& camera, const Picture& picture,
                    const cloud::CameraView& view) {
  const auto [it, fresh] = work.overlays.try_emplace(camera.id);
  report::CameraOverlay& shown = it->second;
  const std::size_t points = view.Count();
  if (!fresh && points <= shown.points) return {};
  const cloud::Overlay overlay = cloud::OverlayOf(picture, view);
  shown = {camera.id.str(),
           choice.lidar.str(),
           choice.cloud->capture.str(),
           "overlay/" + camera.id.str() + ".jpg",
           "overlay/" + camera.id.str() + "_picture.jpg",
           points,
           picture.width_px,
           picture.height_px};
  RIGCAL_TRY(WriteBelow(work.folder, shown.points_jpg, overlay.points_jpg));
  return WriteBelow(work.folder, shown.picture_jpg, overlay.picture_jpg);
}

// A camera whose picture cannot be read sees nothing; the others go on.
Result<std::vector<cloud::CameraView>> SeeAll(Work& work, const CloudChoice& choice, const cloud::Beams& beams,
                                              std::size_t& used) {
  std::vector<cloud::CameraView> views;
  for (const PlacedCamera& camera : choice.cameras) {
    const Result<Picture> picture = PictureOf(work.store, *camera.picture);
    if (!picture) RIGCAL_TRY(Note(work, *camera.picture, picture.error()));
    views.push_back(cloud::See(beams, camera.camera, picture ? *picture : Picture{}));
    if (!picture) continue;
    ++used;
    RIGCAL_TRY(WriteOverlay(work, choice, camera, *picture, views.back()));
  }
  return views;
}

// Where the pictures' tops are on average, unless that is nearly the lidar's own z; ahead is where the cameras look,
// nearly the lidar's own x included.
struct UpAndAhead {
  Eigen::Vector3d up = Eigen::Vector3d::Zero(), forward = Eigen::Vector3d::Zero();
};

UpAndAhead UpAndAheadOf(const CloudChoice& choice) {
  constexpr double kUpright = 0.8;
  UpAndAhead found;
  auto& [up, forward] = found;
  for (const PlacedCamera& camera : choice.cameras) {
    const Eigen::Matrix3d R_lidar_cam = camera.camera.T_cam_lidar.R().transpose();
    up -= R_lidar_cam.col(1), forward += R_lidar_cam.col(2);
  }
  const auto count = static_cast<double>(choice.cameras.size());
  up /= count, forward /= count;
  const double level = up.normalized().z();
  if (up.norm() < 0.2 || std::abs(level) > kUpright) up = (level < 0 ? -1.0 : 1.0) * Eigen::Vector3d::UnitZ();
  return found;
}

Status WriteViews(Work& work, const CloudChoice& choice, const cloud::ColouredCloud& coloured,
                  const report::ColouredLidar& names) {
  constexpr double kSomeAhead = 0.5;  // mean of the cameras' directions: of cameras all around it is near zero
  const UpAndAhead axes = UpAndAheadOf(choice);
  const cloud::Stand stand = cloud::StandOf(axes.up, axes.forward);
  const bool ahead = axes.forward.norm() > kSomeAhead;
  const cloud::Stand facing = ahead ? stand : cloud::FacingMost(stand, coloured.points_m);
  const std::array<cloud::Angle, 3> angles = {cloud::Angle::kFront, cloud::Angle::kTop, cloud::Angle::kOblique};
  std::array<std::string, 3> pictures;
  ParallelFor(angles.size(), [&](std::size_t i) {
    pictures[i] = cloud::RenderPng(coloured, angles[i] == cloud::Angle::kFront ? facing : stand, angles[i]);
  });
  RIGCAL_TRY(WriteBelow(work.folder, names.front_png, pictures[0]));
  RIGCAL_TRY(WriteBelow(work.folder, names.top_png, pictures[1]));
  return WriteBelow(work.folder, names.oblique_png, pictures[2]);
}

report::ColouredLidar NamesOf(const CloudChoice& choice) {
  report::ColouredLidar names;
  names.lidar = choice.lidar.str(), names.capture = choice.cloud->capture.str();
  const std::string folder = "cloud/" + names.lidar + "/";
  names.front_png = folder + "front.png", names.top_png = folder + "top.png",
  names.oblique_png = folder + "oblique.png";
  names.ply = folder + "cloud.ply", names.viewer_points = folder + "points.bin";
  for (const PlacedCamera& camera : choice.cameras) names.camera_names.push_back(camera.id.str());
  if (const Eigen::Vector3d up = UpAndAheadOf(choice).up; up.allFinite() && up.norm() > 0) names.up = up.normalized();
  return names;
}

void NoteLimits(Work& work, const CloudChoice& choice, const cloud::Beams& beams) {
  if (beams.stride > 1)
    work.section.notes.push_back("Of " + choice.cloud->path + " every " + std::to_string(beams.stride) +
                                 "th point is shown: it has more than " + std::to_string(limits::kColouredPointsMax) +
                                 ".");
  if (choice.cameras_left_out > 0)
    work.section.notes.push_back("The first " + std::to_string(limits::kCloudCamerasMax) +
                                 " cameras of the session colour the cloud of " + choice.lidar.str() + "; " +
                                 std::to_string(choice.cameras_left_out) + " more do not.");
}

Result<MemoryBudget::Share> MemoryFor(const Work& work, const CloudChoice& choice) {
  std::vector<const Payload*> pictures;
  for (const PlacedCamera& camera : choice.cameras) pictures.push_back(camera.picture);
  return TakeMemory(ToColour(work.store.blobs(), *choice.cloud, pictures));
}

Status WriteLidar(Work& work, const CloudChoice& choice) {
  const auto share = MemoryFor(work, choice);
  if (!share) return Note(work, *choice.cloud, share.error());
  const Result<Cloud> read = CloudOf(work.store, *choice.cloud, choice.layout);
  if (!read) return Note(work, *choice.cloud, read.error());
  cloud::Beams beams = cloud::BeamsOf(*read);
  if (const std::string odd = formats::OdditiesOf(*read); !odd.empty())
    work.section.notes.push_back(choice.cloud->path + ": " + odd + ".");
  NoteLimits(work, choice, beams);
  report::ColouredLidar shown = NamesOf(choice);
  RIGCAL_ASSIGN(const auto views, SeeAll(work, choice, beams, shown.cameras));
  const cloud::ColouredCloud coloured = cloud::Blend(std::move(beams), views);
  shown.points = coloured.points_m.size(), shown.covered = coloured.covered;
  RIGCAL_TRY(WriteViews(work, choice, coloured, shown));
  RIGCAL_TRY(WriteBelow(work.folder, shown.ply, cloud::WritePly(coloured)));
  RIGCAL_TRY(WriteBelow(work.folder, shown.viewer_points, cloud::WriteViewerPoints(coloured)));
  work.section.lidars.push_back(std::move(shown));
  return {};
}

// Libraries' exceptions cost the cloud, not the report; without memory it is made again.
Status WriteOrNote(Work& work, const CloudChoice& choice) {
  try {
    return WriteLidar(work, choice);
  } catch (const std::exception& problem) {
    if (IsOutOfMemory(problem)) throw;
    work.section.notes.push_back("The cloud of " + choice.lidar.str() + " could not be coloured: " + problem.what());
    return {};
  }
}

}  // namespace

Result<report::CloudSection> WriteClouds(storage::Store& store, const formats::RevisionInput& revision,
                                         const fs::path& folder, Stamp now) {
  RIGCAL_ASSIGN(const CloudChoices choices, ChooseClouds(store, revision));
  Work work{store, folder, now, {}, {}};
  for (const CloudChoice& choice : choices.lidars) RIGCAL_TRY(WriteOrNote(work, choice));
  for (const auto& [camera, overlay] : work.overlays)
    if (!overlay.camera.empty()) work.section.overlays.push_back(overlay);
  return std::move(work.section);
}

}  // namespace rigcal::pipeline
