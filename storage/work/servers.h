// Several servers of one store: which share it now (each says so again and again, and who was killed is listed a minute
// longer; times are by the store's clock), what they have told on each other's networks, and that there is news.
#pragma once

#include <chrono>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "storage/store.h"
#include "storage/store_place.h"

namespace rigcal::storage {

struct SharingServer {
  std::string owner;                   // the process: no other of this store has its name
  std::vector<std::string> receivers;  // addresses that it sends alerts to
};

constexpr std::chrono::seconds kServerTime{60};

// What tells the store from every other; empty: it is on SQLite, and one process has it.
[[nodiscard]] Result<std::string> LoadStoreId(Store& store);

// Whether a server of a store on PostgreSQL is there, or somebody works on a robot. For storage/*.cc only, inside of a
// Load or an Append.
[[nodiscard]] bool IsAtWork(Connection& connection);

// It is there from now on, in the place of an earlier one of its name. What waited for servers that are gone waits no
// more.
[[nodiscard]] Status AppendServer(Store& store, const SharingServer& server,
                                  std::chrono::milliseconds time = kServerTime);
// It is still there. False: it is listed no more, as it stood still for too long. A transaction of its own, which waits
// for no other writer.
[[nodiscard]] Result<bool> RenewServer(Store& store, const std::string& owner,
                                       std::chrono::milliseconds time = kServerTime);
// It ends: nothing waits for it from now on.
[[nodiscard]] Status RemoveServer(Store& store, const std::string& owner);

// What a process that shares its store wants told on the DDS networks of servers: each of them takes it from the store
// and tells it.
struct WaitingAnnouncement {
  RobotId robot;
  std::string kind;  // of an event (Event::kind); empty: what is stored of the robot's calibration is another
  std::string subject, json;
  Stamp at;
};

// It waits for each server that is there, but for `sender`, which tells it itself. Where there is none it
// is told by nobody: an event is of the moment, and a state is told anew to whoever comes.
[[nodiscard]] Status AppendAnnouncement(Store& store, const WaitingAnnouncement& announcement,
                                        const std::string& sender = {});
// Those that wait for this server, in their order; they wait no more. Who ends before it told them has told nobody.
[[nodiscard]] Result<std::vector<WaitingAnnouncement>> TakeAnnouncements(Store& store, const std::string& server);

// Tells that another process put work into the store: PostgreSQL's LISTEN. SQLite has one process, and nothing to tell.
class PostgresLink;

// One thread at a time.
class StoreChanges {
 public:
  // Of these queues, by the names of their tables. `place` is one on PostgreSQL.
  StoreChanges(StorePlace place, std::vector<std::string> queues);
  ~StoreChanges();
  StoreChanges(const StoreChanges&) = delete;
  StoreChanges& operator=(const StoreChanges&) = delete;

  // Waits until something is put into one of them, `time` at most: into which. All of them when the connection is new,
  // for nobody knows what was missed. kStorage, at once, where there is none: the next call connects again.
  [[nodiscard]] Result<std::set<std::string>> Await(std::chrono::milliseconds time);

 private:
  void Listen();

  StorePlace place_;
  std::vector<std::string> queues_;
  std::unique_ptr<PostgresLink> link_;
};

}  // namespace rigcal::storage
