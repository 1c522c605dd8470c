#include "storage/revisions/usable_revision.h"

#include "storage/database/query.h"
#include "storage/revisions/decision_row.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/revision_row.h"

namespace rigcal::storage {
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

namespace {

// Whether the newest decision about a revision with this document is a rejection.
bool IsDigestRejected(Store& store, const RobotId& robot, const Digest& digest) {
  return Query(store,
               "SELECT 1 FROM decision d CROSS JOIN revision ON revision.robot_id = d.robot_id AND revision.number = "
               "d.revision_number WHERE d.robot_id = ? AND d.how <> 'approved' AND d.how = 'rejected' AND "
               "revision.digest = ? AND NOT EXISTS "
               "(SELECT 1 FROM decision later WHERE later.robot_id = d.robot_id AND later.revision_number = "
               "d.revision_number AND later.number > d.number) LIMIT 1")
      .Bind(robot, digest)
      .Step();
}

}  // namespace

Result<bool> IsHeldBack(Store& store, const RobotId& robot, const Digest& digest, std::int64_t edge_watermark) {
  return Load<bool>(store, DecisionsSubject(robot), [&]() -> Result<bool> {
    Query query(store,
                "SELECT edge_watermark FROM decision WHERE robot_id = ? AND how <> 'approved' "
                "ORDER BY number DESC LIMIT 1");
    if (query.Bind(robot).Step() && edge_watermark <= query.Int(0)) return true;
    return IsDigestRejected(store, robot, digest);
  });
}

}  // namespace rigcal::storage
