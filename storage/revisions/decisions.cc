#include "storage/revisions/decisions.h"

#include "server/model/approval/validity.h"
#include "storage/audit.h"
#include "storage/database/query.h"
#include "storage/edges/edges.h"
#include "storage/revisions/decided_content.h"
#include "storage/revisions/rejections_sql.h"
#include "storage/revisions/revision_row.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/standing.h"
#include "storage/sessions/standing_row.h"

namespace rigcal::storage {
namespace {

// How errors name them.
std::string DecisionsSubject(const RobotId& robot) { return "decisions about robot " + robot.str(); }

// Of a decision `d` to use a revision.
std::string NotRolledBack(const std::string& until = "") {
  return "NOT EXISTS (SELECT 1 FROM decision b WHERE b.robot_id = d.robot_id AND b.how = 'rolled_back' AND b.number > "
         "d.number AND b.revision_number < d.revision_number" +
         DecidedUntil(until, "b") + ")";
}
// That it holds.
std::string DecisionHolds(const std::string& until = "") {
  return "d.how <> 'rejected' AND " + NotRejectedSince("d", until) + " AND " + NotRolledBack(until);
}

// "revision 4 of robot mapper-01"
std::string NamedRevision(const RobotId& robot, int number) {
  return "revision " + std::to_string(number) + " of robot " + robot.str();
}

const std::string kDecisionColumns = "d.number, d.revision_number, d.how, d.at_ns, d.who, d.reason";

Decision DecisionOf(const Query& query) {
  return {query.Int(0), static_cast<int>(query.Int(1)), query.Text(2), {query.Time(3), query.Text(4), query.Text(5)}};
}

std::optional<Decision> InUse(Store& store, const RobotId& robot) {
  Query query(store, "SELECT " + kDecisionColumns + " FROM decision d WHERE d.robot_id = ? AND " + DecisionHolds() +
                         " ORDER BY d.number DESC LIMIT 1");
  return query.Bind(robot).Step() ? std::optional(DecisionOf(query)) : std::nullopt;
}

std::optional<Decision> NewestAbout(Store& store, const RobotId& robot, int revision) {
  Query query(store,
              "SELECT " + kDecisionColumns +
                  " FROM decision d WHERE d.robot_id = ? AND d.revision_number = ? ORDER BY d.number DESC LIMIT 1");
  return query.Bind(robot, revision).Step() ? std::optional(DecisionOf(query)) : std::nullopt;
}

bool WasEverApproved(Store& store, const RobotId& robot, int revision) {
  return Query(store, "SELECT 1 FROM decision WHERE robot_id = ? AND revision_number = ? AND how <> 'rejected' LIMIT 1")
      .Bind(robot, revision)
      .Step();
}

// By which what the revision is was rejected, in `newest`, the newest decision about it if there is one, or since: of
// several the newest.
std::optional<Decision> RejectionOf(Store& store, const RobotId& robot, int revision,
                                    const std::optional<Decision>& newest) {
  Query query(store, RejectionsOf("r.number, r.revision_number, r.how, r.at_ns, r.who, r.reason", "?1",
                                  "(SELECT digest FROM revision WHERE robot_id = ?1 AND number = ?2)") +
                         " AND r.number >= ?3 ORDER BY r.number DESC LIMIT 1");
  query.Bind(robot, revision, newest ? newest->number : 0);
  return query.Step() ? std::optional(DecisionOf(query)) : std::nullopt;
}

bool WasRolledBack(Store& store, const Decision& decision) {
  return !Query(store, "SELECT 1 FROM decision d WHERE d.number = ? AND " + NotRolledBack())
              .Bind(decision.number)
              .Step();
}

// The name of a decision in the table.
std::string HowOf(Deciding deciding) {
  if (deciding == Deciding::kApprove) return "approved";
  return deciding == Deciding::kReject ? "rejected" : "rolled_back";
}

std::string AuditTextOf(const RobotId& robot, int revision, Deciding deciding, const Word& word) {
  if (deciding == Deciding::kRollBack)
    return "rolled robot " + robot.str() + " back to revision " + std::to_string(revision) + Because(word);
  return HowOf(deciding) + " " + NamedRevision(robot, revision) + Because(word);
}

// " was rejected by Ada, 3 Nov 2026"
std::string RejectedText(const Decision& rejection, int revision) {
  const std::string as = rejection.revision == revision
                             ? ""
                             : " is the same calibration as revision " + std::to_string(rejection.revision) + ", which";
  return as + " was rejected by " + rejection.word.who + ", " + DayText(rejection.word.at);
}

// What somebody said no to last, or never said yes to, is nothing to go back to.
Status CheckGoingBack(Store& store, const RobotId& robot, int revision) {
  const auto rejection = RejectionOf(store, robot, revision, NewestAbout(store, robot, revision));
  if (!rejection && WasEverApproved(store, robot, revision)) return {};
  return Fail(ErrorCode::kConflict,
              NamedRevision(robot, revision) + (rejection ? RejectedText(*rejection, revision) +
                                                                ": nobody goes back to it before somebody approves it"
                                                          : " was never approved: there is nothing to go back to"),
              "`rigcal approve " + robot.str() + " " + std::to_string(revision) + " --reason TEXT` approves it.");
}

// What is to be decided about, without its document.
Result<Revision> CheckDecision(Store& store, const RobotId& robot, int revision, Deciding deciding) {
  RIGCAL_ASSIGN(const auto known, LoadRevisionSummary(store, robot, revision));
  if (!known || revision < 1)
    return Fail(ErrorCode::kNotFound, "robot '" + robot.str() + "' has no revision " + std::to_string(revision),
                "`rigcal history " + robot.str() + "` lists those that there are.");
  if (deciding == Deciding::kReject) return *known;
  if (!IsUsable(known->verdict))
    return Fail(
        ErrorCode::kConflict,
        NamedRevision(robot, revision) + " has the verdict " + NameOf(known->verdict.level) +
            ": only pass and warn are used",
        "`rigcal show " + robot.str() + " --revision " + std::to_string(revision) + "` says why, and what to do.");
  if (deciding == Deciding::kRollBack) RIGCAL_TRY(CheckGoingBack(store, robot, revision));
  return *known;
}

// Whether somebody said yes after `decision` to a revision with the document of that one.
bool WasTakenUpSince(Store& store, const RobotId& robot, const Decision& decision) {
  return Query(store,
               "SELECT 1 FROM decision d CROSS JOIN revision v ON v.robot_id = d.robot_id AND v.number = "
               "d.revision_number WHERE d.robot_id = ?1 AND d.number > ?2 AND d.how <> 'rejected' AND v.digest = "
               "(SELECT digest FROM revision WHERE robot_id = ?1 AND number = ?3) LIMIT 1")
      .Bind(robot, decision.number, decision.revision)
      .Step();
}

bool IsSoAlready(Store& store, const RobotId& robot, int revision, Deciding deciding) {
  if (deciding == Deciding::kReject) {
    const auto newest = NewestAbout(store, robot, revision);
    return newest && newest->how == "rejected" && !WasTakenUpSince(store, robot, *newest);
  }
  const auto in_use = InUse(store, robot);
  return in_use && in_use->revision == revision;
}

// Of a revision: that no edge which it counts was retired since, itself or with its session, and not restored.
// `counted` finds the edges `c` of the word `t`, which is about `subject`.
std::string CountsNothingRetired(const std::string& counted, const std::string& subject) {
  return "NOT EXISTS (SELECT 1 FROM standing t JOIN " + counted +
         " WHERE t.robot_id = revision.robot_id AND t.how = 'retired' AND c.number <= revision.edge_watermark "
         "AND t.number > coalesce((SELECT standing_watermark FROM revision_standing w "
         "WHERE w.robot_id = revision.robot_id AND w.revision_number = revision.number), 0) "
         "AND NOT EXISTS (SELECT 1 FROM standing later WHERE later." +
         subject + " = t." + subject + " AND later.number > t.number AND later.how = 'restored'))";
}

}  // namespace

Result<bool> AppendDecision(Store& store, const RobotId& robot, int revision, Deciding deciding, const Word& word) {
  RIGCAL_TRY(CheckWord(word));
  return Append<bool>(store, DecisionsSubject(robot), [&]() -> Result<bool> {
    RIGCAL_ASSIGN(const Revision known, CheckDecision(store, robot, revision, deciding));
    if (IsSoAlready(store, robot, revision, deciding)) return false;
    RIGCAL_ASSIGN(const std::int64_t edges, LoadEdgeWatermark(store, robot));
    const auto number =
        Query(store,
              "INSERT INTO decision (robot_id, revision_number, how, at_ns, who, reason, edge_watermark, digest, "
              "poses_hash) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?) RETURNING number")
            .Bind(robot, revision, HowOf(deciding), word.at, word.who, word.reason, edges, known.digest,
                  HashOfPoses(store, {robot, revision}))
            .RunForKey();
    const AuditedRow row{AuditedKind::kDecision, number.value()};
    RIGCAL_TRY(AppendAudit(store, word.at, word.who, AuditTextOf(robot, revision, deciding, word), robot, row));
    return true;
  });
}

Result<std::optional<Decision>> LoadInUse(Store& store, const RobotId& robot) {
  using Found = std::optional<Decision>;
  return Load<Found>(store, DecisionsSubject(robot), [&]() -> Result<Found> { return InUse(store, robot); });
}

Result<int> LoadNewestApproved(Store& store, const RobotId& robot) {
  return Load<int>(store, DecisionsSubject(robot), [&]() -> Result<int> {
    Query query(store,
                "SELECT revision_number FROM decision WHERE robot_id = ? AND how <> 'rejected' ORDER BY "
                "revision_number DESC LIMIT 1");
    return query.Bind(robot).Step() ? static_cast<int>(query.Int(0)) : 0;
  });
}

Result<bool> WasApproved(Store& store, const RobotId& robot, int revision) {
  return Load<bool>(store, DecisionsSubject(robot),
                    [&]() -> Result<bool> { return WasEverApproved(store, robot, revision); });
}

Result<bool> WasDecidedBecause(Store& store, const RobotId& robot, int revision, const std::string& who,
                               const std::string& reason) {
  return Load<bool>(store, DecisionsSubject(robot), [&]() -> Result<bool> {
    return Query(store,
                 "SELECT 1 FROM decision WHERE robot_id = ? AND revision_number = ? AND who = ? AND reason = ? LIMIT 1")
        .Bind(robot, revision, who, reason)
        .Step();
  });
}

Result<std::vector<RejectedDocument>> LoadRejections(Store& store, const RobotId& robot, std::int64_t limit) {
  using Rejected = std::vector<RejectedDocument>;
  return Load<Rejected>(store, DecisionsSubject(robot), [&]() -> Result<Rejected> {
    Query query(
        store, RejectionsOf("v.digest, r.at_ns, r.who, r.reason", "?", "v.digest") + " ORDER BY r.number DESC LIMIT ?");
    query.Bind(robot, limit);
    Rejected rejected;
    while (query.Step()) rejected.push_back({query.IdAt<Digest>(0), {query.Time(1), query.Text(2), query.Text(3)}});
    return rejected;
  });
}

Result<std::optional<Decision>> LoadDecision(Store& store, const RobotId& robot, int revision) {
  using Found = std::optional<Decision>;
  return Load<Found>(store, DecisionsSubject(robot), [&]() -> Result<Found> {
    auto newest = NewestAbout(store, robot, revision);
    auto rejection = RejectionOf(store, robot, revision, newest);
    return rejection ? rejection : newest;
  });
}

Result<RevisionState> LoadRevisionState(Store& store, const Revision& revision,
                                        const std::optional<UsableRevision>& usable) {
  return Load<RevisionState>(store, DecisionsSubject(revision.robot), [&]() -> Result<RevisionState> {
    const auto newest = NewestAbout(store, revision.robot, revision.number);
    if (!newest && !IsUsable(revision.verdict)) return RevisionState::kUnusable;
    if (RejectionOf(store, revision.robot, revision.number, newest)) return RevisionState::kRejected;
    if (!newest) return RevisionState::kCandidate;
    if (usable && usable->number == revision.number) return RevisionState::kApproved;
    const auto in_use = InUse(store, revision.robot);
    if (in_use && in_use->revision == revision.number) return RevisionState::kTakenBack;
    return WasRolledBack(store, *newest) ? RevisionState::kRolledBack : RevisionState::kSuperseded;
  });
}

Result<std::optional<Revision>> LoadStillUsable(Store& store, const RobotId& robot, int up_to, Stamp decided_by) {
  using Found = std::optional<Revision>;
  return Load<Found>(store, DecisionsSubject(robot), [&]() -> Result<Found> {
    Query query(
        store,
        std::string("SELECT ") + kRevisionColumns +
            " FROM decision d CROSS JOIN revision ON revision.robot_id = d.robot_id AND "
            "revision.number = d.revision_number " +
            kRevisionJudged +
            " WHERE d.robot_id = ?1 AND d.at_ns <= ?3 AND +d.revision_number <= ?2 AND verdict IN ('pass', 'warn') "
            "AND " +
            DecisionHolds("?3") + " AND " +
            CountsNothingRetired("counted_edge c ON c.edge_number = t.edge_number", "edge_number") + " AND " +
            CountsNothingRetired("session s ON s.number = t.session_number JOIN edge e ON e.session_id = s.session_id "
                                 "JOIN counted_edge c ON c.edge_number = e.number",
                                 "session_number") +
            " ORDER BY d.number DESC LIMIT 1");
    return query.Bind(robot, up_to, decided_by).Step() ? Found(RevisionAt(query)) : std::nullopt;
  });
}

Result<std::optional<Revision>> LoadUsableRevision(Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto in_use, LoadInUse(store, robot));
  if (!in_use) return std::nullopt;
  RIGCAL_ASSIGN(auto usable, LoadStillUsable(store, robot));
  if (usable && usable->number != in_use->revision) usable.reset();
  return usable;
}

Result<bool> IsHeldBack(Store& store, const RobotId& robot, const Digest& digest, std::int64_t edge_watermark) {
  return Load<bool>(store, DecisionsSubject(robot), [&]() -> Result<bool> {
    Query query(store,
                "SELECT edge_watermark FROM decision WHERE robot_id = ? AND how <> 'approved' "
                "ORDER BY number DESC LIMIT 1");
    if (query.Bind(robot).Step() && edge_watermark <= query.Int(0)) return true;
    return Query(store, RejectionsOf("1", "?", "?") + " LIMIT 1").Bind(robot, digest).Step();
  });
}

}  // namespace rigcal::storage
