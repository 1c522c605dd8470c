#include <map>
#include <set>
#include <span>

#include "server/base/limits.h"
#include "server/base/process/parallel_for.h"
#include "server/detect/clouds/overlaid_clouds.h"
#include "server/formats/clouds/cloud.h"
#include "server/formats/clouds/cloud_oddities.h"
#include "server/formats/sessions/payload_path.h"
#include "server/pipeline/edges/lost_payloads.h"
#include "server/pipeline/edges/pair_inputs.h"
#include "server/pipeline/edges/sightings.h"
#include "storage/files/blobs.h"

namespace rigcal::pipeline {
namespace {

using calib::LidarLidarCapture;

constexpr std::size_t kOverlaysMax = 3;

struct CloudFile {
  const Payload* payload = nullptr;
  LidarLidarCapture* capture = nullptr;
  std::vector<Eigen::Vector3f> LidarLidarCapture::*points_m = nullptr;
  std::optional<CloudLayout> layout;
  std::string why_not, note;
};

// A cloud that cannot be decoded costs its capture, not the pair.
Status Read(const storage::Blobs& blobs, CloudFile& file) {
  RIGCAL_ASSIGN(const std::string bytes, LoadPayload(blobs, *file.payload));
  auto cloud = formats::ReadCloud(std::as_bytes(std::span(bytes)), formats::SuffixOf(file.payload->path),
                                  file.payload->path, file.layout);
  if (cloud) file.note = formats::OdditiesOf(*cloud);
  if (cloud)
    file.capture->*file.points_m = std::move(cloud->points_m);
  else
    file.why_not = Sentence(cloud.error());
  return {};
}

std::vector<CloudFile> FilesOf(const Manifest& manifest, const SensorPair& ids,
                               std::map<CaptureId, LidarLidarCapture>& captures) {
  std::vector<CloudFile> files;
  for (const Payload& payload : manifest.payloads) {
    if (payload.sensor != ids.a && payload.sensor != ids.b) continue;
    const bool is_a = payload.sensor == ids.a;
    LidarLidarCapture& capture = captures[payload.capture];
    capture.capture = payload.capture;
    files.push_back({&payload,
                     &capture,
                     is_a ? &LidarLidarCapture::a_m : &LidarLidarCapture::b_m,
                     LayoutOf(manifest.header, payload.sensor),
                     {},
                     {}});
  }
  return files;
}

// So many captures that both lidars have, evenly spread, are enough; the others' clouds are not even read.
void Thin(std::map<CaptureId, LidarLidarCapture>& captures, std::vector<CloudFile>& files) {
  std::map<CaptureId, int> clouds;
  for (const CloudFile& file : files) ++clouds[file.payload->capture];
  std::vector<LidarLidarCapture*> both;
  for (auto& [id, capture] : captures)
    if (clouds[id] == 2) both.push_back(&capture);
  if (both.size() <= limits::kLidarPairCapturesMax) return;
  std::set<const LidarLidarCapture*> kept;
  for (std::size_t i = 0; i < limits::kLidarPairCapturesMax; ++i)
    kept.insert(both[i * both.size() / limits::kLidarPairCapturesMax]);
  for (LidarLidarCapture* capture : both)
    if (!kept.contains(capture))
      capture->why_not = "not needed: " + std::to_string(limits::kLidarPairCapturesMax) + " captures are used";
  std::erase_if(files, [](const CloudFile& file) { return !file.capture->why_not.empty(); });
}

std::vector<CloudFile> UsedFiles(const Manifest& manifest, const SensorPair& ids,
                                 std::map<CaptureId, LidarLidarCapture>& captures) {
  std::vector<CloudFile> files = FilesOf(manifest, ids, captures);
  Thin(captures, files);
  return files;
}

std::vector<Diagnosis> NotesOf(const std::vector<CloudFile>& files) {
  OddClouds odd;
  for (const CloudFile& file : files) odd.Add(file.payload->sensor, file.payload->capture, file.note);
  return odd.Notes();
}

}  // namespace

Needed ToRegister(const storage::Store& store, const Manifest& manifest, const SensorPair& ids) {
  std::map<CaptureId, LidarLidarCapture> captures;
  std::vector<const Payload*> clouds;
  for (const CloudFile& file : UsedFiles(manifest, ids, captures)) clouds.push_back(file.payload);
  return ToRegister(store.blobs(), clouds);
}

Result<PairInputs<calib::LidarLidarProblem>> LoadLidarLidar(storage::Store& store, const Manifest& manifest,
                                                            const SensorPair& ids) {
  RIGCAL_ASSIGN(const SensorsOfPair sensors, FindSensors(manifest.header, ids));
  std::map<CaptureId, LidarLidarCapture> captures;
  std::vector<CloudFile> files = UsedFiles(manifest, ids, captures);
  const storage::Blobs& blobs = store.blobs();
  std::vector<Status> read(files.size());
  ParallelFor(files.size(), [&](std::size_t i) { read[i] = Read(blobs, files[i]); });
  for (const Status& one : read) RIGCAL_TRY(one);
  for (const CloudFile& file : files)
    if (file.capture->why_not.empty()) file.capture->why_not = file.why_not;
  PairInputs<calib::LidarLidarProblem> inputs;
  inputs.notes = NotesOf(files);
  inputs.problem.lidar_a = *sensors.a;
  inputs.problem.lidar_b = *sensors.b;
  inputs.problem.T_a_b_nominal = NominalPose(manifest.header, *sensors.a, *sensors.b);
  inputs.problem.polish = manifest.header.lidar_polish == LidarPolish::kGicp;
  for (auto& [id, capture] : captures) inputs.problem.captures.push_back(std::move(capture));
  return inputs;
}

Status AddOverlays(storage::Store& store, const calib::LidarLidarProblem& problem, Edge& edge) {
  if (edge.state != EdgeState::kGood || !problem.T_a_b_nominal) return {};
  for (std::size_t i = 0; i < problem.captures.size() && edge.evidence.size() < kOverlaysMax; ++i) {
    const LidarLidarCapture& capture = problem.captures[i];
    if (i >= edge.captures.size() || !edge.captures[i].used) continue;
    const std::string jpeg = detect::OverlaidClouds(capture.a_m, capture.b_m, *problem.T_a_b_nominal, edge.T_a_b);
    RIGCAL_ASSIGN(const Digest digest, storage::AppendBlob(store.blobs(), jpeg));
    const std::string words = "with " + edge.frame_b.str() + ", from above, nominal pose and found";
    edge.evidence.push_back(
        {EvidenceTitle(edge.frame_a, capture.capture, words), edge.frame_a, capture.capture, digest, "jpg"});
  }
  return {};
}

}  // namespace rigcal::pipeline
