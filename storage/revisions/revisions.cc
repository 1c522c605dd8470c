#include "storage/revisions/revisions.h"

#include <limits>

#include "server/base/limits.h"
#include "storage/database/compressed.h"
#include "storage/revisions/revision_row.h"
#include "storage/sessions/sessions.h"

namespace rigcal::storage {
namespace {

std::string RevisionsSubject(const RobotId& robot) { return "revisions of robot " + robot.str(); }

std::string PublicationSubject(const RevisionKey& key) {
  return "publication of revision " + std::to_string(key.number) + " of robot " + key.robot.str();
}

const std::string kRevision = std::string(kRevisionColumns) + "FROM revision " + kRevisionJudged;

int NewestNumber(Store& store, const RobotId& robot) {
  Query query(store, "SELECT coalesce(max(number), 0) FROM revision WHERE robot_id = ?");
  return query.Bind(robot).Step() ? static_cast<int>(query.Int(0)) : 0;
}

// Four index look-ups, whatever the number of edges and revisions.
const std::string kUnsolved =
    "SELECT 1 FROM robot r WHERE robot_id = ? "
    "AND ((SELECT max(number) FROM counted_edge c WHERE c.robot_id = r.robot_id) > "
    "coalesce((SELECT edge_watermark FROM revision v WHERE v.robot_id = r.robot_id "
    "ORDER BY v.number DESC LIMIT 1), 0) "
    "OR (EXISTS (SELECT 1 FROM counted_edge e WHERE e.robot_id = r.robot_id) AND "
    "(SELECT max(number) FROM standing t WHERE t.robot_id = r.robot_id) > "
    "coalesce((SELECT standing_watermark FROM revision_standing s WHERE s.robot_id = r.robot_id "
    "ORDER BY s.revision_number DESC LIMIT 1), 0)))";

// Triggers on what arrives put the robot there. Where something arrived while the revision was made it goes on to wait,
// since that.
void UpdateWaiting(Store& store, const RobotId& robot, std::int64_t edge_watermark) {
  Query(store, "DELETE FROM waiting_revision WHERE robot_id = ?").Bind(robot).Run();
  if (!Query(store, kUnsolved).Bind(robot).Step()) return;
  Query(store,
        "INSERT INTO waiting_revision SELECT ?1, coalesce((SELECT min(number) FROM counted_edge "
        "WHERE robot_id = ?1 AND number > ?2), (SELECT max(number) FROM counted_edge))")
      .Bind(robot, edge_watermark)
      .Run();
}

std::string DocumentSubject(const RobotId& robot, int number) {
  return "the document of revision " + std::to_string(number) + " of robot " + robot.str();
}

void Insert(Store& store, const Revision& revision, int number, const Blob& document) {
  Query(store, "INSERT INTO revision VALUES (?, ?, ?, ?, ?, ?, ?, ?, '')")
      .Bind(revision.robot, number, revision.created_at, revision.edge_watermark, NameOf(revision.verdict.level),
            revision.verdict.why, revision.verdict.what_to_do, revision.digest)
      .Run();
  Query(store, "INSERT INTO revision_document VALUES (?, ?, ?)").Bind(revision.robot, number, document).Run();
  Query(store, "INSERT INTO revision_standing VALUES (?, ?, ?)")
      .Bind(revision.robot, number, revision.standing_watermark)
      .Run();
  if (revision.calibrated_at)
    Query(store, "INSERT INTO revision_calibrated VALUES (?, ?, ?)")
        .Bind(revision.robot, number, *revision.calibrated_at)
        .Run();
  Query(store, "INSERT INTO revision_judgement VALUES (?, ?, ?, ?, ?)")
      .Bind(revision.robot, number, revision.policy_watermark, revision.max_age_ns, revision.verdict.unverified)
      .Run();
  Query(store, "INSERT INTO waiting_publication VALUES (?, ?)").Bind(revision.robot, number).Run();
  UpdateWaiting(store, revision.robot, revision.edge_watermark);
  Query(store, "DELETE FROM waiting_verdict WHERE robot_id = ? AND policy_number <= ?")
      .Bind(revision.robot, revision.policy_watermark)
      .Run();
  Query(store, "DELETE FROM waiting_rig_model WHERE robot_id = ? AND rig_model_number <= ?")
      .Bind(revision.robot, revision.rig_model_watermark)
      .Run();
}

}  // namespace

Revision RevisionAt(const Query& query) {
  Revision revision;
  revision.robot = query.IdAt<RobotId>(0);
  revision.number = static_cast<int>(query.Int(1));
  revision.created_at = query.Time(2);
  revision.edge_watermark = query.Int(3);
  revision.verdict = {VerdictLevelOf(query.Text(4)), query.Text(5), query.Text(6)};
  revision.digest = query.IdAt<Digest>(7);
  revision.standing_watermark = query.Int(8);  // NULL reads as 0
  if (!query.IsNull(9)) revision.calibrated_at = query.Time(9);
  if (query.IsNull(10)) return revision;  // of before policies
  revision.policy_watermark = query.Int(10);
  revision.max_age_ns = query.Int(11);
  revision.verdict.unverified = query.Text(12);
  return revision;
}

Result<std::string> DocumentAt(const Query& query, int column, const std::string& subject) {
  if (!query.IsNull(column)) return Decompress(subject, query.Text(column), limits::kRevisionBytesMax);
  std::string text = query.Text(column + 1);
  if (text.empty()) return Fail(ErrorCode::kStorage, subject + " is missing", "Restore the database from a backup.");
  return text;
}

Result<int> AppendRevision(Store& store, const Revision& revision) {
  return Append<int>(store, RevisionsSubject(revision.robot), [&]() -> Result<int> {
    RIGCAL_TRY(AppendRobot(store, revision.robot, revision.created_at));
    const int number = NewestNumber(store, revision.robot) + 1;
    RIGCAL_ASSIGN(std::string document,
                  Compress(DocumentSubject(revision.robot, number), revision.document, limits::kRevisionBytesMax));
    Insert(store, revision, number, {std::move(document)});
    return number;
  });
}

Result<std::optional<Revision>> LoadRevision(Store& store, const RobotId& robot, int number) {
  return Load<std::optional<Revision>>(store, RevisionsSubject(robot), [&]() -> Result<std::optional<Revision>> {
    Query query(store, std::string("SELECT ") + kRevisionColumns + ", " + kDocumentColumns + " FROM revision " +
                           kRevisionJudged + "WHERE revision.robot_id = ? AND number = ?");
    if (!query.Bind(robot, number > 0 ? number : NewestNumber(store, robot)).Step()) return std::nullopt;
    Revision revision = RevisionAt(query);
    RIGCAL_ASSIGN(revision.document, DocumentAt(query, 13, DocumentSubject(robot, revision.number)));
    return revision;
  });
}

Result<std::optional<Revision>> LoadRevisionSummary(Store& store, const RobotId& robot, int number) {
  return Load<std::optional<Revision>>(store, RevisionsSubject(robot), [&]() -> Result<std::optional<Revision>> {
    Query query(store, "SELECT " + kRevision + "WHERE revision.robot_id = ? AND number = ?");
    if (!query.Bind(robot, number > 0 ? number : NewestNumber(store, robot)).Step()) return std::nullopt;
    return RevisionAt(query);
  });
}

Result<std::vector<Revision>> LoadRevisions(Store& store, const RobotId& robot, int before, std::int64_t limit) {
  return Load<std::vector<Revision>>(store, RevisionsSubject(robot), [&]() -> Result<std::vector<Revision>> {
    Query query(store,
                "SELECT " + kRevision + "WHERE revision.robot_id = ? AND number < ? ORDER BY number DESC LIMIT ?");
    query.Bind(robot, before > 0 ? before : std::numeric_limits<int>::max(), limit);
    std::vector<Revision> revisions;
    while (query.Step()) revisions.push_back(RevisionAt(query));
    return revisions;
  });
}

Result<std::map<int, Stamp>> LoadCreatedAt(Store& store, const RobotId& robot, const std::vector<int>& numbers) {
  using Stamps = std::map<int, Stamp>;
  return Load<Stamps>(store, RevisionsSubject(robot), [&]() -> Result<Stamps> {
    Query query(store,
                "SELECT number, created_ns FROM revision WHERE robot_id = ? AND number IN (SELECT CAST(value AS "
                "BIGINT) FROM json_each(?))");
    query.Bind(robot, ListOf(numbers));
    Stamps stamps;
    while (query.Step()) stamps.emplace(static_cast<int>(query.Int(0)), query.Time(1));
    return stamps;
  });
}

Result<std::map<SessionId, int>> LoadFirstRevisions(Store& store, const RobotId& robot, std::int64_t watermark,
                                                    const std::vector<SessionId>& sessions) {
  using Numbers = std::map<SessionId, int>;
  return Load<Numbers>(store, RevisionsSubject(robot), [&]() -> Result<Numbers> {
    // Watermarks grow with the numbers: from the newest revision back, those that have all are passed over.
    Query query(
        store,
        "SELECT newest.session_id, coalesce((SELECT r.number FROM revision r WHERE r.robot_id = ?1 AND "
        "r.edge_watermark < "
        "newest.number ORDER BY r.number DESC LIMIT 1), 0) + 1 FROM (SELECT e.session_id, max(c.number) AS number FROM "
        "edge e "
        "JOIN counted_edge c ON c.edge_number = e.number WHERE e.session_id IN (SELECT value FROM json_each(?2)) AND "
        "c.number <= ?3 GROUP BY e.session_id) newest");
    query.Bind(robot, ListOf(sessions), watermark);
    Numbers numbers;
    while (query.Step()) numbers.emplace(query.IdAt<SessionId>(0), static_cast<int>(query.Int(1)));
    return numbers;
  });
}

Result<bool> IsUnsolved(Store& store, const RobotId& robot) {
  return Load<bool>(store, RevisionsSubject(robot), [&]() -> Result<bool> {
    return Query(store, kUnsolved).Bind(robot).Step() ||
           Query(store, "SELECT 1 FROM waiting_verdict WHERE robot_id = ?").Bind(robot).Step() ||
           Query(store, "SELECT 1 FROM waiting_rig_model WHERE robot_id = ?").Bind(robot).Step() ||
           Query(store, "SELECT 1 FROM waiting_merge_anew WHERE robot_id = ?").Bind(robot).Step();
  });
}

Result<std::optional<Stamp>> LoadUnsolvedSince(Store& store, const RobotId& robot) {
  using Since = std::optional<Stamp>;
  return Load<Since>(store, "edges of robot " + robot.str(), [&]() -> Result<Since> {
    Query query(store,
                "SELECT e.appended_ns FROM counted_edge c JOIN edge e ON e.number = c.edge_number WHERE c.robot_id = "
                "?1 AND c.number > "
                "coalesce((SELECT edge_watermark FROM revision WHERE robot_id = ?1 ORDER BY number DESC LIMIT 1), 0) "
                "ORDER BY c.number LIMIT 1");
    return query.Bind(robot).Step() ? Since(query.Time(0)) : std::nullopt;
  });
}

Result<std::vector<RobotId>> LoadUnsolvedRobots(Store& store) {
  return Load<std::vector<RobotId>>(store, "robots to solve", [&]() -> Result<std::vector<RobotId>> {
    Query query(store,
                "SELECT robot_id, since FROM waiting_revision UNION ALL "
                "SELECT robot_id, 0 FROM waiting_verdict v WHERE of_robot = 1 AND "
                "NOT EXISTS (SELECT 1 FROM waiting_revision r WHERE r.robot_id = v.robot_id) ORDER BY since, robot_id");
    std::vector<RobotId> robots;
    while (query.Step()) robots.push_back(query.IdAt<RobotId>(0));
    return robots;
  });
}

Result<std::vector<RevisionKey>> LoadNewestRevisions(Store& store, const RobotId& after, int max) {
  return Load<std::vector<RevisionKey>>(store, "newest revisions", [&]() -> Result<std::vector<RevisionKey>> {
    Query query(store,
                "SELECT robot_id, coalesce((SELECT max(number) FROM revision v WHERE v.robot_id = r.robot_id), 0) "
                "FROM robot r WHERE robot_id > ? ORDER BY robot_id LIMIT ?");
    query.Bind(after, max);
    std::vector<RevisionKey> keys;
    while (query.Step()) keys.push_back({query.IdAt<RobotId>(0), static_cast<int>(query.Int(1))});
    return keys;
  });
}

Result<std::vector<RevisionKey>> LoadUnpublished(Store& store) {
  return Load<std::vector<RevisionKey>>(store, "revisions to publish", [&]() -> Result<std::vector<RevisionKey>> {
    Query query(store,
                "SELECT w.robot_id, w.revision_number FROM waiting_publication w CROSS JOIN revision v ON "
                "v.robot_id = w.robot_id AND v.number = w.revision_number "
                "ORDER BY min(v.created_ns) OVER (PARTITION BY w.robot_id), w.robot_id, w.revision_number");
    std::vector<RevisionKey> keys;
    while (query.Step()) keys.push_back({query.IdAt<RobotId>(0), static_cast<int>(query.Int(1))});
    return keys;
  });
}

Result<std::int64_t> CountUnpublished(Store& store, const RobotId& robot) {
  return Load<std::int64_t>(store, RevisionsSubject(robot), [&]() -> Result<std::int64_t> {
    Query query(store, "SELECT count(*) FROM waiting_publication WHERE robot_id = ?");
    return query.Bind(robot).Step() ? query.Int(0) : 0;
  });
}

Result<bool> IsPublished(Store& store, const RevisionKey& key) {
  return Load<bool>(store, PublicationSubject(key), [&]() -> Result<bool> {
    Query query(store, "SELECT 1 FROM publication WHERE robot_id = ? AND revision_number = ?");
    return query.Bind(key.robot, key.number).Step();
  });
}

Result<bool> QueuePublication(Store& store, const RevisionKey& key) {
  return Append<bool>(store, PublicationSubject(key), [&]() -> Result<bool> {
    Query query(store, "INSERT INTO waiting_publication VALUES (?, ?) ON CONFLICT DO NOTHING");
    return query.Bind(key.robot, key.number).Run() > 0;
  });
}

Status PublishAgain(Store& store, const RobotId& robot) {
  return store.connection().Append(RevisionsSubject(robot), [&]() -> Status {
    Query(store,
          "INSERT INTO waiting_publication SELECT robot_id, max(number) FROM revision WHERE robot_id = ? "
          "GROUP BY robot_id ON CONFLICT DO NOTHING")
        .Bind(robot)
        .Run();
    return {};
  });
}

Status AppendPublication(Store& store, const RevisionKey& key, Stamp now) {
  return store.connection().Append(PublicationSubject(key), [&]() -> Status {
    Query(store, "INSERT INTO publication VALUES (?, ?, ?) ON CONFLICT DO NOTHING")
        .Bind(key.robot, key.number, now)
        .Run();
    Query(store, "DELETE FROM waiting_publication WHERE robot_id = ? AND revision_number = ?")
        .Bind(key.robot, key.number)
        .Run();
    return {};
  });
}

}  // namespace rigcal::storage
