#include "server/calib/joint/problem/session_start.h"

#include <algorithm>
#include <cmath>

#include "server/calib/core/capture_blocks.h"
#include "server/calib/joint/misfit/pose_clock.h"
#include "server/calib/joint/problem/board_candidates.h"
#include "server/calib/joint/problem/observation.h"
#include "server/calib/joint/problem/session_lists.h"

namespace rigcal::calib::joint {
namespace {

constexpr double kPatchAway_m = 0.3, kPatchTurned_rad = 0.2;

// A camera's look at its board in one capture.
struct View {
  int sensor = kNone, camera = kNone, target = kNone, capture = kNone;
  const BoardView* seen = nullptr;
  std::vector<Candidate> candidates;
};

// The poses as told from where the body was at its first capture: what that world moves by is then what its body seems
// to, wherever the tracker has its origin.
TrackerPoses FromFirstPose(TrackerPoses tracker) {
  const auto first = std::min_element(tracker.poses.begin(), tracker.poses.end(),
                                      [](const auto& x, const auto& y) { return TakenBefore{}(x.capture, y.capture); });
  if (first == tracker.poses.end()) return tracker;
  const Se3 T_first_world = first->T_world_body.Inverse();
  for (PoseTable* table : {&tracker.poses, &tracker.path})
    for (TimedPose& row : *table) row.T_world_body = (T_first_world * row.T_world_body).Normalized();
  return tracker;
}

class Starter {
 public:
  Starter(const SessionViews& views, SessionLists lists)
      : views_(views), start_(std::move(lists.start)), lens_of_camera_(std::move(lists.lens_of_camera)) {
    for (const TrackerPoses& tracker : views.trackers) from_first_pose_.push_back(FromFirstPose(tracker));
  }

  Result<SessionStart> Run() {
    if (problem().reference == kNone || problem().sensors.size() < 2)
      return Fail(ErrorCode::kInvalidInput, "the session's pairs do not tell two sensors, the reference among them",
                  "Capture the boards with the reference sensor and another one at once.");
    ListViews();
    views_.boards_stand_still ? LocateInOneWorld() : LocateByBoards();
    AddCorners();
    AddPlates();
    AddPoses();
    AddRelatives();
    if (start_.problem.corners.empty())
      return Fail(ErrorCode::kInvalidInput, "the session has no picture of a board whose place is known",
                  "Capture the boards with two sensors at once.");
    return std::move(start_);
  }

 private:
  SessionProblem& problem() { return start_.problem; }
  SessionState& state() { return start_.state; }

  [[nodiscard]] int SensorIndex(const SensorId& id) const { return IndexOf(start_.problem, id); }
  [[nodiscard]] int TargetIndex(const TargetId& id) const {
    const auto& targets = start_.problem.targets;
    const auto at = std::find_if(targets.begin(), targets.end(), [&](const Target& t) { return t.id == id; });
    return at == targets.end() ? kNone : static_cast<int>(at - targets.begin());
  }
  [[nodiscard]] int CaptureIndex(const CaptureId& id) const {
    const auto& captures = start_.problem.captures;
    const auto at = std::lower_bound(captures.begin(), captures.end(), id, TakenBefore{});
    return at != captures.end() && *at == id ? static_cast<int>(at - captures.begin()) : kNone;
  }
  [[nodiscard]] const Se3& T_ref(int sensor) const {
    return start_.state.T_ref_sensor[static_cast<std::size_t>(sensor)];
  }

  void ListViews() {
    for (const CameraViews& camera : views_.cameras) {
      const int sensor = SensorIndex(camera.camera.id);
      if (sensor == kNone) continue;
      for (const auto& [capture, seen] : camera.views) {
        if (!camera.estimate.T_cam_board.contains(capture)) continue;
        looks_.push_back({sensor, lens_of_camera_.at(camera.camera.id), TargetIndex(camera.board.id),
                          CaptureIndex(capture), &seen, CandidatesOf(camera.estimate, camera.board, capture)});
      }
    }
  }

  // Standing boards ---------------------------------------------------------------------------------------------------

