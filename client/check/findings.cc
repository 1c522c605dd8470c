#include "client/check/findings.h"

#include <algorithm>

#include "client/check/capture_names.h"
#include "server/base/process/parallel_for.h"
#include "server/calib/motion/stream_motion.h"
#include "server/model/edges/captures_wanted.h"
#include "server/model/edges/pair_loops.h"
#include "server/model/edges/unit_doubt.h"

namespace rigcal::check {
namespace {

void AddPictures(const SessionSeen& session, const CameraFound& camera, SensorFiles& files) {
  const auto pictures = session.pictures.find(files.sensor);
  files.usable = camera.with_board.size();
  if (pictures == session.pictures.end()) return;
  for (const auto& [capture, picture] : pictures->second) {
    files.present.push_back(capture);
    if (!picture.why_not.empty()) files.unreadable.push_back({picture.path, picture.why_not});
  }
}

LidarFound FindLidar(const SensorId& lidar, const std::map<CaptureId, CloudSeen>& clouds, SensorFiles& files) {
  LidarFound found;
  found.lidar = lidar;
  for (const auto& [capture, cloud] : clouds) {
    files.present.push_back(capture);
    if (!cloud.why_not.empty()) {
      files.unreadable.push_back({cloud.path, cloud.why_not});
      continue;
    }
    found.points_least = found.clouds == 0 ? cloud.points : std::min(found.points_least, cloud.points);
    found.points_most = std::max(found.points_most, cloud.points);
    ++found.clouds;
    if (!cloud.note.empty()) found.odd.push_back({cloud.path, cloud.note});
  }
  files.usable = found.clouds;
  return found;
}

StreamFound FindStream(const SensorId& stream, const PoseTable& poses) {
  constexpr double kSecondsPerNs = 1e-9;
  StreamFound found;
  found.stream = stream;
  found.rows = poses.size();
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double step_s = kSecondsPerNs * static_cast<double>(poses[i].stamp.ns - poses[i - 1].stamp.ns);
    found.seconds += step_s;
    if (step_s > calib::kStreamGapMax_s) ++found.gaps;
    found.longest_gap_s = std::max(found.longest_gap_s, step_s);
  }
  return found;
}

void AddSensor(const SessionSeen& session, const Sensor& sensor, Findings& findings) {
  SensorFiles files;
  files.sensor = sensor.id;
  files.kind = sensor.kind;
  files.files =
      static_cast<std::size_t>(std::count_if(session.manifest.payloads.begin(), session.manifest.payloads.end(),
                                             [&](const Payload& payload) { return payload.sensor == sensor.id; }));
  const auto clouds = session.clouds.find(sensor.id);
  const auto poses = session.poses.find(sensor.id);
  if (sensor.kind == SensorKind::kCamera) {
    AddPictures(session, findings.cameras.at(sensor.id), files);
  } else if (sensor.kind == SensorKind::kLidar) {
    findings.lidars.push_back(clouds == session.clouds.end() ? LidarFound{sensor.id, 0, 0, 0, {}}
                                                             : FindLidar(sensor.id, clouds->second, files));
  } else if (poses != session.poses.end()) {
    files.usable = poses->second.size();
    if (sensor.kind == SensorKind::kPoseStream) findings.streams.push_back(FindStream(sensor.id, poses->second));
    if (sensor.kind == SensorKind::kTracker)
      for (const TimedPose& pose : poses->second) files.present.push_back(pose.capture);
  }
  files.present = InOrder(std::move(files.present));
  findings.sensors.push_back(std::move(files));
}

std::map<SensorId, CameraFound> FindCameras(const SessionSeen& session, calib::CameraMemory& lenses) {
  static const std::map<CaptureId, PictureSeen> kNone;
  const SessionHeader& header = session.manifest.header;
  std::vector<const Sensor*> cameras;
  for (const Sensor& sensor : header.sensors)
    if (sensor.kind == SensorKind::kCamera) cameras.push_back(&sensor);
  std::vector<CameraFound> found(cameras.size());
  ParallelFor(cameras.size(), [&](std::size_t i) {
    const auto pictures = session.pictures.find(cameras[i]->id);
    found[i] = FindCamera(*cameras[i], CommonTargets(header, *cameras[i], *cameras[i]),
                          pictures == session.pictures.end() ? kNone : pictures->second, lenses);
  });
  std::map<SensorId, CameraFound> by_name;
  for (CameraFound& camera : found) by_name[camera.camera] = std::move(camera);
  return by_name;
}

// Tables of poses are alike only if they are copies; they count, too.
std::vector<std::vector<std::string>> SameFiles(const Manifest& manifest) {
  std::map<Digest, std::vector<std::string>> paths;
  for (const Payload& payload : manifest.payloads) paths[payload.digest].push_back(payload.path);
  std::vector<std::vector<std::string>> same;
  for (auto& [digest, of_one] : paths)
    if (of_one.size() > 1) same.push_back(std::move(of_one));
  std::sort(same.begin(), same.end());
  return same;
}

// Pairs of a loop check each other, if each has captures enough to be tested.
void WantTests(std::vector<PairFound>& pairs) {
  const auto to_test = static_cast<std::size_t>(CapturesToTest(pairs.size()));
  std::map<SensorId, std::size_t> number;
  std::vector<PairOfSession> of_session;
  for (const PairFound& pair : pairs) {
    const std::size_t a = number.emplace(pair.pair.a, number.size()).first->second;
    const std::size_t b = number.emplace(pair.pair.b, number.size()).first->second;
    of_session.push_back({a, b, pair.IsWhole()});
  }
  const std::vector<bool> in_loop = AreInLoops(of_session);
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].is_checked = in_loop[i];
  for (PairFound& pair : pairs)
    if (pair.is_checked && pair.needed.enough > 0) pair.needed.enough = std::max(pair.needed.enough, to_test);
}

}  // namespace

