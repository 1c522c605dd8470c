#include "server/bucket_watch.h"

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/thread_rank.h"
#include "storage/s3/store_bucket.h"

namespace rigcal {
namespace {

constexpr std::chrono::seconds kAskAgain{5}, kAskedWithin{120};

}  // namespace

Status BeginWithBucket(storage::Store& store) {
  const Status checked = storage::CheckBlobs(store);
  if (checked || checked.error().code != ErrorCode::kUnreachable) return checked;
  LogError(checked.error());
  return {};
}

BucketWatch::BucketWatch(storage::Store store, Part& part)
    : store_(std::move(store)), part_(part), thread_([this](const std::stop_token& stop) { Run(stop); }) {}

Result<std::unique_ptr<BucketWatch>> BucketWatch::Start(const storage::StorePlace& place, Vitals& vitals) {
  if (place.bucket.empty()) return nullptr;
  RIGCAL_ASSIGN(storage::Store store, storage::Store::Open(place));
  return std::unique_ptr<BucketWatch>(new BucketWatch(std::move(store), vitals.Expect("bucket", kAskedWithin)));
}

void BucketWatch::Run(const std::stop_token& stop) {
  SetThreadRank(ThreadRank::kServes);
  std::mutex mutex;
  std::condition_variable_any stopped;
  while (!stop.stop_requested()) {
    Status checked = Guarded([this] { return storage::CheckBlobs(store_); });
    checked ? part_.Turn() : part_.Fail(std::move(checked).error());
    std::unique_lock lock(mutex);
    stopped.wait_for(lock, stop, kAskAgain, [] { return false; });
  }
}

}  // namespace rigcal