  void LocateInOneWorld() {
    place_of_capture_.assign(problem().captures.size(), std::nullopt);
    board_pose_.assign(problem().targets.size(), std::nullopt);
    const bool tracked = LocateByTracker();
    if (!tracked) HoldMostSeenBoard();
    while (LocateBoards() || LocateTrackerWorlds() || LocateCaptures()) {
    }
    for (std::size_t t = 0; t < board_pose_.size(); ++t) {
      if (!board_pose_[t]) continue;
      if (static_cast<int>(t) == held_target_) problem().held_board = static_cast<int>(problem().boards.size());
      board_of_target_[static_cast<int>(t)] = AddStillFrame({problem().targets[t].id, {}}, *board_pose_[t]);
    }
    for (const auto& [tracker, T_world_other] : other_worlds_)
      board_of_tracker_[tracker] =
          AddStillFrame({{}, problem().sensors[static_cast<std::size_t>(tracker)]}, T_world_other);
    for (std::size_t k = 0; k < place_of_capture_.size(); ++k)
      if (place_of_capture_[k]) AddPlace(static_cast<int>(k), kNone, *place_of_capture_[k]);
  }

  int AddStillFrame(const StillFrame& frame, const Se3& T_world_frame) {
    problem().boards.push_back(frame);
    state().T_world_board.push_back(T_world_frame);
    return static_cast<int>(problem().boards.size()) - 1;
  }

  bool LocateByTracker() {
    for (const TrackerPoses& tracker : views_.trackers) {
      const int sensor = SensorIndex(tracker.tracker.id);
      if (sensor == kNone || tracker.poses.empty()) continue;
      for (const TimedPose& row : tracker.poses)
        place_of_capture_[static_cast<std::size_t>(CaptureIndex(row.capture))] =
            row.T_world_body * T_ref(sensor).Inverse();
      world_tracker_ = sensor;
      return true;
    }
    return false;
  }

  void HoldMostSeenBoard() {
    std::vector<int> seen(problem().targets.size(), 0);
    for (const View& look : looks_) ++seen[static_cast<std::size_t>(look.target)];
    if (seen.empty()) return;
    held_target_ = static_cast<int>(std::max_element(seen.begin(), seen.end()) - seen.begin());
    board_pose_[static_cast<std::size_t>(held_target_)] = Se3{};
  }

  // The pose that most looks agree on: of each that is `wanted` those by its candidates.
  template <typename Wanted, typename PoseBy>
  [[nodiscard]] std::optional<Se3> AgreedBy(const Wanted& wanted, const PoseBy& pose_by) const {
    std::vector<std::vector<Se3>> lists;
    for (const View& look : looks_) {
      if (!wanted(look)) continue;
      lists.emplace_back();
      for (const Candidate& candidate : look.candidates) lists.back().push_back(pose_by(look, candidate.T_cam_board));
    }
    return Agreed(lists);
  }
  [[nodiscard]] const std::optional<Se3>& PlaceOf(const View& look) const {
    return place_of_capture_[static_cast<std::size_t>(look.capture)];
  }
  [[nodiscard]] const std::optional<Se3>& BoardOf(const View& look) const {
    return board_pose_[static_cast<std::size_t>(look.target)];
  }

  bool LocateBoards() {
    bool found = false;
    for (std::size_t t = 0; t < board_pose_.size(); ++t) {
      if (board_pose_[t]) continue;
      board_pose_[t] = AgreedBy(
          [&](const View& look) { return look.target == static_cast<int>(t) && PlaceOf(look); },
          [&](const View& look, const Se3& T_cam_board) { return *PlaceOf(look) * T_ref(look.sensor) * T_cam_board; });
      found |= board_pose_[t].has_value();
    }
    return found;
  }

  // Of trackers beside the one whose world this is.
  bool LocateTrackerWorlds() {
    bool found = false;
    for (const TrackerPoses& tracker : from_first_pose_) {
      const int sensor = SensorIndex(tracker.tracker.id);
      if (sensor == kNone || sensor == world_tracker_ || other_worlds_.contains(sensor)) continue;
      std::vector<std::vector<Se3>> lists;
      for (const TimedPose& row : tracker.poses)
        if (const auto& place = place_of_capture_[static_cast<std::size_t>(CaptureIndex(row.capture))])
          lists.push_back({*place * T_ref(sensor) * row.T_world_body.Inverse()});
      const auto T_world_other = Agreed(lists);
      if (T_world_other) other_worlds_[sensor] = *T_world_other;
      found |= T_world_other.has_value();
    }
    return found;
  }

