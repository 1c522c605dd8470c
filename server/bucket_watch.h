// Whether the bucket with the store's blobs can be used (--blobs): at the start, and as long as the server runs.
#pragma once

#include <memory>
#include <thread>

#include "server/base/process/vitals.h"
#include "storage/store.h"

namespace rigcal {

// What a person has to mend is an error: a wrong key, no such bucket, that of another store. One that is out of reach
// is logged: reading what this machine has goes on without it. Good where the store has none.
[[nodiscard]] Status BeginWithBucket(storage::Store& store);

// Asks it every five seconds and tells `vitals`, so that /readyz says why nothing is acknowledged.
class BucketWatch {
 public:
  // Null where the place has no bucket. `vitals` outlives it.
  [[nodiscard]] static Result<std::unique_ptr<BucketWatch>> Start(const storage::StorePlace& place, Vitals& vitals);
  BucketWatch(const BucketWatch&) = delete;
  BucketWatch& operator=(const BucketWatch&) = delete;

 private:
  BucketWatch(storage::Store store, Part& part);
  void Run(const std::stop_token& stop);

  storage::Store store_;  // of the thread
  Part& part_;
  std::jthread thread_;
};

}  // namespace rigcal
