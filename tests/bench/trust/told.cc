#include "tests/bench/trust/told.h"

#include <algorithm>
#include <set>

#include "server/calib/joint/estimate_session.h"
#include "server/fleet/assess.h"
#include "server/graph/fusion/session_fusion.h"
#include "server/graph/insight/insight.h"
#include "server/graph/solve/weak_edges.h"
#include "server/graph/uncertainty/graph_jackknife.h"
#include "tests/bench/rig/joint_session.h"

namespace rigcal {
namespace {

// Sensors of which no edge came about are unknown, not absent.
Graph WholeGraph(const std::vector<Edge>& edges, const SessionHeader& header) {
  Graph graph = graph::GraphOf(edges, header.reference);
  graph.reference = header.reference;
  for (const Sensor& sensor : header.sensors)
    if (std::find(graph.sensors.begin(), graph.sensors.end(), sensor.id) == graph.sensors.end())
      graph.sensors.push_back(sensor.id);
  std::sort(graph.sensors.begin(), graph.sensors.end());
  return graph;
}

// As a revision is made (server/pipeline/revisions/revise.cc).
GraphSolution Solved(const Graph& graph, const std::vector<Edge>& edges) {
  GraphSolution solution = graph::Solve(graph);
  const graph::BlocksByEdge blocks = graph::BlocksOf(edges);
  graph::ApplyJackknifeCovariance(graph, graph::JackknifeGraph(graph, solution, blocks), solution);
  solution.suspects = graph::FindSuspects(graph, solution);
  solution.cycles = graph::JudgeCycles(graph, blocks);
  return solution;
}

std::vector<Said> SaidOf(const Verdict& verdict, const std::vector<Edge>& edges) {
  std::vector<Said> said = {{"", verdict.why + " " + verdict.what_to_do, {}}};
  for (const Edge& edge : edges) {
    for (const Diagnosis& diagnosis : edge.diagnoses)
      said.push_back({diagnosis.code, diagnosis.what + " " + diagnosis.cure, {edge.frame_a, edge.frame_b}});
  }
  return said;
}

// As a session is refined (server/pipeline/sessions/session_refinement.cc).
SessionEstimate Refined(const FeatureSession& visit, const std::vector<Edge>& all) {
  const std::vector<Edge> edges = graph::WithoutEdges(all, graph::WeakBesideBetter(all));
  std::map<SensorId, Se3> T_ref_sensor;
  for (const SensorPose& pose : graph::Solve(graph::GraphOf(edges, visit.header.reference)).poses)
    if (pose.known) T_ref_sensor[pose.sensor] = pose.T_ref_sensor;
  calib::joint::SessionViews views = ViewsOf(visit, std::move(T_ref_sensor));
  views.boards_stand_still = false;
  for (const Edge& edge : edges) {
    if (edge.state != EdgeState::kGood) continue;
    views.boards_stand_still |= edge.method == "non_overlapping" || edge.method == "tracker_camera";
    if (edge.method == "lidar_lidar")
      views.relatives.push_back({edge.frame_a, edge.frame_b, edge.T_a_b, edge.uncertainty.Omega, edge.uncertainty.dof});
  }
  SessionEstimate estimate = calib::joint::EstimateSession(views);
  if (!edges.empty()) estimate.session = edges.front().session;
  return estimate;
}

}  // namespace

Told Judge(const std::vector<FeatureSession>& visits) {
  std::vector<Edge> edges;
  std::vector<SessionEstimate> estimates;
  fleet::SessionHeaders headers;
  fleet::SessionTimes captured_at;  // a visit a week
  for (const FeatureSession& visit : visits) {
    const std::vector<Edge> of_visit = EdgesOf(visit);
    if (!of_visit.empty()) headers.emplace(of_visit.front().session, visit.header);
    estimates.insert(estimates.begin(), Refined(visit, of_visit));
    captured_at[estimates.front().session] = {static_cast<std::int64_t>(captured_at.size()) * 7 * 86'400'000'000'000};
    edges.insert(edges.end(), of_visit.begin(), of_visit.end());
  }
  const SessionHeader& header = visits.front().header;
  const std::set<EdgeId> weak = graph::WeakBesideBetter(edges);
  edges = graph::WithoutEdges(std::move(edges), weak);
  GraphSolution solution = Solved(WholeGraph(edges, header), edges);
  graph::FuseSessions(edges, {}, header.reference, estimates, solution, {}, {captured_at, {}});
  Told told{
      header.reference, solution.poses, fleet::Assess(edges, solution, {}, {}, estimates, headers), {}, 0, {}, {}};
  told.clocks = estimates.front().clocks;
  if (!estimates.front().why_not.empty()) told.not_refined = estimates.front().why_not.front().what;
  told.said = SaidOf(told.verdict, edges);
  for (const FusedSessions::HeldBack& look : solution.fused.held_back)  // as the report has it
    if (look.why == WhyHeldBack::kContradicts)
      told.said.push_back({"held_back",
                           look.sensor.str() + " in capture " + look.capture.str() +
                               (look.against.empty() ? "" : " contradicts " + look.against.str()),
                           {look.sensor}});
  told.failed_edges = static_cast<int>(
      std::count_if(edges.begin(), edges.end(), [](const Edge& edge) { return edge.state != EdgeState::kGood; }));
  return told;
}

Told Judge(const FeatureSession& session) { return Judge(std::vector<FeatureSession>{session}); }

}  // namespace rigcal
