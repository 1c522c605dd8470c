// A store on PostgreSQL that several processes work on: servers, and rigcal-worker that only calibrates.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "server/pipeline/step.h"
#include "storage/work/servers.h"

namespace rigcal {

// What a process is called among those that share its store: this machine's name with `part`, which no other process on
// it has. Empty where the store is on SQLite, which one process has for itself.
[[nodiscard]] std::string OwnerName(const storage::StorePlace& place, const std::string& part);

// Tells what came of others' doing, from a thread of its own, as long as it lives.
class SharedStore {
 public:
  struct Told {
    std::function<void()> work = [] {};  // somebody put work into the store
    // Another process announces something that this server is to tell.
    std::function<void(const storage::WaitingAnnouncement&)> announced = {};
  };
  // Null where the store is on SQLite, which has one process. Errors are the store's. `server`: what it is listed as
  // meanwhile (storage/work/servers.h), from before this on; no name: it is no server, and none is told in its place.
  [[nodiscard]] static Result<std::unique_ptr<SharedStore>> Follow(const storage::StorePlace& place, Told told,
                                                                   const storage::SharingServer& server = {});
  ~SharedStore();
  SharedStore(const SharedStore&) = delete;
  SharedStore& operator=(const SharedStore&) = delete;

 private:
  SharedStore(const storage::StorePlace& place, storage::Store store, Told told, storage::SharingServer server);
  [[nodiscard]] Status StayListed();
  void Run(const std::stop_token& stop);
  [[nodiscard]] bool TellWaiting();  // false: it has to be tried again

  storage::StorePlace place_;
  storage::Store store_;  // of the thread
  Told told_;
  const storage::SharingServer server_;
  std::jthread thread_;
};

// Puts into the store what servers are to tell on DDS, but for `sender`, the one that calls it, if it is one. Any
// thread.
[[nodiscard]] Result<pipeline::Announcer> AnnouncerThroughStore(const storage::StorePlace& place, const Clock& clock,
                                                                const std::string& sender = {});
// Tells both, the first one first.
[[nodiscard]] pipeline::Announcer Both(pipeline::Announcer first, pipeline::Announcer second);

}  // namespace rigcal
