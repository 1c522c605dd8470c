#include "server/calib/joint/estimate_session.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <set>
#include <tuple>

#include "server/calib/joint/cluster_covariance.h"
#include "server/calib/joint/moved_sensor.h"

namespace rigcal::calib::joint {
namespace {

constexpr double kHeldBackBelow = 0.5;  // of a look's weight
constexpr int kMovesMax = 4;            // in one session: more is no bump, but a rig that is not rigid
constexpr int kGroupsForMoves = 6;      // fewer do not tell a bump from chance

SessionEstimate Refused(const SessionViews& views, const Error& error) {
  SessionEstimate estimate;
  estimate.reference = views.reference;
  estimate.why_not.push_back({NameOf(error.code), error.what, error.cure});
  return estimate;
}

const CaptureId& CaptureAt(const SessionProblem& problem, int place) {
  return problem.captures[static_cast<std::size_t>(problem.capture_of_place[static_cast<std::size_t>(place)])];
}

// Captures on both sides of the first place of `group` in which the sensor saw something.
SensorMovedWithin Told(const SessionProblem& problem, const Refined& refined, const SensorMove& move) {
  SensorMovedWithin told;
  told.sensor = problem.sensors[static_cast<std::size_t>(move.sensor)];
  told.step = move.step;
  told.odds = move.odds;
  int before = kNone, after = kNone;
  const auto look_at = [&](const auto& looks) {
    for (const auto& look : looks) {
      if (look.sensor != move.sensor) continue;
      const bool is_after = refined.group_of_place[static_cast<std::size_t>(look.place)] >= move.group;
      if (is_after && (after == kNone || look.place < after)) after = look.place;
      if (!is_after && look.place > before) before = look.place;
    }
  };
  look_at(problem.corners);
  look_at(problem.plates);
  look_at(problem.poses);
  if (before != kNone) told.last_before = CaptureAt(problem, before);
  if (after != kNone) told.first_after = CaptureAt(problem, after);
  return told;
}

// The sensor's looks from `group` on become those of a second sensor with a pose of its own.
SessionStart Split(SessionStart start, const Refined& refined, const SensorMove& move) {
  const auto old = static_cast<std::size_t>(move.sensor);
  const int added = static_cast<int>(start.problem.sensors.size());
  start.state = refined.state;
  start.noise = refined.noise;
  start.problem.sensors.push_back(start.problem.sensors[old]);
  start.problem.range_bias_sigma_m.push_back(start.problem.range_bias_sigma_m[old]);
  start.state.T_ref_sensor.push_back((start.state.T_ref_sensor[old] * Se3::Exp(move.step)).Normalized());
  start.state.range_bias_m.push_back(start.state.range_bias_m[old]);
  start.noise.push_back(start.noise[old]);
  const auto split = [&](auto& looks) {
    for (auto& look : looks)
      if (look.sensor == move.sensor && refined.group_of_place[static_cast<std::size_t>(look.place)] >= move.group)
        look.sensor = added;
  };
  split(start.problem.corners);
  split(start.problem.plates);
  split(start.problem.poses);
  // What was known of it from all captures together holds for neither of its poses.
  std::erase_if(start.problem.relatives, [&](const RelativeKnown& known) {
    return known.sensor_a == move.sensor || known.sensor_b == move.sensor;
  });
  return start;
}

// Moves one after the other: each is taken out by giving the sensor a pose of its own from then on, so that it does not
// hide the next.
void FindMoves(SessionStart& start, Refined& refined, SessionEstimate& estimate) {
  while (static_cast<int>(estimate.moved.size()) < kMovesMax && refined.groups >= kGroupsForMoves) {
    const std::vector<SensorMove> moves = ScanForMoves(start.problem, refined);
    if (moves.empty() || !IsMove(moves.front().step, moves.front().covariance, moves.front().odds)) return;
    const SensorMovedWithin told = Told(start.problem, refined, moves.front());
    if (told.last_before.empty() || told.first_after.empty()) return;
    estimate.moved.push_back(told);
    SessionStart split = Split(start, refined, moves.front());
    auto again = Refine(split.problem, split.state, split.noise, refined.group_of_place);
    if (!again) return;
    start = std::move(split);
    refined = std::move(*again);
  }
}

template <typename Looks>
void AddHeldBack(const SessionProblem& problem, const Looks& looks, const std::vector<double>& weights,
                 std::vector<HeldBackLook>& held_back) {
  for (std::size_t i = 0; i < looks.size(); ++i)
    if (weights[i] < kHeldBackBelow)
      held_back.push_back({problem.sensors[static_cast<std::size_t>(looks[i].sensor)],
                           CaptureAt(problem, looks[i].place)});
}

// Rows of the poses in the order of `sensors`, indices of the problem.
Eigen::MatrixXd InOrder(const Eigen::MatrixXd& joint, const std::vector<int>& row_of_sensor, const std::vector<int>& sensors) {
  std::vector<int> rows;
  for (const int sensor : sensors)
    if (const int row = row_of_sensor[static_cast<std::size_t>(sensor)]; row != kNone)
      for (int i = 0; i < 6; ++i) rows.push_back(row + i);
  return joint(rows, rows);
}

// A sensor that moved is in the problem several times, its last pose last.
void AddPoses(const SessionProblem& problem, const Refined& refined, SessionEstimate& estimate) {
  std::map<SensorId, int> last;
  for (int s = 0; s < static_cast<int>(problem.sensors.size()); ++s)
    if (s != problem.reference && problem.sensors[static_cast<std::size_t>(s)] != estimate.reference)
      last[problem.sensors[static_cast<std::size_t>(s)]] = s;
  last[estimate.reference] = problem.reference;
  const PoseCovariance covariance = CovarianceOfPoses(refined);
  std::vector<int> sensors;
  for (const auto& [id, s] : last) {
    estimate.poses.push_back({id, refined.state.T_ref_sensor[static_cast<std::size_t>(s)],
                              covariance.dof[static_cast<std::size_t>(s)]});
    sensors.push_back(s);
  }
  estimate.covariance = InOrder(covariance.joint, covariance.row_of_sensor, sensors);
  if (!covariance.common.isZero(0)) estimate.common = InOrder(covariance.common, covariance.row_of_sensor, sensors);
}

// Without the sensors of which the session says too little: their pairs stand as they are.
Result<SessionStart> StartOfWhatIsTold(const SessionViews& views) {
  std::set<SensorId> left_out;
  while (true) {
    RIGCAL_ASSIGN(SessionStart start, StartOf(views, left_out));
    const int open = OpenSensor(start.problem, start.state, start.noise, GroupsOf(start.problem, start.state));
    if (open == kNone) return start;
    left_out.insert(start.problem.sensors[static_cast<std::size_t>(open)]);
  }
}

SessionEstimate Estimate(const SessionViews& views) {
  auto start = StartOfWhatIsTold(views);
  if (!start) return Refused(views, start.error());
  auto refined = Refine(start->problem, start->state, start->noise, GroupsOf(start->problem, start->state));
  if (!refined) return Refused(views, refined.error());
  SessionEstimate estimate;
  estimate.reference = views.reference;
  AddHeldBack(start->problem, start->problem.corners, refined->weights.corners, estimate.held_back);
  AddHeldBack(start->problem, start->problem.plates, refined->weights.plates, estimate.held_back);
  AddHeldBack(start->problem, start->problem.poses, refined->weights.poses, estimate.held_back);
  std::sort(estimate.held_back.begin(), estimate.held_back.end(), [](const HeldBackLook& x, const HeldBackLook& y) {
    return std::tie(x.sensor, x.capture) < std::tie(y.sensor, y.capture);
  });
  FindMoves(*start, *refined, estimate);
  AddPoses(start->problem, *refined, estimate);
  return estimate;
}

}  // namespace

SessionEstimate EstimateSession(const SessionViews& views) {
  try {
    return Estimate(views);
  } catch (const std::exception& exception) {
    return Refused(views, {ErrorCode::kInternal, std::string("the joint refinement broke off: ") + exception.what(),
                           "The calibration of the pairs stands; report this with the session's id."});
  }
}

}  // namespace rigcal::calib::joint
