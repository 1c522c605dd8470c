#include "client/companion/rig_so_far.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "client/companion/camera_so_far.h"
#include "server/model/edges/captures_wanted.h"

namespace rigcal::companion {
namespace {

using calib::placement::PlannedCamera;
using calib::placement::PlannedCapture;

constexpr double kNear_m = 0.02, kNear_ratio = 0.01, kNear_rad = 0.0175;

// A board that looks the same turned has as many poses.
std::vector<Se3> TurnsOf(const Target& board) {
  const int count = SymmetryOf(board);
  const Se3 T_board_middle{CentreOf(board), Eigen::Quaterniond::Identity()};
  std::vector<Se3> turns;
  for (int turn = 0; turn < count; ++turn) {
    const Eigen::AngleAxisd about(turn * 2 * M_PI / count, Eigen::Vector3d::UnitZ());
    turns.push_back(T_board_middle * Se3{Eigen::Vector3d::Zero(), Eigen::Quaterniond(about)} *
                    T_board_middle.Inverse());
  }
  return turns;
}

// The likeliest first.
std::vector<Se3> AllowedBy(const BoardSeen& view) {
  std::vector<Se3> poses = {view.T_camera_board};
  poses.insert(poses.end(), view.other_poses.begin(), view.other_poses.end());
  return poses;
}

// How far a pose is from another, in what two views of a board agree within.
double Away(const Se3& T, const Se3& S) {
  const Vector6d off = (T.Inverse() * S).Log();
  return off.head<3>().norm() / kNear_m + off.tail<3>().norm() / kNear_rad;
}

class Placing {
 public:
  Placing(const Captured& captured, std::vector<PlannedCamera> cameras)
      : captured_(captured), cameras_(std::move(cameras)) {
    for (const PlannedCamera& camera : cameras_) {
      views_.push_back(BoardsSeenBy(captured, camera));
      const auto& found = captured.cameras.at(camera.id).found.board;
      boards_.push_back(found ? IndexOf(found->id) : captured.header.targets.size());
    }
  }

  RigSoFar Run() {
    RigSoFar so_far;
    so_far.rig.boards = captured_.header.targets;
    placed_.assign(cameras_.size(), std::nullopt);
    if (cameras_.empty()) return so_far;
    const std::size_t reference = Reference();
    placed_[reference] = Se3{};
    while (PlaceOne()) {
    }
    PlaceAsDrawn(reference);
    Gather(reference, so_far);
    return so_far;
  }

 private:
  [[nodiscard]] std::size_t IndexOf(const TargetId& id) const {
    const auto& targets = captured_.header.targets;
    return static_cast<std::size_t>(
        std::find_if(targets.begin(), targets.end(), [&](const Target& one) { return one.id == id; }) -
        targets.begin());
  }
  [[nodiscard]] bool IsLensKnown(std::size_t camera) const {
    return captured_.cameras.at(cameras_[camera].id).intrinsics.has_value();
  }
  [[nodiscard]] std::size_t Reference() const {
    for (std::size_t c = 0; c < cameras_.size(); ++c)
      if (cameras_[c].id == captured_.header.reference) return c;
    return 0;
  }

  // Of every capture that both have, by every pose that either view allows and every turn of its board; none by a lens
  // that is only guessed.
  [[nodiscard]] std::vector<std::vector<Se3>> RelativePoses(std::size_t a, std::size_t b) const {
    std::vector<std::vector<Se3>> captures;
    if (!IsLensKnown(a) || !IsLensKnown(b) || boards_[a] != boards_[b] || boards_[a] >= captured_.header.targets.size())
      return captures;
    const std::vector<Se3> turns = TurnsOf(captured_.header.targets[boards_[a]]);
    for (const auto& [capture, view] : views_[a])
      if (const auto other = views_[b].find(capture); other != views_[b].end()) {
        std::vector<Se3>& poses = captures.emplace_back();
        for (const Se3& T_a_board : AllowedBy(view))
          for (const Se3& T_b_board : AllowedBy(other->second))
            for (const Se3& turn : turns) poses.push_back((T_a_board * turn * T_b_board.Inverse()).Normalized());
      }
    return captures;
  }

  // The camera that shares most captures with one that has a place.
  bool PlaceOne() {
    std::vector<std::vector<Se3>> most;
    std::size_t from = 0, next = 0;
    for (std::size_t a = 0; a < cameras_.size(); ++a)
      for (std::size_t b = 0; placed_[a] && b < cameras_.size(); ++b) {
        if (placed_[b]) continue;
        std::vector<std::vector<Se3>> captures = RelativePoses(a, b);
        if (captures.size() > most.size()) most = std::move(captures), from = a, next = b;
      }
    if (most.empty()) return false;
    placed_[next] = (*placed_[from] * MostAgreedOn(most, Drawn(from, next))).Normalized();
    return true;
  }

