#include "server/pipeline/robots/robot_status.h"

#include <map>
#include <set>

#include "server/base/log.h"
#include "server/fleet/status/sensor_status.h"
#include "server/model/edges/past.h"
#include "storage/alerts/outbox.h"
#include "storage/alerts/revision_status.h"
#include "storage/revisions/as_found.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/epochs.h"

namespace rigcal::pipeline {
namespace {

// More tell hardly more of a rate, and are to be read for each revision.
constexpr int kModelVisitsMax = 192, kOwnVisitsMax = 48;
constexpr double kNanosecondsOfDay = 86'400e9;
constexpr std::size_t kSiteBytesMax = 200;

using VisitSet = std::set<std::pair<RobotId, int>>;

// When the calibration that was in use was captured; nothing where that is not known.
Result<std::optional<Stamp>> InUseCapturedAt(storage::Store& store, const RobotId& robot, const AsFound& found) {
  if (found.in_use < 1) return std::nullopt;
  RIGCAL_ASSIGN(const auto in_use, storage::LoadRevisionSummary(store, robot, found.in_use));
  return in_use ? in_use->calibrated_at : std::nullopt;
}

// Whether an epoch began after the one and not after the other. What was measured at the very time from which on a
// person begins one is of before.
bool BeganBetween(const Epoch& epoch, Stamp since, Stamp until) {
  if (epoch.session.empty()) return since <= epoch.begins_at && epoch.begins_at < until;
  return since < epoch.begins_at && epoch.begins_at <= until;
}

// What is steps of drift of visits, one robot after the other.
class StepsOfVisits {
 public:
  explicit StepsOfVisits(storage::Store& store) : store_(store) {}

  Status TakeVisit(const storage::RevisionKey& key) {
    RIGCAL_ASSIGN(auto found, storage::LoadAsFound(store_, key));
    return found ? Take(key.robot, std::move(*found)) : Status{};
  }
  Status Take(const RobotId& robot, AsFound found) {
    RIGCAL_ASSIGN(const auto since, InUseCapturedAt(store_, robot, found));
    if (!since) return {};
    // What was found unchanged is a step of none, whatever was done to it.
    if (StateOf(found) == FoundState::kDrifted) RIGCAL_TRY(LeaveOutMoved(robot, *since, found));
    fleet::AddSteps(robot, found, static_cast<double>(found.captured_at.ns - since->ns) / kNanosecondsOfDay, steps_);
    return {};
  }
  [[nodiscard]] const fleet::DriftSteps& steps() const { return steps_; }

 private:
  // Of sensors that were moved on purpose in between, as is known by now: the revision may be from before that was
  // said. Told in the frame of one of these, all are off.
  Status LeaveOutMoved(const RobotId& robot, Stamp since, AsFound& found) {
    if (!epochs_.contains(robot)) {
      RIGCAL_ASSIGN(epochs_[robot], storage::LoadEpochs(store_, robot));
    }
    for (const Epoch& epoch : epochs_[robot]) {
      if (!BeganBetween(epoch, since, found.captured_at)) continue;
      std::erase_if(found.sensors, [&](const SensorFound& one) {
        return epoch.sensor == found.relative_to || epoch.sensor == one.sensor || epoch.sensor == one.or_else;
      });
    }
    return {};
  }

