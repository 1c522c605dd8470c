#include "server/pipeline/sessions/as_found.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <set>

#include "server/fleet/as_found/as_found.h"
#include "server/fleet/findings/findings.h"
#include "server/graph/fusion/session_fusion.h"
#include "server/graph/fusion/visit_ages.h"
#include "server/graph/uncertainty/graph_jackknife.h"
#include "server/pipeline/rig_models/population.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/revision_poses.h"
#include "storage/revisions/revisions.h"

namespace rigcal::pipeline {
namespace {

using SessionSet = std::set<SessionId>;

struct InUse {
  Revision revision;  // without its document
  formats::RevisionInput told;
};

// The session and those of the same pictures.
SessionSet OfSamePictures(const SessionId& session, const CurrentEdges& current) {
  SessionSet same = {session};
  for (const auto& [superseded, superseding] : current.counts.superseded)
    if (superseding.by == session) same.insert(superseded);
  return same;
}

bool HasAnyOf(const formats::RevisionInput& told, const SessionSet& sessions) {
  const auto is_one = [&](const SessionId& session) { return sessions.contains(session); };
  return std::any_of(told.solution.fused.sessions.begin(), told.solution.fused.sessions.end(), is_one) ||
         std::any_of(told.edges.begin(), told.edges.end(), [&](const Edge& edge) { return is_one(edge.session); });
}

// The newest revision that was made before any edge of them was there.
Result<int> LoadLastBefore(storage::Store& store, const RevisionInTheMaking& revision, const SessionSet& sessions) {
  RIGCAL_ASSIGN(const auto first, storage::LoadFirstRevisions(store, revision.made.robot, revision.watermark,
                                                              {sessions.begin(), sessions.end()}));
  const auto earliest =
      std::min_element(first.begin(), first.end(), [](const auto& x, const auto& y) { return x.second < y.second; });
  return earliest == first.end() ? 0 : earliest->second - 1;
}

// When the revision was made; the end of time for one in the making.
Result<Stamp> LoadMadeAt(storage::Store& store, const RobotId& robot, int number) {
  RIGCAL_ASSIGN(const auto known, storage::LoadRevisionSummary(store, robot, number));
  return known ? known->created_at : Stamp{std::numeric_limits<std::int64_t>::max()};
}

Result<std::optional<InUse>> LoadInUse(storage::Store& store, const RevisionInTheMaking& revision,
                                       const SessionSet& sessions) {
  const RobotId& robot = revision.made.robot;
  RIGCAL_ASSIGN(int last, LoadLastBefore(store, revision, sessions));
  RIGCAL_ASSIGN(const Stamp came_at, LoadMadeAt(store, robot, last + 1));
  while (last > 0) {
    RIGCAL_ASSIGN(const auto usable, storage::LoadStillUsable(store, robot, last, came_at));
    if (!usable) break;
    RIGCAL_ASSIGN(auto loaded, storage::LoadRevision(store, robot, usable->number));
    if (!loaded) break;
    RIGCAL_ASSIGN(formats::RevisionInput told, formats::ReadRevisionDocument(loaded->document));
    loaded->document.clear();
    if (!HasAnyOf(told, sessions)) return InUse{std::move(*loaded), std::move(told)};
    last = usable->number - 1;
  }
  return std::nullopt;
}

// That sensors walked for, before the session, beyond those that the calibration in use is told for.
double MoreDaysWalked(const InUse& in_use, const RevisionInTheMaking& revision, const SessionId& session) {
  constexpr double kDay_ns = 86'400e9;
  const auto at = revision.captured_at.find(session);
  std::optional<Stamp> newest;
  for (const SessionId& one : in_use.told.solution.fused.sessions)
    if (const auto found = revision.captured_at.find(one); found != revision.captured_at.end())
      newest = newest ? std::max(*newest, found->second) : found->second;
  if (!newest || at == revision.captured_at.end()) return 0.0;
  const double days = static_cast<double>(at->second.ns - newest->ns) / kDay_ns;
  return std::min(days, graph::kWalkedDaysMax) - in_use.told.solution.fused.next_visit_days;
}

// On the day of the session, without sensors that are gone from the robot: nobody asks for these.
Result<fleet::KnownPoses> LoadPosesOf(storage::Store& store, const InUse& in_use, const RevisionInTheMaking& revision,
                                      const SessionId& session) {
  RIGCAL_ASSIGN(const auto joint, storage::LoadRevisionPoses(store, {in_use.told.robot, in_use.revision.number}));
  fleet::KnownPoses all = fleet::PosesOf(in_use.told.solution, in_use.told.reference,
                                         joint ? joint->covariances : std::vector<JointCovariance>());
  fleet::WalkOn(in_use.told.solution, MoreDaysWalked(in_use, revision, session), all);
  return fleet::Some(all,
                     [&](const SensorId& sensor) { return !revision.current.counts.retired_sensors.contains(sensor); });
}

// As of when the calibration in use has the pose of the sensor: the newest of the edges that it counts of it. Where
// none of these has a date of its own, as of when it has all of them.
std::optional<Stamp> PoseMeasuredAt(const SensorId& sensor, const InUse& in_use,
                                    const fleet::SessionTimes& captured_at) {
  std::optional<Stamp> newest;
  for (const Edge& edge : in_use.told.edges) {
    if (edge.state != EdgeState::kGood || (edge.frame_a != sensor && edge.frame_b != sensor)) continue;
    const auto session = captured_at.find(edge.session);
    const std::optional<Stamp> at = session == captured_at.end() ? edge.measured_at : std::optional(session->second);
    if (at && (!newest || *newest < *at)) newest = at;
  }
  return newest ? newest : in_use.revision.calibrated_at;
}

// Since the calibration in use has its pose, says the session or one between both, refined or not.
std::set<SensorId> MovedOnPurpose(const RevisionInTheMaking& revision, const SessionSet& sessions,
                                  const InUse& in_use) {
  const std::vector<SessionId>& known = in_use.told.solution.fused.sessions;
  std::set<SensorId> moved;
  for (const Epoch& epoch : revision.current.counts.epochs) {
    const bool is_known = std::find(known.begin(), known.end(), epoch.session) != known.end();
    const auto measured_at = PoseMeasuredAt(epoch.sensor, in_use, revision.captured_at);
    const bool by_hand = epoch.session.empty();  // what was measured at that very time is of before
    const bool is_later = measured_at && (by_hand ? *measured_at <= epoch.begins_at : *measured_at < epoch.begins_at);
    if (sessions.contains(epoch.session) || (is_later && !is_known)) moved.insert(epoch.sensor);
  }
  return moved;
}

// What still counts of sessions that are in the poses.
class Counted {
 public:
  explicit Counted(const RevisionInTheMaking& revision)
      : revision_(revision), counting_(SensorsThatCount(revision.current, revision.refined.within)) {}

