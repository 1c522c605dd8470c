#include "server/thread_store.h"

#include <optional>

namespace rigcal {

Result<storage::Store*> StoreOfThread(const storage::StorePlace& place) {
  thread_local std::optional<storage::Store> store;
  if (store) return &*store;
  RIGCAL_ASSIGN(store, storage::Store::Open(place));
  return &*store;
}

}  // namespace rigcal
