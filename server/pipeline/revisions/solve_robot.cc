#include "server/pipeline/revisions/solve_robot.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "server/base/digests/sha256.h"
#include "server/base/log.h"
#include "server/fleet/assess.h"
#include "server/fleet/causes/told_causes.h"
#include "server/fleet/findings/partial_poses.h"
#include "server/fleet/findings/verdict_keys.h"
#include "server/fleet/weak_edges.h"
#include "server/formats/documents.h"
#include "server/graph/fusion/merged_edge.h"
#include "server/graph/fusion/session_fusion.h"
#include "server/graph/insight/insight.h"
#include "server/graph/solve/solve.h"
#include "server/graph/solve/weak_edges.h"
#include "server/graph/uncertainty/graph_jackknife.h"
#include "server/graph/uncertainty/joint_poses.h"
#include "server/graph/uncertainty/placed_poses.h"
#include "server/model/edges/past.h"
#include "server/model/edges/weak_edge.h"
#include "server/pipeline/revisions/revise.h"
#include "server/pipeline/rig_models/population.h"
#include "server/pipeline/rig_models/rig_models.h"
#include "server/pipeline/robots/policies.h"
#include "server/pipeline/robots/robot_status.h"
#include "server/pipeline/sessions/as_found.h"
#include "server/pipeline/sessions/current_edges.h"
#include "server/pipeline/sessions/session_refinement.h"
#include "server/report/edges/edge_order.h"
#include "storage/edges/edges.h"
#include "storage/fleet/fleet_facts.h"
#include "storage/revisions/merged_edges.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/sessions.h"
#include "storage/sessions/standing.h"

