// Which servers share the store now: each says so again and again, and who was killed is listed a minute longer. Times
// are by the store's clock.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "storage/store.h"

namespace rigcal::storage {

struct SharingServer {
  std::string owner;                   // the process: no other of this store has its name
  std::vector<std::string> receivers;  // addresses that it sends alerts to
};

constexpr std::chrono::seconds kServerTime{60};

// What tells the store from every other; empty: it is on SQLite, and one process has it.
[[nodiscard]] Result<std::string> LoadStoreId(Store& store);

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

}  // namespace rigcal::storage