  [[nodiscard]] bool Has(const SessionEstimate& estimate) const {
    const formats::RevisionInput& made = revision_.made;
    return graph::IsFused(estimate, {made.edges, revision_.refined.within, made.reference, made.solution});
  }
  [[nodiscard]] fleet::KnownPoses PosesOf(const SessionEstimate& estimate) const {
    return fleet::Some(fleet::PosesOf(estimate), [&](const SensorId& sensor) {
      return counting_.contains({estimate.session, sensor});
    });
  }
  [[nodiscard]] std::vector<fleet::VisitPoses> Visits() const {
    std::vector<fleet::VisitPoses> visits;
    for (const SessionEstimate& estimate : revision_.refined.estimates)
      if (const auto at = revision_.captured_at.find(estimate.session);
          at != revision_.captured_at.end() && Has(estimate))
        visits.push_back({at->second, PosesOf(estimate)});
    return visits;
  }

 private:
  const RevisionInTheMaking& revision_;
  SessionSensors counting_;
};

// Of the newest session what is refined and counts: an island, where that is all.
const SessionEstimate& NewestThatCounts(const RevisionInTheMaking& revision) {
  const std::vector<SessionEstimate>& estimates = revision.refined.estimates;
  const Counted counted(revision);
  for (const SessionEstimate& estimate : estimates)
    if (estimate.session == estimates.front().session && counted.Has(estimate)) return estimate;
  return estimates.front();
}

// By which the revision in the making is fused; it is of robots with its reference.
PooledScatter PooledFor(const InUse& in_use, const RevisionInTheMaking& revision) {
  return in_use.told.reference == revision.made.reference ? PooledScatterOf(revision.made.solution) : PooledScatter();
}

std::string WhyNoEstimate(const SessionEstimate& newest) {
  if (newest.why_not.empty()) return "An edge of it was retired, so that nothing of it counts.";
  return "It could not be refined as a whole: " + newest.why_not.front().what + ".";
}

// Of one session by its own pairs, told from the reference; no poses where it does not have that.
GraphSolution SolveAlone(const std::vector<Edge>& all, const SensorId& reference) {
  const std::vector<Edge> edges = graph::WithoutEdges(all, graph::WeakBesideBetter(all));
  const Graph graph = graph::GraphOf(edges, reference);
  if (graph.reference != reference) return {};
  GraphSolution solution = graph::Solve(graph);
  graph::ApplyJackknifeCovariance(graph, graph::JackknifeGraph(graph, solution, graph::BlocksOf(edges)), solution);
  return solution;
}

bool IsAnyInPart(const std::vector<Edge>& own, const InUse& in_use) {
  const std::vector<SensorPose>& poses = in_use.told.solution.poses;
  return std::any_of(own.begin(), own.end(), [](const Edge& edge) { return edge.uncertainty.rank < 6; }) ||
         std::any_of(poses.begin(), poses.end(), [](const SensorPose& pose) { return pose.measured_part.has_value(); });
}

// Sensors that the calibration in use or the session knows but for some directions: no refinement tells these.
std::vector<fleet::PartOfBoth> PartsOf(const SessionId& session, const RevisionInTheMaking& revision,
                                       const InUse& in_use) {
  std::vector<Edge> own;
  for (const std::vector<Edge>* edges : {&revision.made.edges, &revision.refined.within})
    std::copy_if(edges->begin(), edges->end(), std::back_inserter(own),
                 [&](const Edge& edge) { return edge.session == session && edge.state == EdgeState::kGood; });
  if (!IsAnyInPart(own, in_use)) return {};
  const GraphSolution alone = SolveAlone(own, in_use.told.reference);
  std::vector<fleet::PartOfBoth> parts;
  for (const SensorPose& pose : alone.poses) {
    if (pose.sensor == in_use.told.reference || revision.current.counts.retired_sensors.contains(pose.sensor)) continue;
    const auto was = fleet::PartOf(pose.sensor, in_use.told.solution, in_use.told.edges),
               is = fleet::PartOf(pose.sensor, alone, own);
    if (was && is && !(was->open.empty() && is->open.empty())) parts.push_back({*was, *is});
  }
  return parts;
}

struct Tested {
  AsFound found;
  std::string of_no_estimate = {};  // a sentence: why only what is known in part was tested
};

Result<Tested> TestInUse(storage::Store& store, const RevisionInTheMaking& revision, const SessionEstimate& newest,
                         const SessionSet& sessions) {
  Tested tested;
  AsFound& found = tested.found;
  RIGCAL_ASSIGN(const auto in_use, LoadInUse(store, revision, sessions));
  const Counted counted(revision);
  if (!in_use) {
    found.why_not = "No calibration was in use before it.";
    return tested;
  }
  std::vector<fleet::PartOfBoth> parts = PartsOf(newest.session, revision, *in_use);
  const bool has_estimate = counted.Has(newest);
  if (!has_estimate && parts.empty()) {
    found.why_not = WhyNoEstimate(newest);
  } else {
    if (!has_estimate) tested.of_no_estimate = WhyNoEstimate(newest);
    const fleet::KnownPoses session =
        has_estimate ? counted.PosesOf(newest) : fleet::KnownPoses{in_use->told.reference, {}, {}};
    const fleet::KnownPoses left = fleet::PosesOf(revision.made.solution, revision.made.reference);
    RIGCAL_ASSIGN(fleet::KnownPoses poses, LoadPosesOf(store, *in_use, revision, newest.session));
    found = fleet::TestAsFound({std::move(poses), session, left, MovedOnPurpose(revision, sessions, *in_use),
                                revision.policy.drift_false_alarm_ratio.value_or(kAsFoundAlpha),
                                LimitsOf(revision.policy, SensorId()).moved_min, PooledFor(*in_use, revision),
                                std::move(parts)});
    fleet::AddDriftRates(counted.Visits(), left, found);
  }
  found.in_use = in_use->revision.number, found.made_at = in_use->revision.created_at;
  return tested;
}

}  // namespace

Result<std::optional<AsFound>> FindAsFound(storage::Store& store, const RevisionInTheMaking& revision) {
  if (revision.refined.estimates.empty()) return std::nullopt;
  const SessionEstimate& newest = NewestThatCounts(revision);
  Tested tested;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(tested, TestInUse(store, revision, newest, OfSamePictures(newest.session, revision.current)));
    return {};
  }));
  AsFound& found = tested.found;
  found.session = newest.session;
  if (const auto at = revision.captured_at.find(newest.session); at != revision.captured_at.end())
    found.captured_at = at->second;
  fleet::MarkElsewhere(fleet::ToldElsewhere(revision.made.solution, revision.policy, newest.session), found);
  found.text = fleet::AsFoundText(found, revision.captured_at);
  if (!tested.of_no_estimate.empty()) found.text += " " + tested.of_no_estimate;
  return std::move(found);
}

}  // namespace rigcal::pipeline
