#include "server/pipeline/robots/summaries.h"

#include <algorithm>
#include <map>

#include "server/base/log.h"
#include "server/pipeline/attempt.h"
#include "server/pipeline/robots/decide.h"
#include "server/pipeline/robots/unknown_names.h"
#include "server/pipeline/robots/validity.h"
#include "storage/alerts/revision_status.h"
#include "storage/edges/edges.h"
#include "storage/fleet/calibration_series.h"
#include "storage/fleet/fleet_facts.h"
#include "storage/fleet/robot_status.h"
#include "storage/fleet/robot_summary.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/revisions.h"
#include "storage/settings/policies.h"
#include "storage/work/jobs.h"

namespace rigcal::pipeline {
namespace {

// Of a robot without a revision.
Verdict FirstVerdict(const RobotSummary& summary, const std::optional<Error>& incomplete) {
  const char* wait = "Wait: the result appears by itself.";
  if (!summary.validity.given_up.empty()) return {VerdictLevel::kUnknown, summary.validity.given_up, ""};
  if (summary.jobs_waiting > 0) return {VerdictLevel::kUnknown, "The first session is being calibrated.", wait};
  if (summary.edges > 0) return {VerdictLevel::kUnknown, "The first result is being worked out.", wait};
  if (summary.last_session_at)
    return {VerdictLevel::kUnknown, "No session of it has two sensors that can be calibrated against each other.",
            "Name at least two sensors in session.yaml that see one target, or that move together, and push it again."};
  if (summary.sessions > 0)
    return {VerdictLevel::kUnknown, "The first session is arriving, or its push broke off.",
            "Wait a moment; if nothing changes, push it again: what is here already is not sent twice."};
  if (incomplete)
    return {VerdictLevel::kUnknown, "There is no revision yet: " + incomplete->what + ".", incomplete->cure};
  return {VerdictLevel::kUnknown, "There is no revision yet.", "Push a capture session or finished edges."};
}

Status TakeArrivals(storage::Store& store, RobotSummary& summary) {
  RIGCAL_TRY(LoadWhatIsNew(store, summary.robot, summary.validity));
  RIGCAL_ASSIGN(const auto incomplete, IncompleteBatch(store, summary.robot));
  summary.verdict = FirstVerdict(summary, incomplete);
  return {};
}

// Nothing of one that waited for pairs, or from before it was kept.
Status TakeStatus(storage::Store& store, const Revision& revision, RobotSummary& summary) {
  RIGCAL_ASSIGN(auto facts, storage::LoadRevisionStatus(store, {revision.robot, revision.number}));
  if (!facts) return {};
  summary.found = FoundOf(*facts);
  summary.drift_due = DriftDueOf(*facts);
  summary.site = std::move(facts->site);
  summary.sensors = std::move(facts->sensors);
  summary.basis = std::move(facts->basis);
  return {};
}

// By when a robot is due is told of what it has: where that is not the newest revision, all dates are of that one.
Status TakeDatesInUse(storage::Store& store, Stamp now, RobotSummary& summary) {
  Validity& validity = summary.validity;
  const auto& usable = validity.usable;
  if (!usable || usable->number == summary.revision) return {};
  validity.calibrated_at = usable->calibrated_at;
  validity.max_age_ns = usable->max_age_ns;
  validity.overdue = IsOverdue(validity.calibrated_at, validity.max_age_ns, now);
  RIGCAL_ASSIGN(const auto loaded, storage::LoadRevisionStatus(store, {summary.robot, usable->number}));
  const StatusFacts in_use = loaded.value_or(StatusFacts{});
  summary.drift_due = DriftDueOf(in_use);
  for (SensorStatus& sensor : summary.sensors) {
    const auto one = std::find_if(in_use.sensors.begin(), in_use.sensors.end(),
                                  [&](const SensorStatus& other) { return other.sensor == sensor.sensor; });
    sensor.due = one == in_use.sensors.end() ? std::nullopt : one->due;
  }
  return {};
}

Status TakeNewestVisit(storage::Store& store, RobotSummary& summary) {
  RIGCAL_ASSIGN(auto newest, storage::LoadNewestCapture(store, summary.robot));
  if (newest) summary.last_session_at = newest->at;
  if (newest) summary.operator_name = std::move(newest->operator_name);
  RIGCAL_ASSIGN(summary.rig_model, storage::LoadRigModel(store, summary.robot));
  return {};
}

Status TakeCalibrations(storage::Store& store, RobotSummary& summary) {
  RIGCAL_ASSIGN(summary.calibrations, storage::LoadCalibrations(store, summary.robot));
  return {};
}

Status TakeRevision(storage::Store& store, const Revision& revision, Stamp now, RobotSummary& summary) {
  summary.revision = revision.number;
  summary.verdict = revision.verdict;
  RIGCAL_ASSIGN(summary.validity, LoadValidity(store, revision, now));
  RIGCAL_ASSIGN(summary.state, storage::LoadRevisionState(store, revision, summary.validity.usable));
  RIGCAL_ASSIGN(summary.worst, storage::LoadWorstEdge(store, {revision.robot, revision.number}));
  RIGCAL_ASSIGN(summary.causes, storage::LoadCauseKeys(store, {revision.robot, revision.number}));
  RIGCAL_TRY(TakeStatus(store, revision, summary));
  RIGCAL_TRY(TakeDatesInUse(store, now, summary));
  if (summary.validity.calibrated_at) RIGCAL_TRY(TakeCalibrations(store, summary));
  if (!summary.validity.calculating) return {};
  // What arrived since is told once it is in a revision: one page shows the numbers of one revision.
  RIGCAL_ASSIGN(summary.edges, storage::CountEdges(store, revision.robot, revision.edge_watermark));
  return {};
}

constexpr int kFreshenedMax = 64, kAtOnceMax = 1024;

struct MadeSummary {
  RobotSummary summary;
  std::int64_t changes = 0;  // of the robot until it was made
};

// A robot of which something that is stored cannot be read keeps no other waiting.
Result<RobotSummary> SummaryOrWhyNot(storage::Store& store, const RobotId& robot, Stamp now) {
  auto summary = LoadRobotSummary(store, robot, now);
  if (summary || IsOurFault(summary.error())) return summary;
  const Error& error = summary.error();
  RobotSummary unreadable;
  unreadable.robot = robot;
  unreadable.verdict = {VerdictLevel::kUnknown, "What is stored of it cannot be read: " + error.what + ".", error.cure};
  return unreadable;
}

struct UnmadeSummary {
  RobotId robot;
  Error error;
};

struct WaitingMade {
  std::vector<MadeSummary> made;
  std::vector<UnmadeSummary> unmade;
  RobotId last;       // of those that were taken up
  bool full = false;  // there may be more
};

// What is damaged of one robot is no other's matter; where the store is held, it is held for all.
Result<WaitingMade> MakeWaiting(storage::Store& store, Stamp now, int max, const RobotId& after) {
  WaitingMade done;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(const auto waiting, storage::LoadWaitingSummaries(store, max, after));
    done.full = static_cast<int>(waiting.size()) == max;
    for (const storage::WaitingSummary& one : waiting) {
      auto summary = SummaryOrWhyNot(store, one.robot, now);
      done.last = one.robot;
      if (summary)
        done.made.push_back({std::move(*summary), one.changes});
      else if (summary.error().code == ErrorCode::kBusy)
        return Fail(summary.error());
      else
        done.unmade.push_back({one.robot, summary.error()});
    }
    return {};
  }));
  return done;
}