namespace rigcal::pipeline {
namespace {

std::vector<RetiredSensor> GoneOf(const storage::WhatCounts& counts) {
  std::vector<RetiredSensor> gone;
  for (const auto& [sensor, standing] : counts.retired_sensors) gone.push_back({sensor, standing.word});
  return gone;
}

std::set<SensorId> SetOf(const std::vector<RetiredSensor>& gone) {
  std::set<SensorId> sensors;
  for (const RetiredSensor& one : gone) sensors.insert(one.sensor);
  return sensors;
}

std::vector<SensorId> SensorsOf(const std::vector<RetiredSensor>& gone) {
  std::vector<SensorId> sensors;
  for (const RetiredSensor& one : gone) sensors.push_back(one.sensor);
  return sensors;
}

// Nobody asks for those that are `gone`.
void AddSensorsWithoutGoodEdge(const std::vector<Edge>& edges, const std::vector<SensorId>& listed,
                               const std::vector<SensorId>& gone, Graph& graph) {
  std::set<SensorId> known(graph.sensors.begin(), graph.sensors.end());
  known.insert(gone.begin(), gone.end());
  for (const Edge& edge : edges)
    if (!AsksForNoSensor(edge))
      for (const SensorId& sensor : {edge.frame_a, edge.frame_b})
        if (known.insert(sensor).second) graph.sensors.push_back(sensor);
  for (const SensorId& sensor : listed)
    if (known.insert(sensor).second) graph.sensors.push_back(sensor);
  std::sort(graph.sensors.begin(), graph.sensors.end(), graph::SensorBefore);
}

struct JackknifedSolution {
  GraphSolution solution;
  graph::GraphJackknife jackknife;
  OtherPaths others;
};

// Plain optimum of all edges; sigmas and tests by the jackknife where blocks are there; beside it suspects, what each
// edge does to it, and how its loops close.
JackknifedSolution SolveWithJackknife(const RobotGraph& loaded, const std::vector<Edge>& counting) {
  JackknifedSolution solved{graph::Solve(loaded.graph), {}, {}};
  GraphSolution& solution = solved.solution;
  const graph::BlocksByEdge blocks = graph::BlocksOf(counting);
  solved.jackknife = graph::JackknifeGraph(loaded.graph, solution, blocks);
  graph::ApplyJackknifeCovariance(loaded.graph, solved.jackknife, solution);
  solution.suspects = graph::FindSuspects(loaded.graph, solution);
  solution.influences = graph::InfluenceOfEdges(loaded.graph, solution);
  solved.others = graph::OtherPathsOf(loaded.graph, solution);
  solution.cycles = graph::JudgeCycles(loaded.graph, blocks);
  return solved;
}

constexpr const char* kWaitForPairs = "Wait until they are calibrated: the next revision is judged.";

// Half of a session's pairs tell nothing of what the others will contradict.
Verdict NotJudged(std::int64_t pairs_waiting) {
  return {VerdictLevel::kUnknown,
          pairs_waiting == 1 ? "One pair of sensors is still to be calibrated, so this result is not judged."
                             : std::to_string(pairs_waiting) +
                                   " pairs of sensors are still to be calibrated, so this result is not judged.",
          kWaitForPairs};
}

// The worst fit of those that other edges check; failed ones have no fit.
std::optional<WorstEdge> WorstEdgeOf(const formats::RevisionInput& revision) {
  if (revision.solution.dof <= 0) return std::nullopt;
  for (const report::ShownEdge& shown : report::InOrder(revision))
    if (shown.edge->state == EdgeState::kGood && shown.residual != nullptr)
      return WorstEdge{shown.edge->frame_a, shown.edge->frame_b, shown.in_sigmas};
  return std::nullopt;
}

// What of a robot counts, before it is a graph.
struct RobotEdges {
  CurrentEdges current;
  std::map<EdgeId, Stamp> measured_at;
  CurrentEstimates refined;
  fleet::SessionTimes captured_at;
  fleet::SessionHeaders headers;   // of sessions with an edge that is not past
  std::set<SessionId> unfinished;  // pairs of it are still to be calibrated
  std::vector<SensorId> listed;    // by its sessions
  std::vector<RetiredSensor> gone;
  SensorId reference;
  std::int64_t watermark = 0, standing_watermark = 0;
  PolicyInForce policy;
  ExpectedRig expected;          // of its rig model
  PooledScatter pooled_scatter;  // of the other robots of its rig model
};

// When each edge was measured, merged ones too, by the newest that is in them.
std::map<EdgeId, Stamp> MeasuredAt(const RobotEdges& loaded, const RobotId& robot) {
  std::map<EdgeId, Stamp> measured_at = loaded.measured_at;
  for (const MergedEdge& one : loaded.current.merged)
    measured_at.emplace(graph::EdgeOf(one, robot, false).id, one.newest);
  return measured_at;
}

// What ties sensors: edges that take part, and sessions that were refined as a whole. `edges`: with merged ones.
std::vector<DatedTie> TiesOf(const RobotEdges& loaded, const RobotId& robot, const std::vector<Edge>& edges,
                             const std::set<EdgeId>& weak) {
  const std::map<EdgeId, Stamp> measured_at = MeasuredAt(loaded, robot);
  std::vector<DatedTie> ties;
  for (const Edge& edge : edges)
    if (const auto at = measured_at.find(edge.id);
        edge.state == EdgeState::kGood && !weak.contains(edge.id) && at != measured_at.end())
      ties.push_back({edge.frame_a, edge.frame_b, at->second});
  for (const SessionEstimate& estimate : loaded.refined.estimates)
    if (const auto at = loaded.captured_at.find(estimate.session); at != loaded.captured_at.end())
      for (const RefinedPose& pose : estimate.poses)
        if (pose.sensor != estimate.reference) ties.push_back({estimate.reference, pose.sensor, at->second});
  return ties;
}

std::set<SensorId> SensorsOf(const GraphSolution& solution) {
  std::set<SensorId> sensors;
  for (const SensorPose& pose : solution.poses) sensors.insert(pose.sensor);
  return sensors;
}

static_assert(kDefaultVisitsInFull == graph::kEdgesKeptOfPair && kDefaultVisitsInFull == graph::kSessionsKept);
static_assert(kVisitsInFullMax == kSessionsFused);

std::int64_t VisitsInFull(const Policy& policy) { return policy.visits_in_full.value_or(kDefaultVisitsInFull); }

Status LoadForGraph(storage::Store& store, const RobotId& robot, storage::EdgeParts parts, bool merge_anew,
                    RobotEdges& loaded) {
  RIGCAL_ASSIGN(loaded.watermark, storage::LoadEdgeWatermark(store, robot));
  RIGCAL_ASSIGN(loaded.standing_watermark, storage::LoadStandingWatermark(store, robot));
  RIGCAL_ASSIGN(loaded.current, LoadCurrentEdges(store, robot, parts, merge_anew));
  RIGCAL_ASSIGN(loaded.listed, storage::LoadListedSensors(store, robot));
  loaded.gone = GoneOf(loaded.current.counts);
  RIGCAL_ASSIGN(loaded.reference, storage::LoadNamedReference(store, robot, SensorsOf(loaded.gone)));
  return {};
}

Status LoadHeaders(storage::Store& store, const std::vector<Edge>& edges, fleet::SessionHeaders& headers) {
  std::set<SessionId> sessions;
  for (const Edge& edge : edges)
    if (!edge.session.empty() && !IsPast(edge)) sessions.insert(edge.session);
  for (const SessionId& session : sessions) {
    RIGCAL_ASSIGN(auto manifest, storage::LoadManifest(store, session));
    if (manifest) headers.emplace(session, std::move(manifest->header));
  }
  return {};
}

Result<RobotEdges> LoadForRevision(storage::Store& store, const RobotId& robot, const SolveOptions& options) {
  RobotEdges loaded;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(loaded.policy, LoadPolicyInForce(store, {PolicyScope::kRobot, robot.str()}));
    RIGCAL_ASSIGN(const bool waits, storage::IsToMergeAnew(store, robot, VisitsInFull(loaded.policy.policy)));
    RIGCAL_TRY(LoadForGraph(store, robot, storage::EdgeParts::kAll, waits && options.merges_anew, loaded));
    RIGCAL_ASSIGN(loaded.measured_at, storage::LoadMeasuredAt(store, loaded.current.edges));
    RIGCAL_ASSIGN(loaded.refined, LoadCurrentEstimates(store, robot, loaded.current, options.run));
    RIGCAL_ASSIGN(loaded.captured_at, storage::LoadCapturedAt(store, robot));
    RIGCAL_TRY(LoadHeaders(store, loaded.current.edges, loaded.headers));
    RIGCAL_ASSIGN(const auto open, storage::LoadOpenSessions(store, robot));
    for (const storage::SessionRow& session : open) loaded.unfinished.insert(session.id);
    RIGCAL_ASSIGN(loaded.expected, LoadExpectedRig(store, loaded.policy.rig_model));
    loaded.policy.rig_model_version = loaded.expected.version;
    RIGCAL_ASSIGN(loaded.pooled_scatter, LoadPooledScatter(store, robot, loaded.policy.rig_model, loaded.reference));
    return {};
  }));
  RIGCAL_TRY(TakeFocals(store, loaded.current.edges, loaded.headers, loaded.captured_at, loaded.policy.policy));
  return loaded;
}

