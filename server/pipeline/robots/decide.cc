#include "server/pipeline/robots/decide.h"

#include <utility>

#include "server/base/log.h"
#include "server/formats/answers/answers.h"
#include "server/model/approval/validity.h"
#include "server/pipeline/robots/asked.h"
#include "server/pipeline/robots/policies.h"
#include "server/pipeline/robots/robot_rows.h"
#include "server/pipeline/robots/validity.h"
#include "storage/alerts/outbox.h"
#include "storage/audit.h"
#include "storage/edges/edges.h"
#include "storage/fleet/robot_runs.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/revisions.h"
#include "storage/work/recomputation_result.h"

namespace rigcal::pipeline {
namespace {

using formats::Parameters;
using storage::Deciding;

Deciding DecidingOf(const std::string& verb) {
  if (verb == "approve") return Deciding::kApprove;
  return verb == "reject" ? Deciding::kReject : Deciding::kRollBack;
}

// Names the revision that it may be about, as the command that was meant: of candidates the newest.
Result<std::string> NameTheRevision(storage::Store& store, const RobotId& robot, const std::string& verb) {
  constexpr std::int64_t kLookedAt = 20;
  const std::string list = "`rigcal history " + robot.str() + "` lists them";
  RIGCAL_ASSIGN(const auto revisions, storage::LoadRevisions(store, robot, 0, kLookedAt));
  RIGCAL_ASSIGN(const auto approvals, LoadApprovals(store, robot, revisions));
  const RevisionState wanted = verb == "approve" ? RevisionState::kCandidate : RevisionState::kApproved;
  for (std::size_t i = 0; verb != "rollback" && i < approvals.size(); ++i) {
    if (approvals[i].state != wanted) continue;
    const std::string number = std::to_string(revisions[i].number);
    return "Look at it first, and name it: revision " + number +
           (verb == "approve" ? " is the newest candidate" : " is in use") + ", `rigcal " + verb + " " + robot.str() +
           " " + number + " --reason TEXT`; " + list + ".";
  }
  return "Look at it first, and name it: " + list + ".";
}

// By its number: between a look and a word another one may have come.
Result<Revision> RevisionAsked(storage::Store& store, const RobotId& robot, const std::string& verb,
                               const Parameters& parameters) {
  RIGCAL_ASSIGN(const std::int64_t number, parameters.IntegerOr("revision", 0));
  if (number >= 1) return LoadRevisionSummaryOf(store, robot, number);
  RIGCAL_ASSIGN(std::string cure, NameTheRevision(store, robot, verb));
  return Fail(ErrorCode::kInvalidInput, "the parameter 'revision' is missing, or no number of a revision",
              std::move(cure));
}

// What was so already is no news.
Status TellDecided(storage::Store& store, const RobotId& robot, int revision) {
  RIGCAL_ASSIGN(const auto decision, storage::LoadDecision(store, robot, revision));
  return decision ? storage::AppendAlert(store, formats::DecisionAlert(robot, *decision)) : Status{};
}

// Its poses would be of another rig, or of what somebody took out.
Status CheckIsUsed(storage::Store& store, const Revision& revision) {
  RIGCAL_ASSIGN(const auto usable, LoadUsable(store, revision.robot));
  if (usable && usable->number == revision.number) return {};
  return Fail(ErrorCode::kConflict,
              "revision " + std::to_string(revision.number) + " of robot " + revision.robot.str() +
                  " cannot be used: what it was made of was retired, or a sensor was moved, since",
              "Capture again, or name another revision: `rigcal history " + revision.robot.str() + "` lists them.");
}

// By which the robot uses what it uses.
Result<std::optional<Decision>> LoadUsingDecision(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto usable, LoadUsable(store, robot));
  if (!usable) return std::nullopt;
  return storage::LoadInUse(store, robot);
}

// Whether the policy that holds now, and no person's no, puts the revision in use. Not where the audit can take no row:
// what nobody could check afterwards is left to be decided; the revision itself is kept all the same.
Result<bool> IsForThePolicy(storage::Store& store, const Revision& revision, bool found_drift,
                            std::int64_t edge_watermark) {
  if (!IsUsable(revision.verdict)) return false;
  RIGCAL_ASSIGN(const PolicyInForce in_force, LoadPolicyInForce(store, {PolicyScope::kRobot, revision.robot.str()}));
  if (!Approves(in_force.policy, revision.verdict, found_drift)) return false;
  RIGCAL_ASSIGN(const bool is_held_back, storage::IsHeldBack(store, revision.robot, revision.digest, edge_watermark));
  if (is_held_back) return false;
  RIGCAL_ASSIGN(const bool awaits, storage::AwaitsPerson(store, revision.robot, revision.number, edge_watermark));
  if (awaits) return false;
  const Status audit = storage::CheckAuditGoesOn(store);
  if (!audit) LogError(audit.error());
  return audit.has_value();
}

}  // namespace

Status ApproveByPolicy(storage::Store& store, const Revision& revision, bool found_drift, Stamp now) {
  RIGCAL_ASSIGN(const bool is_for_it, IsForThePolicy(store, revision, found_drift, revision.edge_watermark));
  if (!is_for_it) return {};
  const Word word{now, kPolicyWho, "the verdict is " + NameOf(revision.verdict.level)};
  RIGCAL_ASSIGN(const bool is_new,
                storage::AppendDecision(store, revision.robot, revision.number, Deciding::kApprove, word));
  return is_new ? TellDecided(store, revision.robot, revision.number) : Status{};
}