void TakeTurn(const WaitingMade& done, SummaryTurn& turn) {
  turn.after = done.last;
  for (const MadeSummary& one : done.made) turn.unmade.erase(one.summary.robot);
  for (const auto& [robot, error] : done.unmade)
    if (turn.unmade.insert(robot).second)
      LogError({error.code, "lists do not show what is new of robot " + robot.str() + ": " + error.what, error.cure});
}

// What that changes of a robot's status is told in the same transaction.
Status Keep(storage::Store& store, const std::vector<MadeSummary>& made, Stamp now) {
  for (const MadeSummary& one : made) {
    RIGCAL_TRY(storage::ReplaceSummary(store, one.summary, one.changes));
    RIGCAL_TRY(storage::NoteStatus(store, one.summary.robot, now));
  }
  return {};
}

// Absent: all.
Result<std::optional<std::int64_t>> LimitOf(const formats::Parameters& parameters) {
  constexpr std::int64_t kLimitMax = 1'000'000'000;
  if (!parameters.Text("limit")) return std::nullopt;
  RIGCAL_ASSIGN(const std::int64_t limit, parameters.IntegerOr("limit", 0));
  if (limit >= 1) return std::min(limit, kLimitMax);
  return Fail(ErrorCode::kInvalidInput, "the parameter 'limit' is less than 1", "Give the number of robots to list.");
}

Result<RobotId> AfterOf(const formats::Parameters& parameters) {
  const auto after = parameters.Text("after");
  return after ? RobotId::Parse(*after) : RobotId();
}

// In the place of those of the same robots, or where these would stand, of robots beyond `after`; then at most `max`.
void PutIn(std::vector<RobotSummary> newer, const RobotId& after, std::optional<std::int64_t> max,
           std::vector<RobotSummary>& rows) {
  std::erase_if(newer, [&](const RobotSummary& one) { return !(after < one.robot); });
  if (newer.empty()) return;
  std::map<RobotId, RobotSummary> by_id;
  for (std::vector<RobotSummary>* part : {&newer, &rows})
    for (RobotSummary& one : *part) by_id.try_emplace(one.robot, std::move(one));
  rows.clear();
  for (auto& [robot, summary] : by_id)
    if (!max || static_cast<std::int64_t>(rows.size()) < *max) rows.push_back(std::move(summary));
}

}  // namespace

Result<storage::RobotRow> LoadKnownRobot(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto known, storage::LoadRobot(store, robot));
  if (known) return *known;
  return Fail(UnknownRobot(store, robot));
}

