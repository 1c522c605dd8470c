#include "server/pipeline/boards/seen_boards.h"

#include <algorithm>

#include "server/detect/board.h"
#include "server/model/edges/method.h"
#include "storage/sessions/detections.h"
#include "storage/sessions/sessions.h"

namespace rigcal::pipeline {
namespace {

Result<BoardSeen> SeenByCamera(storage::Store& store, const Manifest& manifest, const Sensor& camera,
                               const Target& board) {
  const std::string detector = detect::DetectorKey(board);
  BoardSeen seen = BoardSeen::kNo;
  for (const Payload& payload : manifest.payloads) {
    if (payload.sensor != camera.id) continue;
    RIGCAL_ASSIGN(const auto found, storage::WasFound(store, payload.digest, detector, board.id));
    if (found.value_or(false)) return BoardSeen::kYes;
    if (!found) seen = BoardSeen::kNotKnown;
  }
  return seen;
}

// A lidar and a tracker are calibrated by plates alone: whichever the lidar may see.
bool IsUsedByItsPlate(const SessionHeader& header, const Sensor& lidar) {
  return lidar.kind == SensorKind::kLidar &&
         std::any_of(header.sensors.begin(), header.sensors.end(), [&](const Sensor& other) {
           return other.id != lidar.id && MethodFor(header, lidar, other) == Method::kTrackerLidar;
         });
}

// What tells most of all sensors.
Status TakeSensor(storage::Store& store, const Manifest& manifest, const Sensor& sensor,
                  std::map<TargetId, BoardSeen>& seen) {
  for (const Target* board : CommonTargets(manifest.header, sensor, sensor)) {
    BoardSeen& known = seen.at(board->id);
    if (known == BoardSeen::kYes) continue;
    BoardSeen now = IsUsedByItsPlate(manifest.header, sensor) ? BoardSeen::kNotKnown : BoardSeen::kNo;
    if (sensor.kind == SensorKind::kCamera) {
      RIGCAL_ASSIGN(now, SeenByCamera(store, manifest, sensor, *board));
    }
    known = std::min(known, now);
  }
  return {};
}

}  // namespace

Result<std::map<TargetId, BoardSeen>> LoadBoardsSeen(storage::Store& store, const Manifest& manifest) {
  std::map<TargetId, BoardSeen> seen;
  for (const Target& board : manifest.header.targets) seen.emplace(board.id, BoardSeen::kNo);
  for (const Sensor& sensor : manifest.header.sensors) RIGCAL_TRY(TakeSensor(store, manifest, sensor, seen));
  return seen;
}

void LeaveOutUnseen(const std::map<TargetId, BoardSeen>& seen, std::vector<BoardRemark>& remarks) {
  std::erase_if(remarks, [&](const BoardRemark& remark) {
    const auto board = seen.find(remark.target);
    return remark.code != "other_pattern" && board != seen.end() && board->second == BoardSeen::kNo;
  });
}

Status LeaveOutUnseen(storage::Store& store, std::vector<BoardRemark>& remarks) {
  std::vector<BoardRemark> kept;
  for (auto from = remarks.begin(); from != remarks.end();) {
    const SessionId session = from->session;
    const auto to =
        std::find_if(from, remarks.end(), [&](const BoardRemark& remark) { return remark.session != session; });
    std::vector<BoardRemark> of_session(from, to);
    RIGCAL_ASSIGN(const auto manifest, storage::LoadManifest(store, session));
    if (manifest) {
      RIGCAL_ASSIGN(const auto seen, LoadBoardsSeen(store, *manifest));
      LeaveOutUnseen(seen, of_session);
    }
    kept.insert(kept.end(), of_session.begin(), of_session.end());
    from = to;
  }
  remarks = std::move(kept);
  return {};
}

}  // namespace rigcal::pipeline
