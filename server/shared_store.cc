#include "server/shared_store.h"

#include <condition_variable>

#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/thread_rank.h"
#include "server/http/public_address.h"
#include "storage/work/servers.h"

namespace rigcal {
namespace {

constexpr std::chrono::milliseconds kLookEvery{
    500};  // whether to stop, and, where the connection is gone, whether it is back
constexpr std::chrono::seconds kListAgain{10};  // several times before it is forgotten (storage::kServerTime)
const std::string kAnnouncements = "waiting_announcement";
// In which work comes from elsewhere.
const std::vector<std::string> kWork = {"waiting_job",     "waiting_revision",  "waiting_publication",
                                        "waiting_verdict", "waiting_rig_model", "waiting_recomputed_robot",
                                        "waiting_rerun"};

// One connection, for the threads that step.
class Outlet {
 public:
  Outlet(storage::Store store, const Clock& clock, std::string sender)
      : store_(std::move(store)), clock_(clock), sender_(std::move(sender)) {}
  void Put(storage::WaitingAnnouncement announcement) {
    const std::lock_guard lock(mutex_);
    announcement.at = clock_.Now();
    if (const Status put = storage::AppendAnnouncement(store_, announcement, sender_); !put) LogError(put.error());
  }

 private:
  std::mutex mutex_;
  storage::Store store_;
  const Clock& clock_;
  const std::string sender_;
};

}  // namespace

std::string OwnerName(const storage::StorePlace& place, const std::string& part) {
  return place.server.empty() ? "" : http::MachineName() + ":" + part;
}

SharedStore::SharedStore(const storage::StorePlace& place, storage::Store store, Told told,
                         storage::SharingServer server)
    : place_(place),
      store_(std::move(store)),
      told_(std::move(told)),
      server_(std::move(server)),
      thread_([this](const std::stop_token& stop) { Run(stop); }) {}

SharedStore::~SharedStore() {
  thread_.request_stop();
  thread_.join();
  if (server_.owner.empty()) return;
  if (const Status removed = storage::RemoveServer(store_, server_.owner); !removed) LogError(removed.error());
}

Result<std::unique_ptr<SharedStore>> SharedStore::Follow(const storage::StorePlace& place, Told told,
                                                         const storage::SharingServer& server) {
  if (place.server.empty()) return nullptr;
  RIGCAL_ASSIGN(storage::Store store, storage::Store::Open(place));
  return std::unique_ptr<SharedStore>(new SharedStore(place, std::move(store), std::move(told), server));
}

// One that stood still for too long is listed anew; what was to be told meanwhile is past.
Status SharedStore::StayListed() {
  if (server_.owner.empty()) return {};
  RIGCAL_ASSIGN(const bool is_listed, storage::RenewServer(store_, server_.owner));
  return is_listed ? Status() : storage::AppendServer(store_, server_);
}

void SharedStore::Run(const std::stop_token& stop) {
  SetThreadRank(ThreadRank::kServes);
  std::vector<std::string> queues = kWork;
  if (told_.announced) queues.push_back(kAnnouncements);
  storage::StoreChanges changes(place_, queues);
  std::mutex mutex;
  std::condition_variable_any stopped;
  bool was_there = true, is_to_tell = false;
  auto listed_at = std::chrono::steady_clock::now() - kListAgain;
  while (!stop.stop_requested()) {
    auto came = Guarded([&] { return changes.Await(kLookEvery); });
    if (!came && was_there) LogError(came.error());
    was_there = came.has_value();
    if (!came) {
      std::unique_lock lock(mutex);
      stopped.wait_for(lock, stop, kLookEvery, [] { return false; });
      continue;
    }
    if (std::chrono::steady_clock::now() - listed_at >= kListAgain) {
      listed_at = std::chrono::steady_clock::now();
      if (const Status listed = StayListed(); !listed) LogError(listed.error());
    }
    is_to_tell = came->erase(kAnnouncements) > 0 || is_to_tell;
    if (is_to_tell) is_to_tell = !TellWaiting();
    if (!came->empty()) told_.work();
  }
}

bool SharedStore::TellWaiting() {
  const auto taken = Guarded([&] { return storage::TakeAnnouncements(store_, server_.owner); });
  if (!taken) LogError(taken.error());
  if (!taken) return false;
  for (const storage::WaitingAnnouncement& one : *taken) OnceThereIsMemory([&] { told_.announced(one); });
  return true;
}

Result<pipeline::Announcer> AnnouncerThroughStore(const storage::StorePlace& place, const Clock& clock,
                                                  const std::string& sender) {
  RIGCAL_ASSIGN(storage::Store store, storage::Store::Open(place));
  const auto outlet = std::make_shared<Outlet>(std::move(store), clock, sender);
  pipeline::Announcer announcer;
  announcer.event = [outlet](const RobotId& robot, const std::string& kind, const std::string& subject,
                             const std::string& json) {
    outlet->Put({robot, kind, subject, json, {}});
  };
  announcer.state = [outlet](const RobotId& robot) { outlet->Put({robot, "", "", "", {}}); };
  return announcer;
}

pipeline::Announcer Both(pipeline::Announcer first, pipeline::Announcer second) {
  pipeline::Announcer both;
  both.event = [one = first.event, other = second.event](const RobotId& robot, const std::string& kind,
                                                         const std::string& subject, const std::string& json) {
    one(robot, kind, subject, json);
    other(robot, kind, subject, json);
  };
  both.state = [one = std::move(first.state), other = std::move(second.state)](const RobotId& robot) {
    one(robot);
    other(robot);
  };
  return both;
}

}  // namespace rigcal
