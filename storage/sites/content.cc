#include "storage/sites/content.h"

#include "storage/database/query.h"

namespace rigcal::storage {

Result<std::optional<NamedPayload>> LoadNamedPayload(Store& store, const SessionId& session, const Digest& digest) {
  using Named = std::optional<NamedPayload>;
  return Load<Named>(store, "the payloads of session " + session.str(), [&]() -> Result<Named> {
    Query query(store,
                "SELECT s.robot_id, p.idx, p.size_bytes, CASE WHEN EXISTS (SELECT 1 FROM payload_held h WHERE "
                "h.session_number = p.session_number AND h.idx = p.idx) AND NOT EXISTS (SELECT 1 FROM waiting_blob w "
                "WHERE w.digest = p.digest) THEN 1 ELSE 0 END FROM payload p CROSS JOIN session s ON s.number = "
                "p.session_number WHERE p.digest = ? AND s.session_id = ? ORDER BY p.idx LIMIT 1");
    if (!query.Bind(digest, session).Step()) return std::nullopt;
    return NamedPayload{query.IdAt<RobotId>(0), static_cast<std::uint32_t>(query.Int(1)), query.Int(2),
                        query.Int(3) != 0};
  });
}

Result<std::string> LoadManifestText(Store& store, const SessionId& session) {
  return Load<std::string>(store, "session " + session.str(), [&]() -> Result<std::string> {
    Query query(store, "SELECT manifest FROM session WHERE session_id = ?");
    if (query.Bind(session).Step()) return query.Text(0);
    return Fail(ErrorCode::kNotFound, "session " + session.str() + " is not known", "Push the session folder.");
  });
}

Result<BatchPart> LoadBatchPart(Store& store, const BatchId& batch, std::int64_t first, std::int64_t limit) {
  return Load<BatchPart>(store, "batch " + batch.str(), [&]() -> Result<BatchPart> {
    Query known(store, "SELECT number, robot_id, item_count FROM batch WHERE batch_id = ?");
    if (!known.Bind(batch).Step())
      return Fail(ErrorCode::kNotFound, "batch " + batch.str() + " is not known", "Push its edges.");
    BatchPart part{known.IdAt<RobotId>(1), known.Int(2), {}};
    Query items(store,
                "SELECT i.idx, e.edge_id FROM batch_item i CROSS JOIN edge e ON e.number = i.edge_number WHERE "
                "i.batch_number = ? AND i.idx >= ? ORDER BY i.idx LIMIT ?");
    items.Bind(known.Int(0), first, limit);
    while (items.Step()) part.items.emplace_back(items.Int(0), items.IdAt<EdgeId>(1));
    return part;
  });
}

}  // namespace rigcal::storage
