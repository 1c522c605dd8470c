#include "server/pipeline/sessions/session_refinement.h"

#include <algorithm>
#include <chrono>
#include <set>

#include "server/base/log.h"
#include "server/calib/joint/estimate_session.h"
#include "server/formats/boards/square_sizes.h"
#include "server/graph/solve/solve.h"
#include "server/graph/solve/weak_edges.h"
#include "server/model/edges/method.h"
#include "server/model/edges/past.h"
#include "server/model/graph/connected.h"
#include "server/pipeline/attempt.h"
#include "server/pipeline/edges/pose_inputs.h"
#include "server/pipeline/edges/sightings.h"
#include "server/pipeline/sessions/current_edges.h"
#include "server/pipeline/sessions/pair_moves.h"
#include "storage/edges/edges.h"
#include "storage/sessions/session_estimates.h"
#include "storage/sessions/sessions.h"
#include "storage/work/jobs.h"

namespace rigcal::pipeline {
namespace {

using calib::joint::SessionViews;

// The pairs of the session that gave an edge: what was searched for them is in the store.
struct Pairs {
  const std::vector<Edge>& edges;

  [[nodiscard]] std::set<SensorId> PartnersOf(const SensorId& sensor) const {
    std::set<SensorId> partners;
    for (const Edge& edge : edges) {
      if (edge.frame_a == sensor) partners.insert(edge.frame_b);
      if (edge.frame_b == sensor) partners.insert(edge.frame_a);
    }
    return partners;
  }
  [[nodiscard]] bool HaveBoardsThatStandStill() const {
    return std::any_of(edges.begin(), edges.end(), [](const Edge& edge) {
      const std::optional<Method> method = MethodNamed(edge.method);
      return edge.state == EdgeState::kGood && method && RowOf(*method).board_stands_still;
    });
  }
};

// The tracker that carries the boards of the rig that is refined. As its boards see it, the rig moves like a robot
// before boards that stand still: its poses are inverted. None: no board is carried.
std::optional<SensorId> CarrierOf(const SessionHeader& header, const SessionViews& views) {
  for (const auto& [sensor, pose] : views.T_ref_sensor)
    if (CarriesTarget(header, sensor)) return sensor;
  return std::nullopt;
}

// Boards of one world; what is carried about by hand is a world of its own in every capture.
bool TakesPart(const Target& board, const std::optional<SensorId>& carrier, const SessionViews& views) {
  return board.mounted_on == carrier || !(carrier || views.boards_stand_still);
}

// Of each board that takes part, where the camera saw it; the one most often found first, of two the one told first.
Result<std::vector<calib::joint::CameraViews>> BoardsSeen(storage::Store& store, const Manifest& manifest,
                                                          const Sensor& camera, const std::optional<SensorId>& carrier,
                                                          const SessionViews& views) {
  std::vector<std::pair<std::size_t, calib::joint::CameraViews>> seen;
  for (const Target* board : CommonTargets(manifest.header, camera, camera)) {
    if (!TakesPart(*board, carrier, views)) continue;
    RIGCAL_ASSIGN(Sightings<storage::StoredView> sightings, DetectInImages(store, manifest, camera.id, *board));
    seen.push_back({CountFound(sightings), {camera, *board, {}, {}}});
    for (auto& [capture, one] : sightings) seen.back().second.views.emplace_back(capture, std::move(one.view));
  }
  std::stable_sort(seen.begin(), seen.end(), [](const auto& x, const auto& y) { return x.first > y.first; });
  std::vector<calib::joint::CameraViews> boards;
  for (auto& [found, board] : seen)
    if (found > 0) boards.push_back(std::move(board));
  return boards;
}

// The board most often seen of which the camera can be estimated tells the lens, unless it is given; by that lens the
// others' places are found. None: its edges failed and say why.
Status AddCamera(storage::Store& store, const Manifest& manifest, const Sensor& camera,
                 const std::optional<SensorId>& carrier, calib::CameraMemory& cameras, SessionViews& views) {
  RIGCAL_ASSIGN(std::vector<calib::joint::CameraViews> boards, BoardsSeen(store, manifest, camera, carrier, views));
  Sensor with_lens = camera;
  bool has_lens = false;
  for (calib::joint::CameraViews& board : boards) {
    auto estimate = cameras.Estimate({with_lens, board.board, board.views});
    if (!estimate) continue;
    if (!has_lens) with_lens.intrinsics = estimate->intrinsics, with_lens.intrinsics_sigma = {};
    has_lens = true;
    board.estimate = std::move(*estimate);
    views.cameras.push_back(std::move(board));
  }
  return {};
}

// Boards of cameras that the lidar is calibrated with were searched in its clouds.
Status AddLidar(storage::Store& store, const Manifest& manifest, const Sensor& lidar, const Pairs& pairs,
                const std::optional<SensorId>& carrier, SessionViews& views) {
  calib::joint::LidarViews of_lidar{lidar, {}};
  std::set<TargetId> looked_for;
  for (const SensorId& partner : pairs.PartnersOf(lidar.id)) {
    const Sensor* sensor = SensorOf(manifest.header, partner);
    if (sensor == nullptr || sensor->kind != SensorKind::kCamera) continue;
    for (const Target* target : CommonTargets(manifest.header, lidar, *sensor)) {
      if (!TakesPart(*target, carrier, views) || !looked_for.insert(target->id).second) continue;
      RIGCAL_ASSIGN(auto clouds, DetectInClouds(store, manifest, lidar.id, *target));
      for (auto& [capture, seen] : clouds) {
        seen.view.target = target->id;
        of_lidar.clouds[capture].push_back(std::move(seen.view));
      }
    }
  }
  views.lidars.push_back(std::move(of_lidar));
  return {};
}

Status AddTracker(storage::Store& store, const Manifest& manifest, const Sensor& tracker,
                  const std::optional<SensorId>& carrier, SessionViews& views) {
  if (carrier && *carrier != tracker.id) return {};
  auto poses = LoadPoses(store, manifest, tracker);
  auto path = LoadTrackerPath(store, manifest, tracker);
  for (const auto* table : {&poses, &path})
    if (!*table && IsOurFault(table->error())) return Fail(table->error());
  if (!poses || !path) return {};
  if (carrier)
    for (auto* table : {&*poses, &*path})
      for (TimedPose& pose : *table) pose.T_world_body = pose.T_world_body.Inverse();
  views.trackers.push_back({tracker, std::move(*poses), std::move(*path)});
  return {};
}

Status AddSensor(storage::Store& store, const Manifest& manifest, const Sensor& sensor, const Pairs& pairs,
                 calib::CameraMemory& cameras, SessionViews& views) {
  const std::optional<SensorId> carrier = CarrierOf(manifest.header, views);
  if (sensor.kind == SensorKind::kCamera) return AddCamera(store, manifest, sensor, carrier, cameras, views);
  if (sensor.kind == SensorKind::kLidar) return AddLidar(store, manifest, sensor, pairs, carrier, views);
  if (sensor.kind == SensorKind::kTracker) return AddTracker(store, manifest, sensor, carrier, views);
  return {};
}

void AddLidarPairs(const std::vector<Edge>& edges, SessionViews& views) {
  for (const Edge& edge : edges)
    if (edge.state == EdgeState::kGood && edge.method == NameOf(Method::kLidarLidar))
      views.relatives.push_back({edge.frame_a, edge.frame_b, edge.T_a_b, edge.uncertainty.Omega, edge.uncertainty.dof});
}

// Sensors whose pose the session's own pairs tell whole.
void AddStart(const std::vector<Edge>& edges, const SensorId& reference, SessionViews& views) {
  for (const SensorPose& pose : graph::Solve(graph::GraphOf(edges, reference)).poses)
    if (pose.known) views.T_ref_sensor[pose.sensor] = pose.T_ref_sensor;
}

// Of the sensors that `edges` tie to `reference`.
Result<SessionViews> LoadViews(storage::Store& store, const Manifest& manifest, const std::vector<Edge>& edges,
                               const SensorId& reference, calib::CameraMemory& cameras) {
  SessionViews views;
  views.reference = reference;
  views.targets = manifest.header.targets;
  views.boards_stand_still = Pairs{edges}.HaveBoardsThatStandStill();
  const std::vector<Edge> counting = graph::WithoutEdges(edges, graph::WeakBesideBetter(edges));
  AddStart(counting, views.reference, views);
  for (const Sensor& sensor : manifest.header.sensors)
    if (views.T_ref_sensor.contains(sensor.id))
      RIGCAL_TRY(AddSensor(store, manifest, sensor, Pairs{edges}, cameras, views));
  AddLidarPairs(counting, views);
  return views;
}

Result<SessionEstimate> Refined(const SessionId& session, const SessionViews& views) {
  SessionEstimate estimate = calib::joint::EstimateSession(views);
  estimate.session = session;
  if (!estimate.why_not.empty() && estimate.why_not.front().code == NameOf(ErrorCode::kInternal))
    return Fail(ErrorCode::kInternal, "session " + session.str() + ": " + estimate.why_not.front().what,
                estimate.why_not.front().cure);
  return estimate;
}

// Groups of sensors that pairs tie whole, but for those that hang together with the reference: they are in `whole`.
std::vector<std::set<SensorId>> IslandsOf(const std::vector<Edge>& edges, const SessionViews& whole) {
  std::vector<std::set<SensorId>> pairs;
  for (const Edge& edge : edges)
    if (edge.state == EdgeState::kGood && edge.uncertainty.rank == 6) pairs.push_back({edge.frame_a, edge.frame_b});
  std::vector<std::set<SensorId>> islands = Connected(pairs);
  std::erase_if(islands, [&](const std::set<SensorId>& island) {
    return std::any_of(island.begin(), island.end(), [&](const SensorId& sensor) {
      return sensor == whole.reference || whole.T_ref_sensor.contains(sensor);
    });
  });
  return islands;
}

// The pairs of an island, and the one of its sensors that session.yaml names first.
std::vector<Edge> EdgesOf(const std::set<SensorId>& island, const std::vector<Edge>& edges) {
  std::vector<Edge> own;
  std::copy_if(edges.begin(), edges.end(), std::back_inserter(own),
               [&](const Edge& edge) { return island.contains(edge.frame_a) && island.contains(edge.frame_b); });
  return own;
}
SensorId FirstOf(const std::set<SensorId>& island, const std::vector<Sensor>& sensors) {
  return std::find_if(sensors.begin(), sensors.end(), [&](const Sensor& sensor) { return island.contains(sensor.id); })
      ->id;
}

// Without those that have no pictures of boards: their pairs stand.
Status AddIslands(storage::Store& store, const Manifest& manifest, const std::vector<Edge>& edges,
                  const SessionViews& whole, calib::CameraMemory& cameras, SessionEstimate& estimate) {
  for (const std::set<SensorId>& island : IslandsOf(edges, whole)) {
    RIGCAL_ASSIGN(const SessionViews views, LoadViews(store, manifest, EdgesOf(island, edges),
                                                      FirstOf(island, manifest.header.sensors), cameras));
    auto one = Refined(estimate.session, views);
    if (!one)
      LogError(one.error());  // its pairs stand, and the rest of the session too
    else if (one->why_not.empty() || one->why_not.front().code != NameOf(ErrorCode::kInvalidInput))
      estimate.islands.push_back(std::move(*one));
  }
  return {};
}

// An edge could not be made from what the disk has kept, and was not made again yet.
bool WaitsForFiles(const std::vector<Edge>& edges) {
  std::set<EdgeId> ids;
  for (const Edge& edge : edges) ids.insert(edge.id);
  return std::any_of(edges.begin(), edges.end(), [&](const Edge& edge) {
    return FailedForLostFile(edge) && !ids.contains(RepeatedEdgeId(edge.id));
  });
}

void LogTime(const SessionId& session, std::chrono::steady_clock::time_point began,
             std::chrono::steady_clock::time_point loaded) {
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began, loading = loaded - began;
  LogInfo("session " + session.str() + ": refined in " + std::to_string(took.count()) + " s, " +
          std::to_string(loading.count()) + " s of it to load its views");
}

Status RefineSession(storage::Store& store, const storage::SessionEstimateRow& row, calib::CameraMemory& cameras,
                     const Clock& clock) {
  RIGCAL_ASSIGN(const SquareSizes sizes, formats::ReadSquareSizes(row.sizes));
  RIGCAL_ASSIGN(const auto estimate, EstimateStored(store, row.session, sizes, cameras));
  if (!estimate) return {};
  return storage::AppendSessionEstimate(store, *estimate, storage::EstimatorNamed(kSessionEstimator, row.sizes),
                                        clock.Now());
}

// What it says to people of sensors that were retired since. Their poses take no part where no edge of them counts.
void LeaveOutGone(const std::map<SensorId, Standing>& gone, SessionEstimate& estimate) {
  for (RefinedPose& pose : estimate.poses)
    if (gone.contains(pose.sensor)) pose.smallest_move.reset();
  std::erase_if(estimate.by_pairs, [&](const SmallestMoveByPairs& one) { return gone.contains(one.sensor); });
  std::erase_if(estimate.held_back,
                [&](const HeldBackLook& look) { return gone.contains(look.sensor) || gone.contains(look.against); });
}

std::vector<SessionId> SessionsOf(const std::vector<SessionEstimate>& estimates) {
  std::vector<SessionId> sessions;
  for (const SessionEstimate& estimate : estimates)
    if (sessions.empty() || sessions.back() != estimate.session) sessions.push_back(estimate.session);
  return sessions;
}

}  // namespace

Result<std::optional<SessionEstimate>> EstimateStored(storage::Store& store, const SessionId& session,
                                                      const SquareSizes& sizes, calib::CameraMemory& cameras) {
  using Made = std::optional<SessionEstimate>;
  const auto began = std::chrono::steady_clock::now();
  RIGCAL_ASSIGN(const storage::JobCount jobs, storage::CountJobs(store, session));
  if (jobs.waiting > 0) return Made();  // some of its pairs are not there yet
  RIGCAL_ASSIGN(auto manifest, storage::LoadManifest(store, session));
  RIGCAL_ASSIGN(const std::vector<Edge> edges, storage::LoadEdges(store, session));
  if (!manifest || edges.empty() || WaitsForFiles(edges)) return Made();
  TakeSizes(sizes, manifest->header.targets);
  RIGCAL_ASSIGN(const SessionViews views, LoadViews(store, *manifest, edges, manifest->header.reference, cameras));
  const auto loaded = std::chrono::steady_clock::now();
  RIGCAL_ASSIGN(SessionEstimate estimate, Refined(session, views));
  RIGCAL_TRY(AddIslands(store, *manifest, edges, views, cameras, estimate));
  AddMovesOfPairs(edges, RecordedCaptures(*manifest), estimate);
  LogTime(session, began, loaded);
  return Made(std::move(estimate));
}

Status RefineSessions(storage::Store& store, const RobotId& robot, calib::CameraMemory& cameras, const Clock& clock) {
  RIGCAL_ASSIGN(const auto rows, storage::LoadSessionEstimates(store, robot, kSessionEstimator, kSessionsFused));
  for (const storage::SessionEstimateRow& row : rows) {
    if (row.estimate) continue;
    const Status refined = RefineSession(store, row, cameras, clock);
    if (!refined && refined.error().code == ErrorCode::kUnreachable) return refined;  // it is there again later
    if (!refined) LogError(refined.error());
  }
  return {};
}

Result<CurrentEstimates> LoadCurrentEstimates(storage::Store& store, const RobotId& robot, const CurrentEdges& current,
                                              std::int64_t run) {
  RIGCAL_ASSIGN(auto rows, storage::LoadSessionEstimates(store, robot, kSessionEstimator, kSessionsFused, run));
  CurrentEstimates result;
  for (storage::SessionEstimateRow& row : rows)
    if (row.estimate) result.estimates.push_back(std::move(*row.estimate));
  result.estimates = IslandsApart(std::move(result.estimates));
  RIGCAL_ASSIGN(result.within, LoadEdgesWithin(store, current, SessionsOf(result.estimates)));
  RIGCAL_ASSIGN(const Epochs epochs, Epochs::Load(store, SessionsOf(result.estimates), current.counts.epochs));
  const SessionSensors counting = SensorsThatCount(current, result.within);
  for (SessionEstimate& estimate : result.estimates) {
    const SessionId& session = estimate.session;
    const auto is_past_sensor = [&](const SensorId& sensor) {
      return epochs.After(session, sensor) != nullptr || !counting.contains({session, sensor});
    };
    const auto is_past = [&](const auto& told) { return is_past_sensor(told.sensor); };
    const auto is_either_past = [&](const auto& told) {  // of two that may have moved somebody found which one
      return is_past(told) || (!told.or_sensor.empty() && epochs.After(session, told.or_sensor) != nullptr);
    };
    std::erase_if(estimate.moved, is_either_past);
    std::erase_if(estimate.boards_moved, [&](const BoardMovedWithin& moved) {
      return !moved.world_of.empty() && is_past_sensor(moved.world_of);
    });
    std::erase_if(estimate.late, is_either_past);
    std::erase_if(estimate.lost_sights, is_past);
    std::erase_if(estimate.misfits, [&](const LensMisfit& misfit) {
      return !counting.contains({session, misfit.camera});
    });
    std::erase_if(estimate.clocks, [&](const TrackerClock& clock) {
      return !counting.contains({session, clock.tracker});
    });
    LeaveOutGone(current.counts.retired_sensors, estimate);
  }
  return result;
}

SessionSensors SensorsThatCount(const CurrentEdges& current, const std::vector<Edge>& within) {
  SessionSensors counting;
  for (const std::vector<Edge>* edges : {&current.edges, &within})
    for (const Edge& edge : *edges)
      if (edge.state == EdgeState::kGood)
        for (const SensorId& sensor : {edge.frame_a, edge.frame_b}) counting.emplace(edge.session, sensor);
  return counting;
}

}  // namespace rigcal::pipeline