Result<RobotSummary> LoadRobotSummary(storage::Store& store, const RobotId& robot, Stamp now) {
  RIGCAL_ASSIGN(const storage::RobotRow row, LoadKnownRobot(store, robot));
  RobotSummary summary;
  summary.robot = robot;
  summary.sessions = row.sessions;
  summary.edges = row.edges;
  RIGCAL_ASSIGN(summary.jobs_waiting, storage::CountJobs(store, robot));
  RIGCAL_TRY(TakeNewestVisit(store, summary));
  RIGCAL_ASSIGN(summary.runs, LoadWhatRuns(store, robot));
  if (summary.runs) summary.runs->digest = {};  // it is told of one robot that is asked for alone
  RIGCAL_ASSIGN(const auto revision, storage::LoadRevisionSummary(store, robot, 0));
  RIGCAL_TRY(revision ? TakeRevision(store, *revision, now, summary) : TakeArrivals(store, summary));
  return summary;
}

Result<std::optional<Error>> IncompleteBatch(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto batches, storage::LoadOpenBatches(store, robot));
  if (batches.empty()) return std::nullopt;
  const storage::OpenBatch& batch = batches.front();
  return Error{ErrorCode::kNotFound,
               "a batch of " + std::to_string(batch.items) + " edges is incomplete: " + std::to_string(batch.held) +
                   " of " + std::to_string(batch.items) + " since " + ToIso(batch.newest_at),
               "Push the same edges again: that completes it, and nothing is stored twice."};
}

Result<RefreshedSummaries> RefreshSummaries(storage::Store& store, const Clock& clock, int max, SummaryTurn& turn) {
  RIGCAL_ASSIGN(const WaitingMade done, MakeWaiting(store, clock.Now(), max, turn.after));
  TakeTurn(done, turn);
  if (!done.made.empty()) RIGCAL_TRY(store.Write([&] { return Keep(store, done.made, clock.Now()); }));
  return RefreshedSummaries{static_cast<int>(done.made.size()), done.full && !done.made.empty()};
}

Status RefreshSummary(storage::Store& store, const Clock& clock, const RobotId& robot) {
  std::vector<MadeSummary> made;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(const auto waiting, storage::LoadWaitingSummary(store, robot));
    if (!waiting) return {};
    RIGCAL_ASSIGN(auto summary, LoadRobotSummary(store, robot, clock.Now()));
    made.push_back({std::move(summary), waiting->changes});
    return {};
  }));
  return made.empty() ? Status{} : store.Write([&] { return Keep(store, made, clock.Now()); });
}

void RefreshAllSummaries(storage::Store& store, const Clock& clock) {
  SummaryTurn turn;
  Result<RefreshedSummaries> refreshed = RefreshedSummaries{0, true};
  int all = 0;
  for (; refreshed && refreshed->more; all += refreshed ? refreshed->made : 0)
    refreshed = RefreshSummaries(store, clock, kAtOnceMax, turn);
  if (!refreshed) LogError(refreshed.error());
  if (all > 0) LogInfo("the summaries of " + std::to_string(all) + " robots were worked out");
}

std::vector<RobotSummary> FreshenSummaries(storage::Store& store, const Clock& clock) {
  auto done = MakeWaiting(store, clock.Now(), kFreshenedMax, RobotId());
  std::vector<RobotSummary> not_kept;
  if (!done || done->made.empty() || store.WriteSoon([&] { return Keep(store, done->made, clock.Now()); }))
    return not_kept;
  for (MadeSummary& one : done->made) not_kept.push_back(std::move(one.summary));  // the next one keeps them
  return not_kept;
}

Result<RobotList> LoadRobotList(storage::Store& store, const Clock& clock, const formats::Parameters& parameters) {
  RIGCAL_ASSIGN(const std::optional<std::int64_t> limit, LimitOf(parameters));
  RIGCAL_ASSIGN(const RobotId after, AfterOf(parameters));
  std::vector<RobotSummary> not_kept = FreshenSummaries(store, clock);
  RobotList list;
  const std::string site = parameters.Text("site").value_or("");
  // One more tells whether any follows. Of a site all are read: who is there may be among those that could not be kept.
  const auto max = limit && site.empty() ? std::optional(*limit + 1) : std::nullopt;
  RIGCAL_ASSIGN(list.robots, storage::LoadSummaries(store, after, max, clock.Now()));
  PutIn(std::move(not_kept), after, max, list.robots);
  if (!site.empty()) std::erase_if(list.robots, [&](const RobotSummary& robot) { return robot.site != site; });
  if (!site.empty() && list.robots.empty() && after.empty()) return Fail(UnknownSite(store, site));
  if (!limit) return list;
  list.next = RobotId();
  if (static_cast<std::int64_t>(list.robots.size()) <= *limit) return list;
  list.robots.erase(list.robots.begin() + *limit, list.robots.end());
  list.next = list.robots.back().robot;
  return list;
}

}  // namespace rigcal::pipeline
