#include "server/thread_store.h"

namespace rigcal {

Result<storage::Store*> StoreOfThread(const std::filesystem::path& folder) {
  thread_local Result<storage::Store> store = storage::Store::Open(folder);
  if (!store) store = storage::Store::Open(folder);
  if (!store) return Fail(store.error());
  return &*store;
}

}  // namespace rigcal
