#include "server/pipeline/stereo_inputs.h"

#include <algorithm>
#include <map>
#include <span>

#include "server/base/limits.h"
#include "server/base/parallel_for.h"
#include "server/detect/board.h"
#include "storage/blobs.h"
#include "storage/detections.h"

namespace rigcal::pipeline {
namespace {

struct Found {
  const Payload* payload = nullptr;
  storage::StoredView stored;
  bool fresh = false;  // detected now, not yet in the store
  Status status;
};

const Sensor* SensorOf(const SessionHeader& header, const SensorId& id) {
  const auto it =
      std::find_if(header.sensors.begin(), header.sensors.end(), [&](const Sensor& s) { return s.id == id; });
  return it == header.sensors.end() ? nullptr : &*it;
}

bool MaySee(const Sensor& sensor, const Checkerboard& board) { return !sensor.sees || *sensor.sees == board.id; }

Status DetectFresh(const std::filesystem::path& blobs, const Checkerboard& board, Found& found) {
  const auto bytes =
      storage::LoadBlob(blobs, found.payload->digest, static_cast<std::size_t>(limits::kPayloadBytesMax));
  if (!bytes) {  // a damaged disk costs this picture, not the robot: and it is looked for again next time
    found.fresh = false;
    found.stored.view.why_not = Sentence(bytes.error());
    return {};
  }
  AnnotatedView annotated = detect::Detect(std::as_bytes(std::span(*bytes)), board);
  found.stored.view = std::move(annotated.view);
  if (annotated.picture.empty()) return {};
  // Stored at once, so that memory does not grow with the number of captures.
  RIGCAL_ASSIGN(found.stored.picture, storage::AppendBlob(blobs, annotated.picture));
  return {};
}

// Detection is the costly part, so it is read from the cache where it can be, and done in parallel where it cannot.
Result<std::vector<Found>> DetectAll(storage::Store& store, const Manifest& manifest, const SensorPair& pair,
                                     const Checkerboard& board) {
  const std::string key = detect::DetectorKey(board);
  std::vector<Found> all;
  for (const Payload& payload : manifest.payloads) {
    if (payload.sensor != pair.a && payload.sensor != pair.b) continue;
    RIGCAL_ASSIGN(auto cached, storage::LoadView(store, payload.digest, key));
    Found found;
    found.payload = &payload;
    found.fresh = !cached.has_value();
    if (cached) found.stored = std::move(*cached);
    all.push_back(std::move(found));
  }
  const std::filesystem::path blobs = store.BlobFolder();
  ParallelFor(all.size(), [&](std::size_t i) {
    if (all[i].fresh) all[i].status = DetectFresh(blobs, board, all[i]);
  });
  for (Found& found : all) RIGCAL_TRY(found.status);
  return all;
}

Status StoreFresh(storage::Store& store, const Checkerboard& board, const std::vector<Found>& all) {
  const std::string key = detect::DetectorKey(board);
  return store.Write([&]() -> Status {
    for (const Found& found : all)
      if (found.fresh) RIGCAL_TRY(storage::AppendView(store, found.payload->digest, key, found.stored));
    return {};
  });
}

std::string EvidenceTitle(const Found& found) {
  const BoardView& view = found.stored.view;
  const std::string name = found.payload->sensor.str() + " / " + found.payload->capture.str() + ": ";
  return name + (view.found ? std::to_string(view.corners_px.size()) + " corners" : view.why_not);
}

StereoInputs Assemble(const Sensor& a, const Sensor& b, const Checkerboard& board, const std::vector<Found>& all) {
  StereoInputs inputs;
  inputs.problem.camera_a = a;
  inputs.problem.camera_b = b;
  inputs.problem.board = board;
  std::map<CaptureId, calib::StereoCapture> captures;
  std::map<std::pair<CaptureId, bool>, Evidence> evidence;
  for (const Found& found : all) {
    const CaptureId& id = found.payload->capture;
    const bool is_b = found.payload->sensor == b.id;
    captures[id].capture = id;
    (is_b ? captures[id].b : captures[id].a) = found.stored.view;
    if (!found.stored.picture.empty())
      evidence[{id, is_b}] = {EvidenceTitle(found), found.payload->sensor, id, found.stored.picture, "jpg"};
  }
  for (auto& [id, capture] : captures) inputs.problem.captures.push_back(std::move(capture));
  for (auto& [key, item] : evidence) inputs.evidence.push_back(std::move(item));
  return inputs;
}

std::size_t CommonViews(const calib::StereoProblem& problem) {
  return static_cast<std::size_t>(
      std::count_if(problem.captures.begin(), problem.captures.end(),
                    [](const calib::StereoCapture& c) { return c.a && c.b && c.a->found && c.b->found; }));
}

}  // namespace

Result<StereoInputs> LoadStereoInputs(storage::Store& store, const Manifest& manifest, const SensorPair& pair) {
  const Sensor* a = SensorOf(manifest.header, pair.a);
  const Sensor* b = SensorOf(manifest.header, pair.b);
  if (a == nullptr || b == nullptr)
    return Fail(ErrorCode::kInternal, "the session has no sensor '" + (a ? pair.b : pair.a).str() + "'",
                "Push the session again under its own manifest.");
  std::optional<StereoInputs> best;
  for (const Checkerboard& board : manifest.header.targets) {
    if (!MaySee(*a, board) || !MaySee(*b, board)) continue;
    RIGCAL_ASSIGN(std::vector<Found> all, DetectAll(store, manifest, pair, board));
    RIGCAL_TRY(StoreFresh(store, board, all));
    StereoInputs inputs = Assemble(*a, *b, board, all);
    if (!best || CommonViews(inputs.problem) > CommonViews(best->problem)) best = std::move(inputs);
  }
  if (!best)
    return Fail(ErrorCode::kInvalidInput, "no target can be seen by both " + pair.a.str() + " and " + pair.b.str(),
                "Name the target that both look at under 'sees' in session.yaml.");
  return std::move(*best);
}

}  // namespace rigcal::pipeline