RobotGraph GraphOf(const RobotEdges& loaded, const RobotId& robot, bool blocks) {
  RobotGraph result{loaded.current.edges, {}, {}, loaded.watermark, loaded.standing_watermark};
  for (const MergedEdge& merged : loaded.current.merged) result.edges.push_back(graph::EdgeOf(merged, robot, blocks));
  std::sort(result.edges.begin(), result.edges.end(), [](const Edge& x, const Edge& y) { return x.id < y.id; });
  result.weak = graph::WeakBesideBetter(result.edges, MeasuredAt(loaded, robot));
  result.graph = graph::GraphOf(graph::WithoutEdges(result.edges, result.weak), loaded.reference);
  if (!loaded.reference.empty()) result.graph.reference = loaded.reference;
  AddSensorsWithoutGoodEdge(result.edges, loaded.listed, SensorsOf(loaded.gone), result.graph);
  return result;
}

std::vector<EdgeId> IdsOf(const std::vector<MergedEdge>& merged, const RobotId& robot) {
  std::vector<EdgeId> ids;
  for (const MergedEdge& one : merged) ids.push_back(graph::EdgeOf(one, robot, false).id);
  return ids;
}

void Append(graph::Merge merge, storage::MergeStep& step) {
  std::move(merge.merged.begin(), merge.merged.end(), std::back_inserter(step.merged));
  std::move(merge.taken.begin(), merge.taken.end(), std::back_inserter(step.taken));
}

std::vector<EdgeId> IdsOf(const std::vector<Edge>& edges) {
  std::vector<EdgeId> ids;
  for (const Edge& edge : edges) ids.push_back(edge.id);
  return ids;
}

