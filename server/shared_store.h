// A store on PostgreSQL that several processes work on: servers, and rigcal-worker that only calibrates.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "server/pipeline/step.h"
#include "storage/work/announcements.h"

namespace rigcal {

// What a process is called among those that share its store: this machine's name with `part`, which no other process on
// it has. Empty where the store is on SQLite, which one process has for itself.
[[nodiscard]] std::string OwnerName(const storage::StorePlace& place, const std::string& part);

// Tells what came of others' doing, from a thread of its own, as long as it lives.
class SharedStore {
 public:
  struct Told {
    std::function<void()> work = [] {};  // somebody put work into the store
    // Somebody who is not on DDS announces something; none: whoever waits for it is elsewhere.
    std::function<void(const storage::WaitingAnnouncement&)> announced = {};
  };
  // Null where the store is on SQLite, which has one process. Errors are the store's.
  [[nodiscard]] static Result<std::unique_ptr<SharedStore>> Follow(const storage::StorePlace& place, Told told);
  ~SharedStore();
  SharedStore(const SharedStore&) = delete;
  SharedStore& operator=(const SharedStore&) = delete;

 private:
  SharedStore(const storage::StorePlace& place, storage::Store store, Told told);
  void Run(const std::stop_token& stop);
  [[nodiscard]] bool TellWaiting();  // false: it has to be tried again

  storage::StorePlace place_;
  storage::Store store_;  // of the thread
  Told told_;
  std::jthread thread_;
};

// For a process that is not on DDS: puts into the store what is to be told there. Any thread.
[[nodiscard]] Result<pipeline::Announcer> AnnouncerThroughStore(const storage::StorePlace& place, const Clock& clock);

}  // namespace rigcal
