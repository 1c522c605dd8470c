#include "storage/work/servers.h"

#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

std::string ServerSubject(const std::string& owner) { return "the server " + owner; }

std::int64_t ServerTime_ns(std::chrono::milliseconds time) { return std::chrono::nanoseconds(time).count(); }

void RemoveGone(Store& store) {
  Query(store, "DELETE FROM lease_server WHERE until_ns <= (SELECT now_ns FROM store_clock)").Run();
  Query(store, "DELETE FROM lease_receiver WHERE owner NOT IN (SELECT owner FROM lease_server)").Run();
  Query(store, "DELETE FROM waiting_announcement WHERE server NOT IN (SELECT owner FROM lease_server)").Run();
}

}  // namespace

Result<std::string> LoadStoreId(Store& store) {
  return Load<std::string>(store, "the id of the store", [&]() -> Result<std::string> {
    Query query(store, "SELECT store_id FROM lease_folder");
    return query.Step() ? query.Text(0) : std::string();
  });
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

}  // namespace rigcal::storage
