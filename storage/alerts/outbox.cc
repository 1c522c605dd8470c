#include "storage/alerts/outbox.h"

#include <algorithm>

#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

constexpr const char* kOutboxSubject = "the alerts";
const std::string kToldNow =
    "SELECT url FROM webhook w WHERE is_told = 1 AND number = (SELECT max(number) FROM webhook o WHERE o.url = w.url)";
// The oldest of its robot: what comes later waits for it.
const std::string kIsHead =
    "NOT EXISTS (SELECT 1 FROM waiting_alert e WHERE e.url = w.url AND e.robot_id = w.robot_id AND e.alert_number < "
    "w.alert_number)";

const std::string kIsClaimed =
    "EXISTS (SELECT 1 FROM lease_alert c WHERE c.url = w.url AND c.alert_number = w.alert_number AND c.until_ns > "
    "(SELECT "
    "now_ns FROM store_clock))";

// Nothing waits longer than this between two tries: what would was noted before the clock was set back.
constexpr std::int64_t kPauseMax_ns = 86'400'000'000'000;

std::int64_t NextAlertNumber(Store& store) {
  Query query(store, "SELECT coalesce(max(number), 0) + 1 FROM alert");
  return query.Step() ? query.Int(0) : 1;
}

// Columns number, id, robot_id, kind, subject, at_ns, body.
Alert AlertAt(const Query& query) {
  return {query.Int(0),  query.IdAt<Digest>(1), query.IdAt<RobotId>(2), query.Text(3),
          query.Text(4), query.Time(5),         query.Text(6)};
}

std::vector<std::string> ReceiversNow(Store& store) {
  Query query(store, kToldNow + " ORDER BY url");
  std::vector<std::string> urls;
  while (query.Step()) urls.push_back(query.Text(0));
  return urls;
}

void SayOfReceiver(Store& store, const std::string& url, bool is_told, Stamp now) {
  Query(store, "INSERT INTO webhook (url, at_ns, is_told) VALUES (?, ?, ?)").Bind(url, now, is_told).Run();
}

bool IsAmong(const std::vector<std::string>& urls, const std::string& url) {
  return std::find(urls.begin(), urls.end(), url) != urls.end();
}

// Those of servers that share the store, this one's among them.
std::vector<std::string> ReceiversOfServers(Store& store) {
  Query query(store,
              "SELECT DISTINCT r.url FROM lease_receiver r CROSS JOIN lease_server s ON s.owner = r.owner WHERE "
              "s.until_ns > (SELECT now_ns FROM store_clock) ORDER BY r.url");
  std::vector<std::string> urls;
  while (query.Step()) urls.push_back(query.Text(0));
  return urls;
}

// Somebody tried it.
void EndClaim(Store& store, const std::string& url, std::int64_t number) {
  Query(store, "DELETE FROM lease_alert WHERE url = ? AND alert_number = ?").Bind(url, number).Run();
}

ReceiverState StateOfReceiver(Store& store, const std::string& url, bool is_told) {
  ReceiverState state;
  state.url = ShownUrl(url);
  state.is_told = is_told;
  Query waiting(
      store,
      "SELECT count(*), (SELECT a.at_ns FROM waiting_alert o CROSS JOIN alert a ON a.number = o.alert_number WHERE "
      "o.url = ?1 ORDER BY o.alert_number LIMIT 1), max(w.attempts), min(w.next_try_ns) FILTER (WHERE "
      "w.next_try_ns > 0) FROM waiting_alert w WHERE w.url = ?1");
  if (waiting.Bind(url).Step() && waiting.Int(0) > 0) {
    state.waiting = waiting.Int(0);
    state.oldest_at = waiting.Time(1);
    state.attempts = static_cast<int>(waiting.Int(2));
    if (!waiting.IsNull(3)) state.next_try_at = waiting.Time(3);
  }
  Query error(
      store,
      "SELECT last_error FROM waiting_alert WHERE url = ? AND last_error <> '' ORDER BY next_try_ns DESC LIMIT 1");
  if (error.Bind(url).Step()) state.last_error = error.Text(0);
  Query delivered(store, "SELECT delivered FROM summary_delivered WHERE url = ?");
  if (delivered.Bind(url).Step()) state.delivered = delivered.Int(0);
  return state;
}

}  // namespace

Status AppendAlert(Store& store, const formats::AlertDraft& draft) {
  return store.connection().Append(kOutboxSubject, [&]() -> Status {
    const Alert alert = formats::AlertOf(draft, NextAlertNumber(store));
    Query(store, "INSERT INTO alert VALUES (?, ?, ?, ?, ?, ?, ?)")
        .Bind(alert.number, alert.id, alert.robot, alert.kind, alert.subject, alert.at, alert.body)
        .Run();
    return {};
  });
}

