#include "storage/work/store_changes.h"

#include "storage/postgres/postgres_engine.h"

namespace rigcal::storage {

StoreChanges::StoreChanges(StorePlace place, std::vector<std::string> queues)
    : place_(std::move(place)), queues_(std::move(queues)) {}
StoreChanges::~StoreChanges() = default;

void StoreChanges::Listen() {
  link_ = std::make_unique<PostgresLink>(place_.server);
  for (const std::string& queue : queues_) link_->Execute("LISTEN " + queue);
}

Result<std::set<std::string>> StoreChanges::Await(std::chrono::milliseconds time) {
  try {
    if (link_) return link_->AwaitNotices(time);
    Listen();
    return std::set<std::string>(queues_.begin(), queues_.end());
  } catch (const PostgresFailure& failure) {
    link_.reset();
    return Fail(ErrorOf(failure, "the store at " + NameOf(place_)));
  }
}

}  // namespace rigcal::storage