  bool LocateCaptures() {
    bool found = false;
    for (std::size_t k = 0; k < place_of_capture_.size(); ++k) {
      if (place_of_capture_[k]) continue;
      place_of_capture_[k] =
          AgreedBy([&](const View& look) { return look.capture == static_cast<int>(k) && BoardOf(look); },
                   [&](const View& look, const Se3& T_cam_board) {
                     return *BoardOf(look) * (T_ref(look.sensor) * T_cam_board).Inverse();
                   });
      if (!place_of_capture_[k]) place_of_capture_[k] = PlaceByOtherTracker(static_cast<int>(k));
      found |= place_of_capture_[k].has_value();
    }
    return found;
  }

  // Of a capture that the first tracker missed, by one whose world is known.
  [[nodiscard]] std::optional<Se3> PlaceByOtherTracker(int capture) const {
    for (const TrackerPoses& tracker : from_first_pose_) {
      const auto world = other_worlds_.find(SensorIndex(tracker.tracker.id));
      if (world == other_worlds_.end()) continue;
      for (const TimedPose& row : tracker.poses)
        if (CaptureIndex(row.capture) == capture)
          return world->second * row.T_world_body * T_ref(world->first).Inverse();
    }
    return std::nullopt;
  }

  // Boards that are carried about -------------------------------------------------------------------------------------

  void LocateByBoards() {
    for (int k = 0; k < static_cast<int>(problem().captures.size()); ++k)
      for (int t = 0; t < static_cast<int>(problem().targets.size()); ++t) {
        const auto place = AgreedBy(
            [&](const View& look) { return look.capture == k && look.target == t; },
            [&](const View& look, const Se3& T_cam_board) { return (T_ref(look.sensor) * T_cam_board).Inverse(); });
        if (place) AddPlace(k, t, *place);
      }
  }

  // Observations ------------------------------------------------------------------------------------------------------

  void AddPlace(int capture, int target, const Se3& T_world_ref) {
    place_of_[{capture, target}] = static_cast<int>(problem().capture_of_place.size());
    problem().capture_of_place.push_back(capture);
    state().T_world_ref.push_back(T_world_ref);
  }

  [[nodiscard]] std::optional<Where> WhereOf(int sensor, int capture, int target) const {
    Where where{sensor, kNone, kNone, target};
    const auto place = place_of_.find({capture, views_.boards_stand_still ? kNone : target});
    if (place == place_of_.end()) return std::nullopt;
    where.place = place->second;
    if (!views_.boards_stand_still) return where;
    const auto board = board_of_target_.find(target);
    if (board == board_of_target_.end()) return std::nullopt;
    where.board = board->second;
    return where;
  }

  void Unused(int sensor, int capture, WhyUnused why) {
    start_.unused.push_back({problem().sensors[static_cast<std::size_t>(sensor)],
                             problem().captures[static_cast<std::size_t>(capture)], why});
  }

  [[nodiscard]] bool IsSeen(const CornersSeen& look) const {
    const Se3 T_cam_board = T_sensor_board(start_.state, look);
    const auto camera = static_cast<std::size_t>(look.camera), target = static_cast<std::size_t>(look.target);
    return std::all_of(look.corners.idx.begin(), look.corners.idx.end(), [&](int i) {
      const Eigen::Vector3d& p = start_.problem.target_points[target][static_cast<std::size_t>(i)];
      return Project(start_.problem.cameras[camera].model, start_.state.intrinsics[camera], T_cam_board * p, false)
          .in_front;
    });
  }

  void AddCorners() {
    for (const View& look : looks_) {
      const auto where = WhereOf(look.sensor, look.capture, look.target);
      if (!where) {
        Unused(look.sensor, look.capture, WhyUnused::kPlaceUnknown);
        continue;
      }
      const Se3 expected = T_sensor_board(start_.state, *where);
      const auto off = [&](const Candidate& candidate) {
        return (expected.p_m - candidate.T_cam_board.p_m).norm() / kAgree_m +
               expected.q.angularDistance(candidate.T_cam_board.q) / kAgree_rad;
      };
      const auto best = std::min_element(look.candidates.begin(), look.candidates.end(),
                                         [&](const auto& x, const auto& y) { return off(x) < off(y); });
      CornersSeen seen{*where, look.camera,
                       SeenIn(*look.seen, problem().targets[static_cast<std::size_t>(look.target)], best->turn)};
      if (IsSeen(seen))
        problem().corners.push_back(std::move(seen));
      else
        Unused(look.sensor, look.capture, WhyUnused::kBehindTheCamera);
    }
  }

