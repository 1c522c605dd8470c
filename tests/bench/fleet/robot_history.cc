#include "tests/bench/fleet/robot_history.h"

#include <algorithm>

#include "server/fleet/findings/findings.h"
#include "server/graph/fusion/merged_edge.h"
#include "server/graph/fusion/session_fusion.h"
#include "server/graph/solve/solve.h"
#include "server/model/approval/decision.h"
#include "server/model/edges/past.h"

namespace rigcal::drawn_fleet {
namespace {

// Of server/pipeline/sessions/session_refinement.h.
constexpr std::size_t kSessionsFused = 32;
// Edges of older sessions say nothing of a fused pose.
constexpr std::size_t kSessionsKept = kSessionsFused + graph::kSessionsKept;
constexpr const char* kMethod = "stereo";

void MakePast(const SensorId& sensor, Edge& edge) {
  if (edge.frame_a != sensor && edge.frame_b != sensor) return;
  edge.state = EdgeState::kFailed;
  edge.diagnoses = {{std::string(kRemountedCode), "sensor " + sensor.str() + " was remounted after this was measured",
                     "Measure the pair anew."}};
}

}  // namespace

fleet::AsFoundInput RobotHistory::InputOf(const SessionEstimate& estimate, std::set<SensorId> moved_on_purpose) const {
  fleet::AsFoundInput input;
  input.in_use = in_use_;
  input.session = fleet::PosesOf(estimate);
  input.left = input.session;
  input.moved_on_purpose = std::move(moved_on_purpose);
  input.pooled_scatter = pooled_;
  return input;
}

AsFound RobotHistory::Test(const SessionEstimate& estimate, std::set<SensorId> moved_on_purpose) const {
  return fleet::TestAsFound(InputOf(estimate, std::move(moved_on_purpose)));
}

void RobotHistory::BeginEpoch(const SensorId& sensor) {
  for (const SessionEstimate& estimate : newest_first_) of_before_.emplace(estimate.session, sensor);
  for (Edge& edge : all_) MakePast(sensor, edge);
  window_ = all_;  // what was merged holds no more
  merged_.clear();
}

std::vector<Edge> RobotHistory::EdgesOf(const SessionEstimate& estimate) const {
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < estimate.poses.size(); ++i) {
    const int row = RowOf(estimate, i);
    if (row < 0) continue;
    Edge edge;
    edge.robot = robot_;
    edge.frame_a = estimate.reference, edge.frame_b = estimate.poses[i].sensor;
    edge.session = estimate.session, edge.method = kMethod;
    edge.T_a_b = estimate.poses[i].T_ref_sensor;
    edge.id = EstimatedEdgeId(robot_, edge.session, edge.method, edge.frame_a, edge.frame_b);
    edge.state = EdgeState::kGood;
    const Matrix6d Omega = estimate.covariance.block<6, 6>(row, row).inverse();
    edge.uncertainty = FromInformation(Omega, UncertaintySource::kModel, static_cast<int>(estimate.poses[i].dof));
    edges.push_back(std::move(edge));
  }
  return edges;
}

// Edges of fused sessions that are in merged ones come back.
std::vector<Edge> RobotHistory::MergeOlder() {
  const graph::Merge merge = graph::MergeOlderSessions(merged_, window_, measured_at_);
  const std::set<EdgeId> taken(merge.taken.begin(), merge.taken.end());
  std::erase_if(window_, [&](const Edge& edge) { return taken.contains(edge.id); });
  merged_ = merge.merged;
  std::set<EdgeId> standing;
  for (const Edge& edge : window_) standing.insert(edge.id);
  std::vector<Edge> within = all_;
  std::erase_if(within, [&](const Edge& edge) { return standing.contains(edge.id); });
  return within;
}

void RobotHistory::Revise(const std::vector<Edge>& within) {
  std::vector<Edge> edges = window_;
  for (const MergedEdge& merged : merged_) edges.push_back(graph::EdgeOf(merged, robot_, false));
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) { return x.id < y.id; });
  GraphSolution solution = graph::Solve(graph::GraphOf(edges, reference_));
  graph::FuseSessions(edges, within, reference_, {newest_first_.begin(), newest_first_.end()}, solution, pooled_,
                      {captured_at_, measured_at_});
  KeepOwnScatter(solution);
  says_moved_ = !solution.fused.moved.empty();
  warns_of_apart_ = fleet::FindApart(solution, {}, {}).has_value();
  remarks_on_apart_ = !fleet::ApartRemark(solution, {}, {}).empty();
  newest_ = fleet::PosesOf(solution, reference_);
  Verdict verdict;
  verdict.level = solution.fused.moved.empty() ? VerdictLevel::kPass : VerdictLevel::kFail;
  if (Approves(Policy(), verdict) || !HasRevision()) in_use_ = newest_;
}

// Of server/pipeline/rig_models/pooled_scatter.cc.
void RobotHistory::KeepOwnScatter(const GraphSolution& solution) {
  std::set<SensorId> moved;
  for (const SensorMovedBetween& one : solution.fused.moved) moved.insert(one.sensor);
  own_scatter_.clear();
  for (const SensorPose& pose : solution.poses)
    if (pose.fused && !moved.contains(reference_) && !moved.contains(pose.sensor) &&
        pose.fused->scatter.translation.dof > 0)
      own_scatter_[pose.sensor] = pose.fused->scatter;
}

void RobotHistory::Take(SessionEstimate estimate, Stamp captured_at) {
  const std::size_t kept = kSessionsKept * (estimate.poses.size() - 1);
  for (Edge& edge : EdgesOf(estimate)) {
    measured_at_[edge.id] = captured_at;
    window_.push_back(edge);
    all_.push_back(std::move(edge));
  }
  if (all_.size() > kept) all_.erase(all_.begin(), all_.end() - static_cast<std::ptrdiff_t>(kept));
  captured_at_[estimate.session] = captured_at;
  newest_first_.push_front(std::move(estimate));
  if (newest_first_.size() > kSessionsFused) newest_first_.pop_back();
  Revise(MergeOlder());
}

void RobotHistory::AddRates(AsFound& found) const {
  std::vector<fleet::VisitPoses> visits;
  for (const SessionEstimate& estimate : newest_first_)
    visits.push_back(
        {captured_at_.at(estimate.session), fleet::Some(fleet::PosesOf(estimate), [&](const SensorId& sensor) {
           return !of_before_.contains({estimate.session, sensor});
         })});
  fleet::AddDriftRates(visits, newest_, found);
}

}  // namespace rigcal::drawn_fleet
