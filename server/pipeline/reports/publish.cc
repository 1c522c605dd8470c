#include "server/pipeline/reports/publish.h"

#include <fstream>
#include <map>
#include <set>

#include "server/base/digests/secret.h"
#include "server/base/files/durable_file.h"
#include "server/base/process/parallel_for.h"
#include "server/formats/edges/camera_fit.h"
#include "server/pipeline/reports/clouds.h"
#include "server/pipeline/reports/report_input.h"
#include "server/report/frame/assets.h"
#include "server/report/render.h"
#include "storage/files/blobs.h"
#include "storage/work/attempts.h"
#include "storage/work/jobs.h"

namespace rigcal::pipeline {
namespace {

namespace fs = std::filesystem;

Error DiskError(const fs::path& path, const std::error_code& error) {
  return {ErrorCode::kStorage, "the report folder " + path.string() + " cannot be written: " + error.message(),
          "Check free space and permissions of the data folder."};
}

Status LinkFile(const fs::path& from, const fs::path& file) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (!error) fs::create_hard_link(from, file, error);
  if (error) fs::copy_file(from, file, fs::copy_options::overwrite_existing, error);
  return error ? Status(Fail(DiskError(file, error))) : Status();
}

// Those of earlier visits are on the reports of these.
std::vector<Edge> EdgesWithPictures(const report::ReportInput& input) {
  std::vector<Edge> shown = input.revision.edges;
  std::erase_if(shown, [&](const Edge& edge) { return input.detailed_in.contains(edge.id); });
  return shown;
}

// Pictures are hard links to their blobs: no copy, and a blob never changes.
Status LinkEvidence(const storage::Store& store, const std::vector<Edge>& edges, const fs::path& folder,
                    std::vector<Digest>& present) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return Fail(DiskError(folder, error));
  std::set<Digest> done;
  for (const Edge& edge : edges)
    for (const Evidence& item : edge.evidence) {
      if (item.suffix == formats::kCameraFitSuffix) continue;
      if (!done.insert(item.digest).second) continue;
      const Result<bool> is_there = storage::FetchBlob(store.blobs(), item.digest);
      if (!is_there && is_there.error().code != ErrorCode::kConflict) return Fail(is_there.error());
      if (!is_there || !*is_there) continue;  // damaged or gone: it is made again
      RIGCAL_TRY(LinkFile(storage::BlobPath(store.BlobFolder(), item.digest),
                          folder / (item.digest.str() + "." + item.suffix)));
      present.push_back(item.digest);
    }
  return {};
}

// Evidence that the disk has not kept is made again, and the report with it. What could not be made again the last time
// is not tried for ever.
Status RemakeLostEvidence(storage::Store& store, const std::vector<Edge>& edges, bool is_published) {
  std::vector<std::pair<EdgeId, Digest>> wanted;
  for (const Edge& edge : edges)
    for (const Evidence& item : edge.evidence) wanted.emplace_back(edge.id, item.digest);
  std::vector<Result<storage::BlobState>> states(wanted.size(), storage::BlobState::kGood);
  ParallelFor(wanted.size(),
              [&](std::size_t i) { states[i] = storage::SetDamagedAside(store.blobs(), wanted[i].second); });
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    RIGCAL_ASSIGN(const storage::BlobState state, states[i]);
    if (state == storage::BlobState::kDamaged || (state == storage::BlobState::kMissing && !is_published))
      RIGCAL_TRY(storage::QueueAgain(store, wanted[i].first));
  }
  return {};
}

// Of the edges that speak for a camera; the others' would only make the report heavy.
Status LinkFits(const storage::Store& store, const std::vector<report::CameraReport>& cameras, const fs::path& folder) {
  for (const report::CameraReport& camera : cameras)
    RIGCAL_TRY(
        LinkFile(storage::BlobPath(store.BlobFolder(), camera.document), folder / (camera.document.str() + ".json")));
  return {};
}

// The scripts exist once below the report folder; each report holds links to them, so that it also opens from disk.
Status LinkAssets(const fs::path& report_folder, const fs::path& folder) {
  for (const report::Asset& asset : report::Assets()) {
    const fs::path kept = report_folder / ".assets" / asset.name;
    std::error_code error;
    if (fs::file_size(kept, error) != asset.bytes.size() || error) {
      fs::create_directories(kept.parent_path(), error);
      if (error) return Fail(DiskError(kept, error));
      RIGCAL_TRY(WriteDurably(kept, asset.bytes));
    }
    RIGCAL_TRY(LinkFile(kept, folder / asset.name));
  }
  return {};
}