  storage::Store& store_;
  std::map<RobotId, std::vector<Epoch>> epochs_;
  fleet::DriftSteps steps_;
};

Result<VisitSet> LoadVisits(storage::Store& store, const RobotId& robot, const std::string& rig_model) {
  VisitSet visits;
  RIGCAL_ASSIGN(const auto own, storage::LoadModelVisits(store, "", robot, kOwnVisitsMax));
  for (const storage::RevisionKey& key : own) visits.emplace(key.robot, key.number);
  if (rig_model.empty()) return visits;
  RIGCAL_ASSIGN(const auto others, storage::LoadModelVisits(store, rig_model, RobotId(), kModelVisitsMax));
  for (const storage::RevisionKey& key : others) visits.emplace(key.robot, key.number);
  return visits;
}

// Of each session that counts the first revision with it: one that is made once more of the same session tells nothing
// new.
Result<fleet::DriftSteps> LoadSteps(storage::Store& store, const StatusOfRevision& revision) {
  const RobotId& robot = revision.made.robot;
  StepsOfVisits steps(store);
  bool is_among = false;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(const VisitSet visits, LoadVisits(store, robot, revision.policy.rig_model));
    for (const auto& [whose, number] : visits) {
      const Status taken = steps.TakeVisit({whose, number});
      if (!taken) LogError(taken.error());
    }
    if (!revision.found) return {};
    RIGCAL_ASSIGN(is_among, storage::HasModelVisit(store, robot, revision.found->session));
    return is_among ? Status{} : steps.Take(robot, *revision.found);
  }));
  return steps.steps();
}

std::string ConditionOf(const SessionHeader& header, const char* name) {
  const auto found = header.conditions.find(name);
  return found == header.conditions.end() ? "" : found->second.substr(0, kSiteBytesMax);
}

// That was captured last, of those of which it is known.
SessionId NewestSession(const fleet::SessionTimes& captured_at) {
  const std::pair<const SessionId, Stamp>* newest = nullptr;
  for (const auto& one : captured_at)
    if (newest == nullptr || newest->second <= one.second) newest = &one;
  return newest == nullptr ? SessionId() : newest->first;
}

// It has pairs, and none of them is good.
bool HasFailedAsAWhole(const std::vector<Edge>& edges, const SessionId& session) {
  bool any = false;
  for (const Edge& edge : edges) {
    if (edge.session != session || IsPast(edge)) continue;
    if (edge.state == EdgeState::kGood) return false;
    any = true;
  }
  return any;
}

}  // namespace

Result<StatusFacts> FindStatus(storage::Store& store, const StatusOfRevision& revision) {
  RIGCAL_ASSIGN(const fleet::DriftSteps steps, LoadSteps(store, revision));
  const formats::RevisionInput& made = revision.made;
  std::optional<Stamp> in_use_captured_at;
  if (revision.found) {
    RIGCAL_ASSIGN(in_use_captured_at, InUseCapturedAt(store, made.robot, *revision.found));
  }
  StatusFacts facts = fleet::JudgeStatus(
      {made.robot, made.solution, made.reference, revision.policy.policy, revision.found, steps, revision.calibrated_at,
       revision.max_age_ns, in_use_captured_at, fleet::StatusInput::Judged{made.verdict.level, made.basis}});
  facts.site = SiteOf(revision.headers);
  facts.basis = made.basis;
  return facts;
}

std::string SiteOf(const fleet::SessionHeaders& headers) {
  const SessionHeader* newest = nullptr;
  std::string site;
  for (const auto& [session, header] : headers) {
    if (newest != nullptr && header.captured_at < newest->captured_at) continue;
    std::string named = ConditionOf(header, "site");
    if (named.empty()) named = ConditionOf(header, "location");
    if (named.empty()) continue;
    newest = &header;
    site = std::move(named);
  }
  return site;
}

Result<std::optional<formats::AlertDraft>> FindFailedSession(storage::Store& store, const formats::RevisionInput& made,
                                                             const fleet::SessionTimes& captured_at, int revision,
                                                             Stamp now) {
  const SessionId newest = NewestSession(captured_at);
  if (newest.empty() || !HasFailedAsAWhole(made.edges, newest)) return std::nullopt;
  RIGCAL_ASSIGN(const bool is_told, storage::HasAlert(store, made.robot, "session_failed", newest.str()));
  if (is_told) return std::nullopt;
  return formats::SessionFailedAlert(made.robot, newest, captured_at.at(newest), revision, made.verdict, now);
}

}  // namespace rigcal::pipeline