// Of sessions that may be merged: where pairs are still to come, or wait for a file that the disk lost, these share its
// captures.
std::vector<Edge> OfWholeSessions(const RobotEdges& loaded) {
  std::set<SessionId> unfinished = loaded.unfinished;
  std::set<EdgeId> ids;
  for (const Edge& edge : loaded.current.edges) ids.insert(edge.id);
  for (const Edge& edge : loaded.current.edges)
    if (FailedForLostFile(edge) && !ids.contains(RepeatedEdgeId(edge.id))) unfinished.insert(edge.session);
  std::vector<Edge> whole = loaded.current.edges;
  std::erase_if(whole, [&](const Edge& edge) { return edge.session.empty() || unfinished.contains(edge.session); });
  return whole;
}

// Edges leave the window for merged ones.
storage::MergeStep MergeOlder(const RobotId& robot, RobotEdges& loaded) {
  CurrentEdges& current = loaded.current;
  storage::MergeStep step;
  step.anew = current.all;
  step.visits_in_full = VisitsInFull(loaded.policy.policy);
  const auto kept = static_cast<std::size_t>(step.visits_in_full);
  if (step.anew) step.back = IdsOf(current.edges);
  Append(graph::MergeOlderEdges(current.merged, current.edges, loaded.measured_at, kept), step);
  Append(graph::MergeOlderSessions(current.merged, OfWholeSessions(loaded), loaded.measured_at, kept), step);
  const std::set<EdgeId> taken(step.taken.begin(), step.taken.end());
  for (const Edge& edge : current.edges)
    if (taken.contains(edge.id) && WhyWeak(edge).empty()) loaded.refined.within.push_back(edge);
  std::erase_if(current.edges, [&](const Edge& edge) { return taken.contains(edge.id); });
  current.merged = step.merged;
  step.ids = IdsOf(step.merged, robot);
  return step;
}

std::vector<SensorPair> PairsNamedBy(const Policy& policy) {
  std::vector<SensorPair> pairs;
  for (const auto& [pair, words] : policy.pairs) pairs.push_back(pair);
  return pairs;
}

// What is told of the graph and judged; what is kept of its poses goes into `kept`, and since when it holds.
formats::RevisionInput SolveAndJudge(const RobotId& robot, const RobotEdges& edges, std::int64_t pairs_waiting,
                                     SolvedRobot& kept, OtherPaths& others) {
  RobotGraph loaded = GraphOf(edges, robot, true);
  formats::RevisionInput input;
  input.robot = robot;
  input.reference = loaded.graph.reference;
  input.retired = edges.gone;
  const std::vector<Edge> counting = graph::WithoutEdges(loaded.edges, loaded.weak);
  JackknifedSolution solved = SolveWithJackknife(loaded, counting);
  input.solution = std::move(solved.solution);
  input.solution.R_ref_robot = fleet::RobotAxes(input.reference, edges.headers);
  graph::FuseSessions(counting, edges.refined.within, input.reference, edges.refined.estimates, input.solution,
                      edges.pooled_scatter, {edges.captured_at, MeasuredAt(edges, robot)});
  kept.poses = graph::JointPosesOf(loaded.graph, input.solution, solved.jackknife);
  kept.placed = graph::PlacedPosesOf(loaded.graph, input.solution, solved.jackknife);
  const auto weak = fleet::NotesOnWeakEdges(loaded.edges, loaded.weak, input.solution);
  input.solution.diagnoses.insert(input.solution.diagnoses.end(), weak.begin(), weak.end());
  const fleet::KnownBetween between{graph::CovariancesOfPairs(PairsNamedBy(edges.policy.policy), kept.poses,
                                                              loaded.graph, input.solution, solved.jackknife),
                                    std::move(solved.others)};
  fleet::Judgement judged = pairs_waiting > 0 ? fleet::Judgement{NotJudged(pairs_waiting), {}}
                                              : fleet::Judge(counting, input.solution, edges.policy.policy,
                                                             edges.captured_at, edges.refined.estimates, edges.headers,
                                                             between, edges.expected, SetOf(edges.gone));
  others = between.others;
  input.verdict = std::move(judged.verdict);
  input.basis = std::move(judged.basis);
  input.policy = edges.policy;
  kept.revision.calibrated_at =
      MeasuredThroughout(TiesOf(edges, robot, loaded.edges, loaded.weak), SensorsOf(input.solution));
  input.edges = std::move(loaded.edges);
  return input;
}