Findings FindAll(const SessionSeen& session, const PairProgress& progress) {
  const SessionHeader& header = session.manifest.header;
  calib::CameraMemory lenses;
  Findings findings;
  findings.robot = header.robot;
  findings.captured_at = header.captured_at;
  findings.captures = InOrder(RecordedCaptures(session.manifest));
  findings.refusals = session.refusals;
  findings.cameras = FindCameras(session, lenses);
  for (const Sensor& sensor : header.sensors) AddSensor(session, sensor, findings);
  findings.pairs = FindPairs(session, findings.cameras, lenses, progress);
  WantTests(findings.pairs);
  findings.same_files = SameFiles(session.manifest);
  findings.unit_doubts = UnitDoubts(header, session.poses);
  return findings;
}

const SensorFiles* FilesOf(const Findings& findings, const SensorId& sensor) {
  const auto files = std::find_if(findings.sensors.begin(), findings.sensors.end(),
                                  [&](const SensorFiles& one) { return one.sensor == sensor; });
  return files == findings.sensors.end() ? nullptr : &*files;
}

bool IsInPair(const Findings& findings, const SensorId& sensor) {
  return std::any_of(findings.pairs.begin(), findings.pairs.end(),
                     [&](const PairFound& pair) { return pair.pair.a == sensor || pair.pair.b == sensor; });
}

std::size_t CapturesMore(const Findings& findings, std::size_t held) {
  const auto asked = static_cast<std::size_t>(CapturesToAskFor(findings.pairs.size()));
  return asked > held ? asked - held : 1;
}

CapturesNeeded NeededOf(const Findings& findings, const SensorId& sensor) {
  CapturesNeeded needed;
  for (const PairFound& pair : findings.pairs) {
    if (pair.pair.a != sensor && pair.pair.b != sensor) continue;
    needed.least = std::max(needed.least, pair.needed.least);
    needed.enough = std::max(needed.enough, pair.needed.enough);
  }
  return needed;
}

}  // namespace rigcal::check
