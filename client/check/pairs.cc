#include "client/check/pairs.h"

#include <algorithm>
#include <mutex>
#include <set>

#include "server/base/process/parallel_for.h"
#include "server/calib/core/pair_edge.h"
#include "server/calib/core/selection.h"
#include "server/calib/eye_to_hand/eye_to_hand.h"
#include "server/calib/lidar_camera/lidar_camera_diagnoses.h"
#include "server/calib/lidar_camera/lidar_camera_work.h"
#include "server/calib/lidar_lidar/lidar_lidar_work.h"
#include "server/calib/motion/hand_eye.h"
#include "server/calib/stereo/stereo.h"

namespace rigcal::check {
namespace {

// What a pair is found from.
struct PairSources {
  const SessionSeen& session;
  const std::map<SensorId, CameraFound>& cameras;
  calib::CameraMemory& lenses;
  std::vector<CaptureId> captures;  // of the session

  [[nodiscard]] const SessionHeader& Header() const { return session.manifest.header; }
};

template <typename Seen>
const std::map<CaptureId, Seen>& OfSensor(const std::map<SensorId, std::map<CaptureId, Seen>>& all,
                                          const SensorId& id) {
  static const std::map<CaptureId, Seen> kNone;
  const auto files = all.find(id);
  return files == all.end() ? kNone : files->second;
}

calib::StereoProblem StereoOf(const PairSources& from, const Sensor& a, const Sensor& b, const Target& target) {
  std::map<CaptureId, calib::StereoCapture> captures;
  for (auto& [capture, view] : ViewsOf(OfSensor(from.session.pictures, a.id), target.id))
    captures[capture].a = std::move(view);
  for (auto& [capture, view] : ViewsOf(OfSensor(from.session.pictures, b.id), target.id))
    captures[capture].b = std::move(view);
  calib::StereoProblem problem{a, b, target, {}, from.captures};
  for (auto& [id, capture] : captures) {
    capture.capture = id;
    problem.captures.push_back(std::move(capture));
  }
  return problem;
}

// As a figure of a good edge tells it, for captures that repeat another do not count; else `counted`.
std::size_t DifferentCaptures(const Edge& edge, const std::string& figure, std::size_t counted) {
  const auto told = edge.figures.find(figure);
  if (edge.state != EdgeState::kGood || told == edge.figures.end()) return counted;
  return static_cast<std::size_t>(told->second);
}

// Of the targets that both may see, the one that both see in most captures, the first of equals.
void EstimateStereo(const PairSources& from, const Sensor& a, const Sensor& b, PairFound& found) {
  std::optional<calib::StereoProblem> best;
  for (const Target* target : CommonTargets(from.Header(), a, b)) {
    calib::StereoProblem problem = StereoOf(from, a, b, *target);
    const std::size_t both = calib::SeenByBoth(problem).size();
    if (best && both <= found.both) continue;
    found.both = both;
    best = std::move(problem);
  }
  if (!best) return;
  const std::vector<CaptureId> same = SamePictures(from.session.manifest, found.pair);
  calib::DropCaptures(*best, {same.begin(), same.end()});
  found.edge = calib::EstimateEdge(*best);
  calib::TellSamePictures(same, *found.edge);
  found.both = DifferentCaptures(*found.edge, "captures_both", calib::SeenByBoth(*best).size());
}

calib::HandEyeSide SideOf(const PairSources& from, const Sensor& sensor) {
  calib::HandEyeSide side;
  side.sensor = sensor;
  if (sensor.kind == SensorKind::kCamera) {
    const auto& pictures = OfSensor(from.session.pictures, sensor.id);
    const Target* target = BestTarget(CommonTargets(from.Header(), sensor, sensor), pictures);
    if (target == nullptr) return side;
    side.board = *target;
    side.views = ViewsOf(pictures, target->id);
  } else if (const auto poses = from.session.poses.find(sensor.id); poses != from.session.poses.end()) {
    side.poses = poses->second;
  }
  return side;
}

std::set<CaptureId> PlacedBy(const calib::HandEyeSide& side) {
  std::set<CaptureId> captures;
  for (const auto& [capture, view] : side.views)
    if (view.found) captures.insert(capture);
  for (const TimedPose& pose : side.poses)
    if (!pose.capture.empty()) captures.insert(pose.capture);
  return captures;
}

std::size_t CountCommon(const std::set<CaptureId>& of_a, const std::set<CaptureId>& of_b) {
  return static_cast<std::size_t>(
      std::count_if(of_a.begin(), of_a.end(), [&](const CaptureId& capture) { return of_b.contains(capture); }));
}

// Before it is estimated: the estimator takes for granted that there is something on either side.
std::optional<Diagnosis> WhyNothingToGoBy(const calib::HandEyeSide& side) {
  const std::string id = side.sensor.id.str();
  if (side.sensor.kind == SensorKind::kCamera ? side.board.has_value() : !side.poses.empty()) return std::nullopt;
  if (side.sensor.kind == SensorKind::kCamera)
    return Diagnosis{"not_found", id + " may see no target", "List the board under targets in session.yaml."};
  return Diagnosis{"not_found", id + " has no poses", "Put its poses into " + id + "/poses.csv."};
}

Edge MotionEdgeOf(const calib::HandEyeProblem& problem) {
  if (problem.method == Method::kEyeToHand) return calib::EstimateEyeToHandEdge(problem);
  if (problem.method == Method::kTrackerCamera) return calib::EstimateTrackerCameraEdge(problem);
  return calib::EstimateHandEyeEdge(problem);
}

void EstimateHandEye(const PairSources& from, const Sensor& a, const Sensor& b, PairFound& found) {
  calib::HandEyeProblem problem;
  problem.method = found.method;
  problem.a = SideOf(from, a);
  problem.b = SideOf(from, b);
  for (const calib::HandEyeSide* side : {&problem.a, &problem.b})
    if (!found.problem) found.problem = WhyNothingToGoBy(*side);
  if (found.problem) return;
  problem.T_a_b_nominal = NominalPose(from.Header(), a, b);
  problem.solve_camera = [&](const calib::CameraProblem& camera) { return from.lenses.Estimate(camera); };
  problem.session_captures = from.captures;
  const std::size_t counted = CountCommon(PlacedBy(problem.a), PlacedBy(problem.b));
  found.edge = MotionEdgeOf(problem);
  if (found.method != Method::kPoseStreams) found.both = DifferentCaptures(*found.edge, "captures_used", counted);
}

// Of a sensor whose pair is only counted: captures in which it has something to go by.
std::set<CaptureId> UsableOf(const PairSources& from, const Sensor& sensor) {
  std::set<CaptureId> captures;
  if (sensor.kind == SensorKind::kCamera) {
    const auto camera = from.cameras.find(sensor.id);
    if (camera != from.cameras.end())
      captures.insert(camera->second.with_board.begin(), camera->second.with_board.end());
  } else if (sensor.kind == SensorKind::kLidar) {
    for (const auto& [capture, cloud] : OfSensor(from.session.clouds, sensor.id))
      if (cloud.why_not.empty()) captures.insert(capture);
  } else if (const auto poses = from.session.poses.find(sensor.id); poses != from.session.poses.end()) {
    for (const TimedPose& pose : poses->second) captures.insert(pose.capture);
  }
  return captures;
}

// The normals have to point three ways, or at least two: that the pictures tell without the clouds.
std::optional<Diagnosis> WhyNotWithLidar(const PairSources& from, const Sensor& camera, const Sensor& lidar) {
  const CameraFound& seen = from.cameras.at(camera.id);
  if (seen.lens_problem) return seen.lens_problem;
  const std::set<CaptureId> with_cloud = UsableOf(from, lidar);
  std::vector<calib::PlaneCapture> planes;
  for (const auto& [capture, T_cam_board] : seen.T_cam_board)
    if (with_cloud.contains(capture)) planes.push_back({T_cam_board, {}, {}});
  if (!seen.board || planes.size() < calib::kLidarCapturesMin) return std::nullopt;  // the count says it
  const calib::NormalSpread spread = calib::SpreadOf(planes);
  if (spread.sigma_m <= calib::kNormalSigmaMax_m || spread.next_sigma_m <= calib::kNormalSigmaGood_m)
    return std::nullopt;
  calib::LidarCameraProblem problem;
  problem.camera = camera;
  problem.lidar = lidar;
  problem.board = *seen.board;
  return calib::NoNormalSpread(problem, spread.cone_deg, spread.sigma_m);
}

void CountPair(const PairSources& from, const Sensor& a, const Sensor& b, PairFound& found) {
  found.both = CountCommon(UsableOf(from, a), UsableOf(from, b));
  if (found.method == Method::kLidarCamera) {
    const bool camera_is_a = a.kind == SensorKind::kCamera;
    found.problem = WhyNotWithLidar(from, camera_is_a ? a : b, camera_is_a ? b : a);
  }
  if (found.method == Method::kLidarLidar && !NominalPose(from.Header(), a, b)) {
    calib::LidarLidarProblem problem;
    problem.lidar_a = a;
    problem.lidar_b = b;
    found.problem = calib::NoNominalPose(problem);
  }
}

PairFound FindPair(const PairSources& from, const SensorPair& pair) {
  const Sensor &a = *SensorOf(from.Header(), pair.a), &b = *SensorOf(from.Header(), pair.b);
  PairFound found{pair, *MethodFor(from.Header(), a, b), {}, 0, {}, {}};
  found.needed = RowOf(found.method).captures;
  switch (found.method) {
    case Method::kStereo:
      EstimateStereo(from, a, b, found);
      break;
    case Method::kNonOverlapping:
    case Method::kTrackerCamera:
    case Method::kPoseStreams:
    case Method::kEyeToHand:
      EstimateHandEye(from, a, b, found);
      break;
    case Method::kLidarCamera:
    case Method::kLidarLidar:
    case Method::kTrackerLidar:
      CountPair(from, a, b, found);
      break;
  }
  return found;
}

}  // namespace

bool PairFound::IsWhole() const {
  if (edge) return edge->state == EdgeState::kGood && edge->uncertainty.rank == 6;
  return !problem && both >= std::max<std::size_t>(1, needed.least);
}

std::vector<PairFound> FindPairs(const SessionSeen& session, const std::map<SensorId, CameraFound>& cameras,
                                 calib::CameraMemory& lenses, const PairProgress& progress) {
  const PairSources from{session, cameras, lenses, RecordedCaptures(session.manifest)};
  const std::vector<SensorPair> pairs = PairsToCalibrate(session.manifest.header);
  std::vector<PairFound> found(pairs.size());
  std::mutex mutex;
  std::int64_t done = 0;
  ParallelFor(pairs.size(), [&](std::size_t i) {
    RunApart([&] { found[i] = FindPair(from, pairs[i]); });
    const std::lock_guard lock(mutex);
    ++done;
    if (progress) progress(done, static_cast<std::int64_t>(pairs.size()));
  });
  return found;
}

}  // namespace rigcal::check
