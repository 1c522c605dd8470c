#include "server/thread_store.h"

namespace rigcal {

Result<storage::Store*> StoreOfThread(const storage::StorePlace& place) {
  thread_local Result<storage::Store> store = storage::Store::Open(place);
  if (!store) store = storage::Store::Open(place);
  if (!store) return Fail(store.error());
  return &*store;
}

}  // namespace rigcal