Result<bool> HasAlert(Store& store, const RobotId& robot, const std::string& kind, const std::string& subject) {
  return Load<bool>(store, kOutboxSubject, [&]() -> Result<bool> {
    Query query(store, "SELECT 1 FROM alert WHERE robot_id = ? AND kind = ? AND subject = ? LIMIT 1");
    return query.Bind(robot, kind, subject).Step();
  });
}

Status SetReceivers(Store& store, const std::vector<std::string>& urls, Stamp now) {
  return store.connection().Append(kOutboxSubject, [&]() -> Status {
    const std::vector<std::string> told = ReceiversNow(store);
    const std::vector<std::string> of_servers = ReceiversOfServers(store);
    for (const std::string& url : told)
      if (!IsAmong(urls, url) && !IsAmong(of_servers, url)) SayOfReceiver(store, url, false, now);
    for (const std::string& url : urls) {
      if (!IsAmong(told, url)) SayOfReceiver(store, url, true, now);
      Query(store, "UPDATE waiting_alert SET next_try_ns = 0 WHERE url = ? AND next_try_ns > 0").Bind(url).Run();
    }
    return {};
  });
}

Result<std::optional<WaitingAlert>> LoadNextAlert(Store& store, const std::string& url, Stamp now) {
  using Next = std::optional<WaitingAlert>;
  return Load<Next>(store, kOutboxSubject, [&]() -> Result<Next> {
    Query query(store,
                "SELECT number, id, a.robot_id, kind, subject, at_ns, body, attempts FROM waiting_alert w "
                "CROSS JOIN alert a ON a.number = w.alert_number WHERE w.url = ?1 AND (w.next_try_ns <= ?2 OR "
                "w.next_try_ns > ?2 + " +
                    std::to_string(kPauseMax_ns) + ") AND " + kIsHead + " AND NOT " + kIsClaimed +
                    " ORDER BY w.alert_number LIMIT 1");
    if (!query.Bind(url, now).Step()) return std::nullopt;
    return WaitingAlert{AlertAt(query), static_cast<int>(query.Int(7))};
  });
}

Result<bool> ClaimAlert(Store& store, const std::string& url, std::int64_t number, std::chrono::milliseconds time) {
  return Append<bool>(store, kOutboxSubject, [&]() -> Result<bool> {
    Query query(
        store,
        "INSERT INTO lease_alert SELECT w.url, w.alert_number, c.now_ns + ? FROM waiting_alert w CROSS JOIN "
        "store_clock c ON true WHERE w.url = ? AND w.alert_number = ? ON CONFLICT (url, alert_number) DO UPDATE "
        "SET until_ns = excluded.until_ns WHERE lease_alert.until_ns <= (SELECT now_ns FROM store_clock)");
    return query.Bind(std::chrono::nanoseconds(time).count(), url, number).Run() > 0;
  });
}

Status MarkDelivered(Store& store, const std::string& url, std::int64_t number, int http_status, Stamp now) {
  return store.connection().Append(kOutboxSubject, [&]() -> Status {
    EndClaim(store, url, number);
    const int waited =
        Query(store, "DELETE FROM waiting_alert WHERE url = ? AND alert_number = ?").Bind(url, number).Run();
    if (waited > 0)
      Query(store, "INSERT INTO alert_delivered VALUES (?, ?, ?, ?)").Bind(url, number, now, http_status).Run();
    return {};
  });
}

Status NoteAttempt(Store& store, const std::string& url, std::int64_t number, const std::string& error,
                   Stamp next_try_at) {
  return store.connection().Append(kOutboxSubject, [&]() -> Status {
    EndClaim(store, url, number);
    Query(store,
          "UPDATE waiting_alert SET attempts = attempts + 1, next_try_ns = ?, last_error = ? WHERE url = ? AND "
          "alert_number = ?")
        .Bind(next_try_at, error, url, number)
        .Run();
    return {};
  });
}

std::string ShownUrl(const std::string& url) { return url.substr(0, url.find('?')); }

Result<std::vector<ReceiverState>> LoadReceivers(Store& store) {
  using States = std::vector<ReceiverState>;
  return Load<States>(store, kOutboxSubject, [&]() -> Result<States> {
    const std::vector<std::string> told = ReceiversNow(store);
    std::vector<std::string> urls = told;
    Query waiting(store, "SELECT DISTINCT url FROM waiting_alert");
    while (waiting.Step())
      if (!IsAmong(told, waiting.Text(0))) urls.push_back(waiting.Text(0));
    std::sort(urls.begin(), urls.end());
    States states;
    for (const std::string& url : urls) states.push_back(StateOfReceiver(store, url, IsAmong(told, url)));
    return states;
  });
}

}  // namespace rigcal::storage