  // T_from_to of the drawing.
  [[nodiscard]] std::optional<Se3> Drawn(std::size_t from, std::size_t to) const {
    return NominalPose(captured_.header, *SensorOf(captured_.header, cameras_[from].id),
                       *SensorOf(captured_.header, cameras_[to].id));
  }

  void PlaceAsDrawn(std::size_t reference) {
    for (std::size_t c = 0; c < cameras_.size(); ++c)
      if (!placed_[c]) placed_[c] = Drawn(reference, c);
  }

  // Of the poses that a view allows, by every turn after which the board looks the same, the one that turns it as in
  // the capture's first look: all looks are of one board, and its axes are theirs. The rig has the first look's camera.
  [[nodiscard]] static Se3 AsInFirst(const PlannedCapture& capture, const calib::placement::PlannedRig& rig,
                                     const Se3& T_ref_camera, const BoardSeen& view) {
    if (capture.looks.empty()) return view.T_camera_board;
    const auto& first = capture.looks.front();
    const Se3 T_board_ref = (rig.cameras[first.camera].T_ref_camera * first.T_camera_board).Inverse();
    std::vector<Se3> poses;
    for (const Se3& T_camera_board : AllowedBy(view))
      for (const Se3& turn : TurnsOf(rig.boards[capture.board])) poses.push_back(T_camera_board * turn);
    const auto off_rad = [&](const Se3& pose) { return (T_board_ref * T_ref_camera * pose).Log().tail<3>().norm(); };
    return *std::min_element(poses.begin(), poses.end(),
                             [&](const Se3& x, const Se3& y) { return off_rad(x) < off_rad(y); });
  }

  void Gather(std::size_t reference, RigSoFar& so_far) const {
    std::map<std::pair<CaptureId, std::size_t>, PlannedCapture> captures;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      if (!placed_[c]) {
        so_far.unplaced.push_back(cameras_[c].id);
        continue;
      }
      if (c == reference) so_far.rig.reference = so_far.rig.cameras.size();
      for (const auto& [capture, view] : views_[c]) {
        PlannedCapture& planned = captures[{capture, boards_[c]}];
        planned.board = boards_[c];
        planned.looks.push_back(
            {so_far.rig.cameras.size(), AsInFirst(planned, so_far.rig, *placed_[c], view), view.corner_idx});
      }
      so_far.rig.cameras.push_back(cameras_[c]);
      so_far.rig.cameras.back().T_ref_camera = *placed_[c];
    }
    for (auto& [key, capture] : captures) so_far.captures.push_back(std::move(capture));
    TakePairs(so_far.rig);
  }

  // As the server and `rigcal check` have them: pairs of other sensors count as well, they share the odds.
  void TakePairs(calib::placement::PlannedRig& rig) const {
    std::map<SensorId, std::size_t> at;
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) at[rig.cameras[c].id] = c;
    const std::vector<SensorPair> pairs = PairsToCalibrate(captured_.header);
    for (const SensorPair& pair : pairs)
      if (at.contains(pair.a) && at.contains(pair.b)) rig.pairs.emplace_back(at.at(pair.a), at.at(pair.b));
    rig.captures_to_test = CapturesToTest(pairs.size());
  }

  const Captured& captured_;
  std::vector<PlannedCamera> cameras_;
  std::vector<std::map<CaptureId, BoardSeen>> views_;
  std::vector<std::size_t> boards_;  // of the views of each
  std::vector<std::optional<Se3>> placed_;
};

}  // namespace

Se3 MostAgreedOn(const std::vector<std::vector<Se3>>& captures, const std::optional<Se3>& drawn) {
  std::optional<Se3> best;
  std::ptrdiff_t most = -1;
  for (const std::vector<Se3>& allowed : captures)
    for (const Se3& pose : allowed) {
      const double near_m = std::max(kNear_m, kNear_ratio * pose.p_m.norm());
      const auto is_near = [&](const Se3& other) { return AreNear(pose, other, near_m, kNear_rad); };
      const std::ptrdiff_t near = std::count_if(captures.begin(), captures.end(), [&](const std::vector<Se3>& others) {
        return std::any_of(others.begin(), others.end(), is_near);
      });
      const bool is_nearer = near == most && drawn && Away(pose, *drawn) < Away(*best, *drawn);
      if (near > most || is_nearer) best = pose, most = near;
    }
  return *best;
}

RigSoFar RigOf(const Captured& captured) {
  std::vector<PlannedCamera> cameras;
  std::vector<SensorId> unknown;
  for (const Sensor& sensor : captured.header.sensors) {
    if (sensor.kind != SensorKind::kCamera) continue;
    if (auto camera = PlannedCameraOf(captured.header, sensor, captured.cameras.at(sensor.id)))
      cameras.push_back(*std::move(camera));
    else
      unknown.push_back(sensor.id);
  }
  RigSoFar so_far = Placing(captured, std::move(cameras)).Run();
  so_far.unplaced.insert(so_far.unplaced.end(), unknown.begin(), unknown.end());
  return so_far;
}

}  // namespace rigcal::companion