Status WriteFiles(const std::map<std::string, std::string>& files, const fs::path& folder) {
  for (const auto& [name, contents] : files) {
    std::error_code error;
    fs::create_directories((folder / name).parent_path(), error);
    if (error) return Fail(DiskError(folder / name, error));
    RIGCAL_TRY(WriteDurably(folder / name, contents));
  }
  return {};
}

// Where a report is made: what a process left that was cut off, or that stood still while another took its place, is
// removed.
fs::path NewFolder(const fs::path& robot_folder, int number) {
  const std::string begins = ".new-" + std::to_string(number) + "-";
  std::error_code error;
  for (fs::directory_iterator entry(robot_folder, error), end; !error && entry != end; entry.increment(error))
    if (std::error_code ignored; entry->path().filename().string().starts_with(begins))
      fs::remove_all(entry->path(), ignored);
  return robot_folder / (begins + NewSecret().substr(0, 8));
}

// Files are synced as they are written, with their names; not so the names of links and of folders.
Status SyncFoldersOf(const fs::path& above) {
  std::vector<fs::path> folders{above};
  std::error_code error;
  for (fs::recursive_directory_iterator at(above, error), end; !error && at != end; at.increment(error))
    if (at->is_directory(error)) folders.push_back(at->path());
  if (error) return Fail(DiskError(above, error));
  for (const fs::path& folder : folders) RIGCAL_TRY(SyncFolder(folder));
  return {};
}

Status MoveInPlace(const fs::path& temporary, const fs::path& folder) {
  std::error_code error;
  fs::remove_all(folder, error);
  fs::rename(temporary, folder, error);
  if (error) return Fail(DiskError(folder, error));
  return SyncFolder(folder.parent_path());
}

}  // namespace

Result<fs::path> Publish(storage::Store& store, const storage::RevisionKey& key, const Clock& clock,
                         const std::string& why_no_clouds) {
  RIGCAL_ASSIGN(const auto revision, storage::LoadRevision(store, key.robot, key.number));
  if (!revision)
    return Fail(ErrorCode::kNotFound, "robot " + key.robot.str() + " has no revision " + std::to_string(key.number),
                "See its revisions with: rigcal show " + key.robot.str());
  RIGCAL_ASSIGN(report::ReportInput input, LoadReportInput(store, *revision));
  RIGCAL_ASSIGN(const bool is_published, storage::IsPublished(store, key));
  const std::vector<Edge> shown = EdgesWithPictures(input);
  RIGCAL_TRY(RemakeLostEvidence(store, shown, is_published));
  const fs::path robot_folder = store.ReportFolder() / key.robot.str();
  const fs::path folder = robot_folder / std::to_string(key.number);
  if (const Status made = MakeFolderDurably(robot_folder); !made)
    return Fail(ErrorCode::kStorage,
                "the report folder " + robot_folder.string() + " cannot be written: " + made.error().what,
                made.error().cure);
  const fs::path temporary = NewFolder(robot_folder, key.number);
  RIGCAL_TRY(LinkEvidence(store, shown, temporary / "evidence", input.evidence));
  RIGCAL_TRY(LinkFits(store, input.cameras, temporary / "cameras"));
  if (why_no_clouds.empty()) {
    RIGCAL_ASSIGN(input.clouds, WriteClouds(store, input.revision, temporary, clock.Now()));
  } else {
    input.clouds.notes = {why_no_clouds};
  }
  RIGCAL_TRY(LinkAssets(store.ReportFolder(), temporary / "assets"));
  RIGCAL_ASSIGN(const auto files, report::RenderRevision(input, revision->document));
  RIGCAL_TRY(WriteFiles(files, temporary));
  RIGCAL_TRY(SyncFoldersOf(temporary));
  // Within the write: a process that lost the robot to another must not put its report in the place of that one's.
  RIGCAL_TRY(store.Write([&]() -> Status {
    RIGCAL_TRY(MoveInPlace(temporary, folder));
    RIGCAL_TRY(storage::EndAttempt(store, storage::WorkOfReport(key), storage::AttemptEnd::kDone, "", clock.Now()));
    return storage::AppendPublication(store, key, clock.Now());
  }));
  return folder;
}

}  // namespace rigcal::pipeline
