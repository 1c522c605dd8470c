#include "storage/sites/forward_queue.h"

#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

constexpr const char* kForwardSubject = "what is to be sent to the centre";
const std::string kBatchKind = "batch", kSessionKind = "session";

// Nothing waits longer than this between two tries: what would was noted before the clock was set back.
constexpr std::int64_t kForwardPauseMax_ns = 86'400'000'000'000;

std::string CentreNow(Store& store) {
  Query query(store, "SELECT url FROM centre ORDER BY number DESC LIMIT 1");
  return query.Step() ? query.Text(0) : std::string();
}

// All that is whole and that the centre of this address has not confirmed, in the order in which it became so; of no
// address: all.
void QueueAll(Store& store, const std::string& url) {
  Query(store,
        "INSERT INTO waiting_forward (kind, subject, robot_id, since_ns, next_try_ns, attempts, last_error) "
        "SELECT kind, subject, robot_id, since_ns, 0, 0, '' FROM (SELECT 'session' AS kind, s.session_id AS subject, "
        "s.robot_id AS robot_id, c.closed_ns AS since_ns FROM session_closed c CROSS JOIN session s ON s.number = "
        "c.session_number UNION ALL SELECT 'batch', b.batch_id, b.robot_id, b.appended_ns FROM batch b WHERE NOT "
        "EXISTS (SELECT 1 FROM waiting_batch w WHERE w.batch_number = b.number)) whole WHERE NOT EXISTS (SELECT 1 FROM "
        "forwarded f WHERE f.url = ? AND f.kind = whole.kind AND f.subject = whole.subject) ORDER BY since_ns, subject "
        "ON CONFLICT DO NOTHING")
      .Bind(url)
      .Run();
}

void AddCounts(Store& store, ForwardState& state) {
  Query counts(store,
               "SELECT count(*) FILTER (WHERE kind = 'session'), count(*) FILTER (WHERE kind = 'batch'), "
               "count(*) FILTER (WHERE next_try_ns > 0), min(since_ns) FROM waiting_forward");
  if (!counts.Step()) return;
  state.sessions_waiting = counts.Int(0);
  state.batches_waiting = counts.Int(1);
  state.refused = counts.Int(2);
  if (!counts.IsNull(3)) state.oldest_at = counts.Time(3);
}

}  // namespace

Status SetCentre(Store& store, const std::string& url, Stamp now) {
  return store.connection().Append(kForwardSubject, [&]() -> Status {
    Query(store, "UPDATE waiting_forward SET next_try_ns = 0 WHERE next_try_ns > 0").Run();
    if (CentreNow(store) == url) return {};
    Query(store, "INSERT INTO centre (url, at_ns) VALUES (?, ?)").Bind(url, now).Run();
    Query(store, "DELETE FROM waiting_forward").Run();
    if (!url.empty()) QueueAll(store, url);
    return {};
  });
}

Result<std::optional<WaitingForward>> LoadNextForward(Store& store, Stamp now) {
  using Next = std::optional<WaitingForward>;
  return Load<Next>(store, kForwardSubject, [&]() -> Result<Next> {
    Query query(store,
                "SELECT number, kind, subject, robot_id, attempts FROM waiting_forward WHERE next_try_ns <= ?1 OR "
                "next_try_ns > ?1 + " +
                    std::to_string(kForwardPauseMax_ns) + " ORDER BY number LIMIT 1");
    if (!query.Bind(now).Step()) return std::nullopt;
    return WaitingForward{query.Int(0), query.Text(1) == kBatchKind, query.Text(2), query.IdAt<RobotId>(3),
                          static_cast<int>(query.Int(4))};
  });
}

Status MarkForwarded(Store& store, const WaitingForward& one, Stamp now) {
  return store.connection().Append(kForwardSubject, [&]() -> Status {
    const std::string& kind = one.is_batch ? kBatchKind : kSessionKind;
    const int waited =
        Query(store, "DELETE FROM waiting_forward WHERE kind = ? AND subject = ?").Bind(kind, one.subject).Run();
    if (waited > 0)
      Query(store, "INSERT INTO forwarded (url, kind, subject, robot_id, at_ns) VALUES (?, ?, ?, ?, ?)")
          .Bind(CentreNow(store), kind, one.subject, one.robot, now)
          .Run();
    return {};
  });
}

Result<std::vector<WaitingForward>> LoadNewestForwarded(Store& store) {
  using Newest = std::vector<WaitingForward>;
  return Load<Newest>(store, kForwardSubject, [&]() -> Result<Newest> {
    Query query(store,
                "SELECT f.kind, f.subject, f.robot_id FROM (SELECT number, kind, subject, robot_id, row_number() OVER "
                "(PARTITION BY robot_id ORDER BY number DESC) AS place FROM forwarded WHERE url = ?) f WHERE f.place "
                "<= 2 ORDER BY f.number DESC LIMIT 100");
    query.Bind(CentreNow(store));
    Newest newest;
    while (query.Step()) newest.push_back({0, query.Text(0) == kBatchKind, query.Text(1), query.IdAt<RobotId>(2), 0});
    return newest;
  });
}

Status ForwardAgain(Store& store) {
  return store.connection().Append(kForwardSubject, [&]() -> Status {
    QueueAll(store, "");
    return {};
  });
}

Status NoteForwardFailure(Store& store, const WaitingForward& one, const std::string& error, Stamp next_try_at,
                          Stamp now) {
  return store.connection().Append(kForwardSubject, [&]() -> Status {
    Query(store,
          "UPDATE waiting_forward SET attempts = attempts + 1, failing_ns = coalesce(failing_ns, ?), last_error = ?, "
          "next_try_ns = ? WHERE kind = ? AND subject = ?")
        .Bind(now, error, next_try_at, one.is_batch ? kBatchKind : kSessionKind, one.subject)
        .Run();
    return {};
  });
}

Result<std::optional<ForwardState>> LoadForwardState(Store& store) {
  using State = std::optional<ForwardState>;
  return Load<State>(store, kForwardSubject, [&]() -> Result<State> {
    ForwardState state;
    state.url = CentreNow(store);
    if (state.url.empty()) return std::nullopt;
    AddCounts(store, state);
    Query failing(store,
                  "SELECT failing_ns, last_error, next_try_ns FROM waiting_forward WHERE last_error <> '' ORDER BY "
                  "next_try_ns > 0, number LIMIT 1");
    if (!failing.Step()) return state;
    state.last_error = failing.Text(1);
    if (failing.Int(2) == 0) state.failing_since = failing.Time(0);
    return state;
  });
}

}  // namespace rigcal::storage