Status FallBackByPolicy(storage::Store& store, const RobotId& robot, Stamp now) {
  RIGCAL_ASSIGN(const auto in_use, storage::LoadInUse(store, robot));
  RIGCAL_ASSIGN(const auto usable, storage::LoadUsableRevision(store, robot));
  if (!in_use || usable) return {};
  RIGCAL_ASSIGN(const auto fallback, LoadFallback(store, robot));
  if (!fallback) return {};
  RIGCAL_ASSIGN(const std::int64_t edges, storage::LoadEdgeWatermark(store, robot));
  RIGCAL_ASSIGN(const bool is_for_it, IsForThePolicy(store, *fallback, false, edges));
  if (!is_for_it) return {};
  const Word word{now, kPolicyWho,
                  "of revision " + std::to_string(in_use->revision) + ", which was in use, something was retired"};
  RIGCAL_ASSIGN(const bool is_new, storage::AppendDecision(store, robot, fallback->number, Deciding::kApprove, word));
  return is_new ? TellDecided(store, robot, fallback->number) : Status{};
}

Result<OrderDone> Decide(storage::Store& store, const Clock& clock, const std::string& verb,
                         const Parameters& parameters) {
  const Deciding deciding = DecidingOf(verb);
  Word word{clock.Now(), "", ""};
  RIGCAL_ASSIGN(word.who, RequiredWho(parameters, "Say who decides."));
  RIGCAL_ASSIGN(word.reason, RequiredText(parameters, "reason", "Say why, for those who come after."));
  OrderDone done;
  RIGCAL_TRY(store.Write([&]() -> Status {
    RIGCAL_ASSIGN(done.robot, KnownRobot(store, parameters));
    RIGCAL_ASSIGN(const Revision revision, RevisionAsked(store, done.robot, verb, parameters));
    RIGCAL_ASSIGN(const bool is_new, storage::AppendDecision(store, done.robot, revision.number, deciding, word));
    if (is_new) RIGCAL_TRY(TellDecided(store, done.robot, revision.number));
    if (deciding != Deciding::kReject) RIGCAL_TRY(CheckIsUsed(store, revision));
    RIGCAL_ASSIGN(const Approval approval, LoadApproval(store, revision));
    done.decided = revision.number;
    done.document = formats::WriteDecided(revision, approval);
    return {};
  }));
  return done;
}

Result<Approval> LoadApproval(storage::Store& store, const Revision& revision) {
  RIGCAL_ASSIGN(const auto approvals, LoadApprovals(store, revision.robot, {revision}));
  return approvals.front();
}

Result<std::vector<Approval>> LoadApprovals(storage::Store& store, const RobotId& robot,
                                            const std::vector<Revision>& revisions) {
  std::vector<Approval> approvals;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(const auto usable, LoadUsable(store, robot));
    RIGCAL_ASSIGN(const auto in_use, LoadUsingDecision(store, robot));
    for (const Revision& revision : revisions) {
      RIGCAL_ASSIGN(const RevisionState state, storage::LoadRevisionState(store, revision, usable));
      RIGCAL_ASSIGN(const auto decision, storage::LoadDecision(store, robot, revision.number));
      RIGCAL_ASSIGN(const auto run, storage::LoadCauseOf(store, {robot, revision.number}));
      approvals.push_back({state, decision, in_use, run ? CauseText(*run) : ""});
    }
    return {};
  }));
  return approvals;
}

Result<std::optional<Runs>> LoadWhatRuns(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(auto runs, storage::LoadRuns(store, robot));
  if (!runs) return std::nullopt;
  RIGCAL_ASSIGN(const auto usable, LoadUsable(store, robot));
  if (usable) {
    RIGCAL_ASSIGN(const Revision in_use, LoadRevisionSummaryOf(store, robot, usable->number));
    if (in_use.digest == runs->report.digest) runs->revision = usable->number;  // of several with the same document
  }
  RIGCAL_ASSIGN(const bool was_approved, storage::WasApproved(store, robot, runs->revision));
  RIGCAL_ASSIGN(const auto decision, storage::LoadDecision(store, robot, runs->revision));
  RIGCAL_ASSIGN(const auto using_it, storage::LoadInUse(store, robot));
  return RunsOf(*runs, was_approved, decision, usable, using_it ? std::optional(using_it->word.at) : std::nullopt);
}

Result<Revision> LoadRevisionInUse(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto usable, LoadUsable(store, robot));
  if (usable) return LoadRevisionSummaryOf(store, robot, usable->number);
  RIGCAL_ASSIGN(const Revision newest, LoadRevisionSummaryOf(store, robot, 0));
  if (!IsUsable(newest.verdict)) return newest;
  RIGCAL_ASSIGN(const Approval approval, LoadApproval(store, newest));
  return Fail(ErrorCode::kConflict, ApprovalText(robot, newest.number, approval),
              "To see it all the same, ask for it by its number: --revision " + std::to_string(newest.number) + ".");
}

}  // namespace rigcal::pipeline
