#include "server/report/text/changes.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <tuple>

#include "server/model/edges/merged_edge.h"
#include "server/model/edges/past.h"

namespace rigcal::report {
namespace {

using Poses = std::map<SensorId, const SensorPose*>;

Poses KnownPoses(const formats::RevisionInput& revision) {
  Poses known;
  for (const SensorPose& pose : revision.solution.poses)
    if (pose.known) known.emplace(pose.sensor, &pose);
  return known;
}

Vector6d SigmaOf(const SensorPose& pose) { return pose.covariance.diagonal().cwiseMax(0.0).cwiseSqrt(); }

}  // namespace

SensorMove MoveOf(const SensorPose& before, const SensorPose& now) {
  SensorMove move;
  move.sensor = now.sensor;
  move.d = (before.T_ref_sensor.Inverse() * now.T_ref_sensor).Log();
  move.sigma = SigmaOf(before).cwiseMax(SigmaOf(now));
  move.distance_m = (now.T_ref_sensor.p_m - before.T_ref_sensor.p_m).norm();
  move.angle_rad = move.d.tail<3>().norm();
  for (int axis = 0; axis < 6; ++axis)
    if (move.sigma(axis) > 0.0) move.in_sigmas = std::max(move.in_sigmas, std::abs(move.d(axis)) / move.sigma(axis));
  return move;
}

namespace {

std::vector<SensorId> Missing(const Poses& of, const Poses& in) {
  std::vector<SensorId> missing;
  for (const auto& [sensor, pose] : of)
    if (!in.contains(sensor)) missing.push_back(sensor);
  return missing;
}

using MeasuredPair = std::tuple<SensorId, SensorId, std::string>;

MeasuredPair MeasuredPairOf(const Edge& edge) { return {edge.frame_a, edge.frame_b, edge.method}; }

// A merged edge is nothing new, and nothing lost.
std::vector<const Edge*> MissingEdges(const formats::RevisionInput& of, const formats::RevisionInput& in) {
  std::set<EdgeId> held;
  for (const Edge& edge : in.edges) held.insert(edge.id);
  std::vector<const Edge*> missing;
  for (const Edge& edge : of.edges)
    if (!held.contains(edge.id) && !IsMerged(edge)) missing.push_back(&edge);
  return missing;
}

// Edges that became part of a merged one are not lost.
std::vector<const Edge*> LostEdges(const formats::RevisionInput& before, const formats::RevisionInput& now) {
  std::set<MeasuredPair> merged, merged_of_sessions;
  for (const Edge& edge : now.edges)
    if (IsMerged(edge)) (IsMergedOfSessions(edge) ? merged_of_sessions : merged).insert(MeasuredPairOf(edge));
  std::vector<const Edge*> lost = MissingEdges(before, now);
  std::erase_if(lost, [&](const Edge* edge) {
    if (edge->session.empty()) return merged.contains(MeasuredPairOf(*edge));
    return edge->state != EdgeState::kGood || merged_of_sessions.contains(MeasuredPairOf(*edge));
  });
  return lost;
}

std::vector<const Edge*> NowPast(const formats::RevisionInput& before, const formats::RevisionInput& now) {
  std::set<EdgeId> good;
  for (const Edge& edge : before.edges)
    if (edge.state == EdgeState::kGood) good.insert(edge.id);
  std::vector<const Edge*> past;
  for (const Edge& edge : now.edges)
    if (IsPast(edge) && good.contains(edge.id)) past.push_back(&edge);
  return past;
}

std::set<SensorId> GoneIn(const formats::RevisionInput& revision) {
  std::set<SensorId> gone;
  for (const RetiredSensor& one : revision.retired) gone.insert(one.sensor);
  return gone;
}

void CompareSensors(const formats::RevisionInput& before, const formats::RevisionInput& now, Changes& changes) {
  const Poses old = KnownPoses(before), current = KnownPoses(now);
  changes.sensors_gained = Missing(current, old);
  changes.sensors_lost = Missing(old, current);
  const std::set<SensorId> gone_before = GoneIn(before), gone = GoneIn(now);
  std::set_difference(gone.begin(), gone.end(), gone_before.begin(), gone_before.end(),
                      std::back_inserter(changes.sensors_retired));
  std::erase_if(changes.sensors_lost, [&](const SensorId& sensor) { return gone.contains(sensor); });
  changes.same_reference = before.reference == now.reference;
  if (!changes.same_reference) return;
  for (const auto& [sensor, pose] : current)
    if (const auto found = old.find(sensor); found != old.end() && sensor != now.reference)
      changes.moves.push_back(MoveOf(*found->second, *pose));
  std::stable_sort(changes.moves.begin(), changes.moves.end(),
                   [](const SensorMove& a, const SensorMove& b) { return a.in_sigmas > b.in_sigmas; });
}

}  // namespace

Changes Compare(const formats::RevisionInput& before, const formats::RevisionInput& now) {
  Changes changes;
  CompareSensors(before, now, changes);
  changes.edges_gained = MissingEdges(now, before);
  changes.edges_lost = LostEdges(before, now);
  changes.edges_past = NowPast(before, now);
  return changes;
}

}  // namespace rigcal::report