  void AddPlates() {
    for (const LidarViews& lidar : views_.lidars) {
      const int sensor = SensorIndex(lidar.lidar.id);
      if (sensor == kNone) continue;
      std::vector<std::pair<Where, const PlanePatch*>> chosen;
      for (const auto& [capture, clouds] : lidar.clouds) {
        const int k = CaptureIndex(capture);
        for (const CloudView& cloud : clouds) ChoosePatch(sensor, k, cloud, chosen);
      }
      std::vector<const PlanePatch*> patches;
      for (const auto& [where, patch] : chosen) patches.push_back(patch);
      const double range_sigma_m = RangeSigma_m(patches);
      for (const auto& [where, patch] : chosen) problem().plates.push_back({where, MomentsOf(*patch, range_sigma_m)});
    }
  }

  void ChoosePatch(int sensor, int capture, const CloudView& cloud,
                   std::vector<std::pair<Where, const PlanePatch*>>& chosen) {
    const int target = TargetIndex(cloud.target);
    if (capture == kNone || target == kNone || !cloud.found) return;
    const auto where = WhereOf(sensor, capture, target);
    if (!where) return;
    const Se3 expected = T_sensor_board(start_.state, *where);
    const Eigen::Vector3d centre = expected * PlateCentreOf(problem().targets[static_cast<std::size_t>(target)]);
    const PlanePatch* best = nullptr;
    double nearest_m = kPatchAway_m;
    for (const PlanePatch& patch : cloud.candidates) {
      const double turned_rad = std::acos(std::clamp(-expected.R().col(2).dot(patch.normal), -1.0, 1.0));
      const double away_m = (patch.centre_m - centre).norm();
      if (turned_rad < kPatchTurned_rad && away_m < nearest_m) best = &patch, nearest_m = away_m;
    }
    if (best != nullptr)
      chosen.emplace_back(*where, best);
    else
      Unused(sensor, capture, WhyUnused::kNoBoardThere);
  }

  void AddPoses() {
    for (std::size_t t = 0; t < views_.trackers.size(); ++t) {
      const int sensor = SensorIndex(views_.trackers[t].tracker.id);
      const auto world = board_of_tracker_.find(sensor);
      if (sensor == kNone || (sensor != world_tracker_ && world == board_of_tracker_.end())) continue;
      const TrackerPoses& tracker = sensor == world_tracker_ ? views_.trackers[t] : from_first_pose_[t];
      for (const TimedPose& row : tracker.poses) {
        const auto place = place_of_.find({CaptureIndex(row.capture), kNone});
        if (place == place_of_.end()) continue;
        PoseTold told;
        told.sensor = sensor;
        if (sensor != world_tracker_) told.board = world->second;
        told.place = place->second;
        told.T_world_body = row.T_world_body;
        told.stamp = row.stamp;
        problem().poses.push_back(told);
      }
      AddClock(tracker.tracker, tracker.path, problem(), state());
    }
  }

  void AddRelatives() {
    for (const SessionViews::Relative& relative : views_.relatives) {
      const int a = SensorIndex(relative.a), b = SensorIndex(relative.b);
      if (a != kNone && b != kNone) problem().relatives.push_back({a, b, relative.T_a_b, relative.Omega, relative.dof});
    }
  }

  const SessionViews& views_;
  SessionStart start_;
  std::map<SensorId, int> lens_of_camera_;
  std::vector<TrackerPoses> from_first_pose_;  // side by side with the views'
  std::vector<View> looks_;
  std::vector<std::optional<Se3>> place_of_capture_, board_pose_;
  std::map<std::pair<int, int>, int> place_of_;  // by capture and target (kNone: the one world)
  std::map<int, int> board_of_target_, board_of_tracker_;
  std::map<int, Se3> other_worlds_;  // T_world_(world of a tracker), by its sensor
  int held_target_ = kNone, world_tracker_ = kNone;
};

}  // namespace

Result<SessionStart> StartOf(const SessionViews& views, const std::set<SensorId>& left_out) {
  return Starter(views, ListsOf(views, left_out)).Run();
}

}  // namespace rigcal::calib::joint