// What failed pairs have in common goes into the revision; its keys and those of the verdict, by which robots are
// counted, come back.
std::vector<std::string> TakeCauses(const RobotEdges& loaded, const OtherPaths& others, formats::RevisionInput& input) {
  const std::vector<Edge> counting = fleet::WithoutWeakAside(input.edges, input.solution);
  const auto causes = fleet::FindRootCauses(counting, input.solution, loaded.headers, loaded.captured_at,
                                            loaded.expected, SetOf(loaded.gone));
  input.causes = fleet::ToldCauses(causes);
  std::vector<std::string> keys = fleet::CauseKeysOf(causes, counting, loaded.captured_at);
  const auto told = fleet::KeysOfVerdict(input.verdict, counting, input.solution, loaded.policy.policy,
                                         loaded.refined.estimates, keys, others);
  keys.insert(keys.end(), told.begin(), told.end());
  return keys;
}

// The revision is made without it where what was in use cannot be read any more.
std::optional<AsFound> TakeAsFound(storage::Store& store, const RobotEdges& loaded,
                                   const formats::RevisionInput& made) {
  const auto found = FindAsFound(
      store, {loaded.current, loaded.refined, loaded.captured_at, loaded.watermark, made, loaded.policy.policy});
  if (!found) LogError(found.error());
  return found.value_or(std::nullopt);
}

// The revision is made without its status where what that is learnt from cannot be read.
JudgedBeside TakeBeside(storage::Store& store, const RobotEdges& loaded, const OtherPaths& others,
                        const Revision& revision, formats::RevisionInput& input) {
  JudgedBeside beside;
  beside.cause_keys = TakeCauses(loaded, others, input);
  beside.as_found = TakeAsFound(store, loaded, input);
  auto status = FindStatus(
      store, {input, loaded.policy, beside.as_found, revision.calibrated_at, revision.max_age_ns, loaded.headers});
  if (!status) LogError(status.error());
  if (status) beside.status = std::move(*status);
  return beside;
}

}  // namespace

Result<RobotGraph> LoadRobotGraph(storage::Store& store, const RobotId& robot) {
  RobotEdges loaded;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_TRY(LoadForGraph(store, robot, storage::EdgeParts::kRow, false, loaded));
    if (HasWeak(loaded.current)) {
      RIGCAL_ASSIGN(loaded.measured_at, storage::LoadMeasuredAt(store, loaded.current.edges));
    }
    return {};
  }));
  return GraphOf(loaded, robot, false);
}

bool IsJudged(const Revision& revision) { return revision.verdict.what_to_do != kWaitForPairs; }

Result<SolvedRobot> SolveRobot(storage::Store& store, const RobotId& robot, const Clock& clock,
                               const SolveOptions& options) {
  const std::int64_t pairs_waiting = options.pairs_waiting;
  SolvedRobot solved;
  Revision& revision = solved.revision;
  revision.robot = robot;
  revision.created_at = clock.Now();  // what is stored after it may be missing from the revision
  RIGCAL_ASSIGN(RobotEdges loaded, LoadForRevision(store, robot, options));
  solved.merge = MergeOlder(robot, loaded);
  OtherPaths others;
  solved.input = SolveAndJudge(robot, loaded, pairs_waiting, solved, others);
  revision.max_age_ns = loaded.policy.policy.max_age_ns.value_or(kDefaultMaxAge_ns);
  if (pairs_waiting == 0) solved.beside = TakeBeside(store, loaded, others, revision, solved.input);
  solved.worst = WorstEdgeOf(solved.input);
  revision.verdict = solved.input.verdict;
  revision.document = formats::WriteRevisionDocument(solved.input);
  revision.digest = Sha256Of(revision.document);
  revision.edge_watermark = loaded.watermark;
  revision.standing_watermark = loaded.standing_watermark;
  if (pairs_waiting == 0) {  // else it is still to be judged
    revision.policy_watermark = loaded.policy.watermark;
    revision.rig_model_watermark = loaded.expected.watermark;
  }
  solved.counts = std::move(loaded.current.counts);
  solved.captured_at = std::move(loaded.captured_at);
  solved.rig_model = loaded.policy.rig_model;
  return solved;
}

}  // namespace rigcal::pipeline
