#include "storage/decisions.h"

#include "server/model/validity.h"
#include "storage/audit.h"
#include "storage/query.h"
#include "storage/revision_row.h"
#include "storage/revisions.h"
#include "storage/standing.h"
#include "storage/standing_row.h"

namespace rigcal::storage {
namespace {

std::string DecisionsSubject(const RobotId& robot) { return "decisions about robot " + robot.str(); }

// "revision 4 of robot mapper-01"
std::string NamedRevision(const RobotId& robot, int number) {
  return "revision " + std::to_string(number) + " of robot " + robot.str();
}

const std::string kDecisionColumns = "d.number, d.revision_number, d.how, d.at_ns, d.who, d.reason";

Decision DecisionOf(const Query& query) {
  return {query.Int(0), static_cast<int>(query.Int(1)), query.Text(2), {query.Time(3), query.Text(4), query.Text(5)}};
}

// Of a decision `d` to use a revision.
const std::string kNotRolledBack =
    "NOT EXISTS (SELECT 1 FROM decision b WHERE b.robot_id = d.robot_id AND b.how = 'rolled_back' AND b.number > "
    "d.number AND "
    "b.revision_number < d.revision_number)";
// That it holds.
const std::string kHolds =
    "d.how <> 'rejected' AND NOT EXISTS (SELECT 1 FROM decision r WHERE r.robot_id = d.robot_id AND "
    "r.revision_number = d.revision_number AND r.number > d.number AND r.how = 'rejected') AND " +
    kNotRolledBack;

std::optional<Decision> InUse(Store& store, const RobotId& robot) {
  Query query(store, "SELECT " + kDecisionColumns + " FROM decision d WHERE d.robot_id = ? AND " + kHolds +
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

bool WasRolledBack(Store& store, const Decision& decision) {
  return !Query(store, "SELECT 1 FROM decision d WHERE d.number = ? AND " + kNotRolledBack)
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

Status CheckDecision(Store& store, const RobotId& robot, int revision, Deciding deciding) {
  RIGCAL_ASSIGN(const auto known, LoadRevisionSummary(store, robot, revision));
  if (!known || revision < 1)
    return Fail(ErrorCode::kNotFound, "robot '" + robot.str() + "' has no revision " + std::to_string(revision),
                "`rigcal history " + robot.str() + "` lists those that there are.");
  if (deciding == Deciding::kReject) return {};
  if (!IsUsable(known->verdict))
    return Fail(
        ErrorCode::kConflict,
        NamedRevision(robot, revision) + " has the verdict " + NameOf(known->verdict.level) +
            ": only pass and warn are used",
        "`rigcal show " + robot.str() + " --revision " + std::to_string(revision) + "` says why, and what to do.");
  if (deciding == Deciding::kApprove || WasEverApproved(store, robot, revision)) return {};
  return Fail(ErrorCode::kConflict,
              NamedRevision(robot, revision) + " was never approved: there is nothing to go back to",
              "`rigcal approve " + robot.str() + " " + std::to_string(revision) + " --reason TEXT` approves it.");
}

bool IsSoAlready(Store& store, const RobotId& robot, int revision, Deciding deciding) {
  if (deciding == Deciding::kReject) {
    const auto newest = NewestAbout(store, robot, revision);
    return newest && newest->how == "rejected";
  }
  const auto in_use = InUse(store, robot);
  return in_use && in_use->revision == revision;
}

}  // namespace

Result<bool> AppendDecision(Store& store, const RobotId& robot, int revision, Deciding deciding, const Word& word) {
  RIGCAL_TRY(CheckWord(word));
  return Append<bool>(store, DecisionsSubject(robot), [&]() -> Result<bool> {
    RIGCAL_TRY(CheckDecision(store, robot, revision, deciding));
    if (IsSoAlready(store, robot, revision, deciding)) return false;
    Query(store, "INSERT INTO decision (robot_id, revision_number, how, at_ns, who, reason) VALUES (?, ?, ?, ?, ?, ?)")
        .Bind(robot, revision, HowOf(deciding), word.at, word.who, word.reason)
        .Run();
    RIGCAL_TRY(AppendAudit(store, word.at, word.who, AuditTextOf(robot, revision, deciding, word), robot));
    return true;
  });
}

Result<std::optional<Decision>> LoadInUse(Store& store, const RobotId& robot) {
  using Found = std::optional<Decision>;
  return Load<Found>(store, DecisionsSubject(robot), [&]() -> Result<Found> { return InUse(store, robot); });
}

namespace {

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

Result<std::optional<Revision>> LoadUsableRevision(Store& store, const RobotId& robot, int up_to, Stamp decided_by) {
  using Found = std::optional<Revision>;
  return Load<Found>(store, DecisionsSubject(robot), [&]() -> Result<Found> {
    Query query(
        store,
        std::string("WITH decision AS (SELECT * FROM main.decision WHERE robot_id = ?1 AND at_ns <= ?3) SELECT ") +
            kRevisionColumns +
            " FROM decision d CROSS JOIN revision ON revision.robot_id = d.robot_id AND "
            "revision.number = d.revision_number " +
            kRevisionJudged + " WHERE d.robot_id = ?1 AND +d.revision_number <= ?2 AND verdict IN ('pass', 'warn') AND " + kHolds + " AND " +
            CountsNothingRetired("counted_edge c ON c.edge_number = t.edge_number", "edge_number") + " AND " +
            CountsNothingRetired("session s ON s.number = t.session_number JOIN edge e ON e.session_id = s.session_id "
                                 "JOIN counted_edge c ON c.edge_number = e.number",
                                 "session_number") +
            " ORDER BY d.number DESC LIMIT 1");
    return query.Bind(robot, up_to, decided_by).Step() ? Found(RevisionAt(query)) : std::nullopt;
  });
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

Result<std::optional<Decision>> LoadDecision(Store& store, const RobotId& robot, int revision) {
  using Found = std::optional<Decision>;
  return Load<Found>(store, DecisionsSubject(robot),
                     [&]() -> Result<Found> { return NewestAbout(store, robot, revision); });
}

Result<RevisionState> LoadRevisionState(Store& store, const Revision& revision) {
  return Load<RevisionState>(store, DecisionsSubject(revision.robot), [&]() -> Result<RevisionState> {
    const auto newest = NewestAbout(store, revision.robot, revision.number);
    if (!newest) return IsUsable(revision.verdict) ? RevisionState::kCandidate : RevisionState::kUnusable;
    if (newest->how == "rejected") return RevisionState::kRejected;
    const auto in_use = InUse(store, revision.robot);
    if (in_use && in_use->revision == revision.number) return RevisionState::kApproved;
    return WasRolledBack(store, *newest) ? RevisionState::kRolledBack : RevisionState::kSuperseded;
  });
}

}  // namespace rigcal::storage
