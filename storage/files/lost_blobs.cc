#include "storage/files/lost_blobs.h"

#include "storage/database/query.h"
#include "storage/revisions/revisions.h"

namespace rigcal::storage {
namespace {

std::string NameOf(BlobState state) { return state == BlobState::kMissing ? "missing" : "damaged"; }

// Only those that wait for nothing else.
void QueueWaitingJobs(Store& store, const Digest& digest) {
  Query(store,
        "INSERT INTO waiting_job SELECT w.job_number, s.robot_id FROM waiting_rerun w "
        "JOIN job j ON j.number = w.job_number JOIN session s ON s.number = j.session_number "
        "WHERE w.digest = ? AND NOT EXISTS "
        "(SELECT 1 FROM waiting_rerun other WHERE other.job_number = w.job_number AND other.digest <> w.digest) "
        "ON CONFLICT DO NOTHING")
      .Bind(digest)
      .Run();
}

Status PublishWhatShows(Store& store, const Digest& digest) {
  std::vector<RobotId> robots;
  Query query(store,
              "SELECT DISTINCT s.robot_id FROM payload p JOIN session s ON s.number = p.session_number "
              "WHERE p.digest = ?");
  query.Bind(digest);
  while (query.Step()) robots.push_back(query.IdAt<RobotId>(0));
  for (const RobotId& robot : robots) RIGCAL_TRY(PublishAgain(store, robot));
  return {};
}

// Sessions that were not sent on for want of it: they need not wait for their next try.
void SendOnAtOnce(Store& store, const Digest& digest) {
  Query(store,
        "UPDATE waiting_forward SET next_try_ns = 0 WHERE next_try_ns > 0 AND kind = 'session' AND subject IN (SELECT "
        "s.session_id FROM payload p CROSS JOIN session s ON s.number = p.session_number WHERE p.digest = ?)")
      .Bind(digest)
      .Run();
}

bool HasRerun(Store& store, const Digest& digest) {
  return Query(store, "SELECT 1 FROM waiting_rerun WHERE digest = ?").Bind(digest).Step();
}

}  // namespace

void NoteLost(Connection& connection, const Digest& digest, BlobState state, Stamp now) {
  if (Query(connection, "SELECT 1 FROM waiting_blob WHERE digest = ?").Bind(digest).Step()) return;
  const auto number =
      Query(connection, "INSERT INTO blob_lost (digest, why, lost_ns) VALUES (?, ?, ?) RETURNING number")
          .Bind(digest, NameOf(state), now)
          .RunForKey();
  Query(connection, "INSERT INTO waiting_blob VALUES (?, ?)").Bind(digest, number).Run();
}

Status AppendLost(Store& store, const Digest& digest, BlobState state, std::optional<std::int64_t> job_number,
                  Stamp now) {
  return store.connection().Append("the loss of " + digest.str(), [&]() -> Status {
    NoteLost(store.connection(), digest, state, now);
    if (!job_number) return {};
    Query(store, "INSERT INTO waiting_rerun VALUES (?, ?) ON CONFLICT DO NOTHING").Bind(digest, *job_number).Run();
    return {};
  });
}

Result<LostPayloads> LoadLost(Store& store, std::size_t first_max) {
  return Load<LostPayloads>(store, "lost files", [&]() -> Result<LostPayloads> {
    Query query(store,
                "SELECT s.robot_id, s.session_id, p.path, l.why FROM waiting_blob w CROSS JOIN blob_lost l "
                "ON l.number = w.lost_number CROSS JOIN payload p ON p.digest = w.digest CROSS JOIN session s "
                "ON s.number = p.session_number ORDER BY s.robot_id, s.number, p.path");
    LostPayloads lost;
    for (; query.Step(); ++lost.count)
      if (lost.first.size() < first_max)
        lost.first.push_back({query.IdAt<RobotId>(0), query.IdAt<SessionId>(1), query.Text(2),
                              query.Text(3) == "missing" ? BlobState::kMissing : BlobState::kDamaged});
    return lost;
  });
}

Status EndLoss(Store& store, std::int64_t session_number, std::uint32_t payload_idx) {
  Query find(store,
             "SELECT w.digest FROM waiting_blob w CROSS JOIN payload p ON p.digest = w.digest "
             "WHERE p.session_number = ? AND p.idx = ?");
  if (!find.Bind(session_number, payload_idx).Step()) return {};
  const auto digest = find.IdAt<Digest>(0);
  if (HasRerun(store, digest))
    QueueWaitingJobs(store, digest);
  else
    RIGCAL_TRY(PublishWhatShows(store, digest));
  SendOnAtOnce(store, digest);
  Query(store, "DELETE FROM waiting_blob WHERE digest = ?").Bind(digest).Run();
  return {};
}

}  // namespace rigcal::storage
