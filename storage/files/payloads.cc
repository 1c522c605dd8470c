#include <map>

#include "storage/database/query.h"
#include "storage/files/lost_blobs.h"
#include "storage/sessions/sessions.h"

namespace rigcal::storage {
namespace {

// A content that more sessions hold, an empty file say, tells nothing of whose it is.
constexpr std::int64_t kSessionsOfContentMax = 100;

struct PayloadList {
  std::int64_t session_number = 0;
  std::int64_t count = 0;
};

std::string PayloadsSubject(const SessionId& id) { return "payloads of session " + id.str(); }

Result<PayloadList> FindList(Store& store, const SessionId& id) {
  Query query(store, "SELECT number, payload_count FROM session WHERE session_id = ?");
  if (query.Bind(id).Step()) return PayloadList{query.Int(0), query.Int(1)};
  return Fail(ErrorCode::kNotFound, "session " + id.str() + " is not known", "Push the session folder.");
}

Status CheckIndices(const SessionId& id, const PayloadList& list, const std::vector<std::uint32_t>& payload_idx) {
  for (const std::uint32_t idx : payload_idx)
    if (idx >= list.count)
      return Fail(
          ErrorCode::kInvalidInput,
          "session " + id.str() + " has no payload " + std::to_string(idx) + ", only " + std::to_string(list.count),
          "Number the payloads as the manifest does, from 0.");
  return {};
}

void TakeOutLost(Store& store, std::int64_t session_number, std::vector<bool>& held) {
  Query query(
      store, "SELECT p.idx FROM waiting_blob w CROSS JOIN payload p ON p.digest = w.digest WHERE p.session_number = ?");
  query.Bind(session_number);
  while (query.Step()) held.at(static_cast<std::size_t>(query.Int(0))) = false;
}

Status InsertHeld(Store& store, std::int64_t session_number, std::uint32_t idx, Stamp now) {
  RIGCAL_TRY(EndLoss(store, session_number, idx));
  Query insert(store, "INSERT INTO payload_held VALUES (?, ?, ?) ON CONFLICT DO NOTHING");
  if (insert.Bind(session_number, idx, now).Run() == 0) return {};
  Query(store,
        "INSERT INTO robot_digest_held SELECT robot_id, digest, ? FROM payload "
        "JOIN session ON session.number = session_number WHERE session_number = ? AND idx = ? ON CONFLICT DO NOTHING")
      .Bind(now, session_number, idx)
      .Run();
  return {};
}

}  // namespace

Result<std::vector<bool>> LoadHeld(Store& store, const SessionId& id) {
  return Load<std::vector<bool>>(store, PayloadsSubject(id), [&]() -> Result<std::vector<bool>> {
    RIGCAL_ASSIGN(const PayloadList list, FindList(store, id));
    std::vector<bool> held(static_cast<std::size_t>(list.count), false);
    Query query(store, "SELECT idx FROM payload_held WHERE session_number = ?");
    query.Bind(list.session_number);
    while (query.Step()) held.at(static_cast<std::size_t>(query.Int(0))) = true;
    TakeOutLost(store, list.session_number, held);
    return held;
  });
}

Status AppendHeld(Store& store, const SessionId& id, const std::vector<std::uint32_t>& payload_idx, Stamp now) {
  return store.connection().Append(PayloadsSubject(id), [&]() -> Status {
    RIGCAL_ASSIGN(const PayloadList list, FindList(store, id));
    RIGCAL_TRY(CheckIndices(id, list, payload_idx));
    for (const std::uint32_t idx : payload_idx) RIGCAL_TRY(InsertHeld(store, list.session_number, idx, now));
    return {};
  });
}

Result<bool> IsHeld(Store& store, const RobotId& robot, const Digest& digest) {
  return Load<bool>(store, "payload " + digest.str(), [&]() -> Result<bool> {
    return Query(store,
                 "SELECT 1 FROM robot_digest_held h WHERE robot_id = ? AND digest = ? AND NOT EXISTS "
                 "(SELECT 1 FROM waiting_blob w WHERE w.digest = h.digest)")
        .Bind(robot, digest)
        .Step();
  });
}

Result<std::optional<HeldByAnother>> LoadHeldByAnother(Store& store, const RobotId& robot,
                                                       const std::set<Digest>& digests) {
  using Held = std::optional<HeldByAnother>;
  return Load<Held>(store, "files of other robots than " + robot.str(), [&]() -> Result<Held> {
    std::map<std::int64_t, HeldByAnother> by_session;
    for (const Digest& digest : digests) {
      Query query(store,
                  "SELECT DISTINCT s.number, s.robot_id, s.session_id, s.captured_ns FROM payload p "
                  "JOIN session s ON s.number = p.session_number JOIN session_closed c ON c.session_number = s.number "
                  "WHERE p.digest = ? AND s.robot_id <> ? LIMIT ?");
      query.Bind(digest, robot, kSessionsOfContentMax);
      while (query.Step()) {
        const HeldByAnother first{RobotId(query.Text(1)), SessionId(query.Text(2)), Stamp{query.Int(3)}, 0};
        ++by_session.try_emplace(query.Int(0), first).first->second.contents;
      }
    }
    Held most;
    for (const auto& [number, held] : by_session)
      if (!most || held.contents > most->contents) most = held;
    return most;
  });
}

}  // namespace rigcal::storage
