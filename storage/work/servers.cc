#include "storage/work/servers.h"

#include "storage/database/query.h"
#include "storage/postgres/postgres_engine.h"

namespace rigcal::storage {
namespace {

std::string ServerSubject(const std::string& owner) { return "the server " + owner; }

std::int64_t ServerTime_ns(std::chrono::milliseconds time) { return std::chrono::nanoseconds(time).count(); }

void RemoveGone(Store& store) {
  Query(store, "DELETE FROM lease_server WHERE until_ns <= (SELECT now_ns FROM store_clock)").Run();
  Query(store, "DELETE FROM lease_receiver WHERE owner NOT IN (SELECT owner FROM lease_server)").Run();
  Query(store, "DELETE FROM waiting_announcement WHERE server NOT IN (SELECT owner FROM lease_server)").Run();
}

const std::string kAnnouncementsSubject = "announcements";

Result<bool> HasAnnouncements(Store& store, const std::string& server) {
  return Load<bool>(store, kAnnouncementsSubject, [&]() -> Result<bool> {
    return Query(store, "SELECT 1 FROM waiting_announcement WHERE server = ? LIMIT 1").Bind(server).Step();
  });
}

// Without a write where nobody is there to be told.
Result<bool> IsHeard(Store& store, const std::string& sender) {
  return Load<bool>(store, kAnnouncementsSubject, [&]() -> Result<bool> {
    Query query(store,
                "SELECT 1 FROM lease_server WHERE until_ns > (SELECT now_ns FROM store_clock) AND owner <> ? LIMIT 1");
    return query.Bind(sender).Step();
  });
}

}  // namespace

Result<std::string> LoadStoreId(Store& store) {
  return Load<std::string>(store, "the id of the store", [&]() -> Result<std::string> {
    Query query(store, "SELECT store_id FROM lease_folder");
    return query.Step() ? query.Text(0) : std::string();
  });
}

bool IsAtWork(Connection& connection) {
  Query query(connection,
              "SELECT (SELECT count(*) FROM lease_server WHERE until_ns > (SELECT now_ns FROM store_clock)) + "
              "(SELECT count(*) FROM lease_robot WHERE owner <> '' AND until_ns > (SELECT now_ns FROM store_clock))");
  return query.Step() && query.Int(0) > 0;
}

Status AppendServer(Store& store, const SharingServer& server, std::chrono::milliseconds time) {
  return store.connection().Append(ServerSubject(server.owner), [&]() -> Status {
    RemoveGone(store);
    Query(store,
          "INSERT INTO lease_server SELECT ?, now_ns + ? FROM store_clock WHERE true ON CONFLICT (owner) DO UPDATE SET "
          "until_ns = excluded.until_ns")
        .Bind(server.owner, ServerTime_ns(time))
        .Run();
    Query(store, "DELETE FROM lease_receiver WHERE owner = ?").Bind(server.owner).Run();
    for (const std::string& url : server.receivers)
      Query(store, "INSERT INTO lease_receiver VALUES (?, ?) ON CONFLICT DO NOTHING").Bind(server.owner, url).Run();
    return {};
  });
}

Result<bool> RenewServer(Store& store, const std::string& owner, std::chrono::milliseconds time) {
  bool is_listed = false;
  RIGCAL_TRY(store.connection().WriteBeside([&]() -> Status {
    Query query(store, "UPDATE lease_server SET until_ns = (SELECT now_ns FROM store_clock) + ? WHERE owner = ?");
    is_listed = query.Bind(ServerTime_ns(time), owner).Run() > 0;
    return {};
  }));
  return is_listed;
}

Status RemoveServer(Store& store, const std::string& owner) {
  return store.connection().Append(ServerSubject(owner), [&]() -> Status {
    Query(store, "DELETE FROM lease_server WHERE owner = ?").Bind(owner).Run();
    RemoveGone(store);
    return {};
  });
}

Status AppendAnnouncement(Store& store, const WaitingAnnouncement& announcement, const std::string& sender) {
  RIGCAL_ASSIGN(const bool is_heard, IsHeard(store, sender));
  if (!is_heard) return {};
  return store.connection().Append("an announcement of robot " + announcement.robot.str(), [&]() -> Status {
    Query(store,
          "INSERT INTO waiting_announcement (robot_id, kind, subject, json, at_ns, server) SELECT ?, ?, ?, ?, ?, owner "
          "FROM lease_server WHERE until_ns > (SELECT now_ns FROM store_clock) AND owner <> ? ORDER BY owner")
        .Bind(announcement.robot, announcement.kind, announcement.subject, announcement.json, announcement.at, sender)
        .Run();
    return {};
  });
}

Result<std::vector<WaitingAnnouncement>> TakeAnnouncements(Store& store, const std::string& server) {
  using Taken = std::vector<WaitingAnnouncement>;
  RIGCAL_ASSIGN(const bool are_some, HasAnnouncements(store, server));
  if (!are_some) return Taken();
  return Append<Taken>(store, kAnnouncementsSubject, [&]() -> Result<Taken> {
    Query query(store,
                "SELECT robot_id, kind, subject, json, at_ns FROM waiting_announcement WHERE server = ? ORDER BY "
                "number");
    Taken taken;
    query.Bind(server);
    while (query.Step())
      taken.push_back({query.IdAt<RobotId>(0), query.Text(1), query.Text(2), query.Text(3), query.Time(4)});
    Query(store, "DELETE FROM waiting_announcement WHERE server = ?").Bind(server).Run();
    return taken;
  });
}

StoreChanges::StoreChanges(StorePlace place, std::vector<std::string> queues)
    : place_(std::move(place)), queues_(std::move(queues)) {}
StoreChanges::~StoreChanges() = default;

void StoreChanges::Listen() {
  link_ = std::make_unique<PostgresLink>(place_.server);
  for (const std::string& queue : queues_) link_->Execute("LISTEN " + queue);
}

Result<std::set<std::string>> StoreChanges::Await(std::chrono::milliseconds time) {
  try {
    if (link_) return link_->AwaitNotices(time);
    Listen();
    return std::set<std::string>(queues_.begin(), queues_.end());
  } catch (const PostgresFailure& failure) {
    link_.reset();
    return Fail(ErrorOf(failure, "the store at " + NameOf(place_)));
  }
}

}  // namespace rigcal::storage
