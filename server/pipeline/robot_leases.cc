#include "server/pipeline/robot_leases.h"

#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "storage/work/attempts.h"

namespace rigcal::pipeline {
namespace {

// Twice may fail before the time of a lease is over.
constexpr std::chrono::seconds kRenewEvery{3};

}  // namespace

RobotLeases::RobotLeases(storage::Store store, const Clock& clock, std::string owner)
    : store_(std::move(store)), clock_(clock), owner_(std::move(owner)), thread_([this] { Renew(); }) {}

RobotLeases::~RobotLeases() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stop_.notify_all();
  thread_.join();
}

Result<std::unique_ptr<RobotLeases>> RobotLeases::Start(const storage::StorePlace& place, const Clock& clock,
                                                        std::string owner) {
  RIGCAL_ASSIGN(storage::Store store, storage::Store::Open(place));
  return std::unique_ptr<RobotLeases>(new RobotLeases(std::move(store), clock, std::move(owner)));
}

void RobotLeases::Renew() {
  GoRound(nullptr, [this] {
    std::vector<storage::Lease> held;
    {
      std::unique_lock lock(mutex_);
      if (stop_.wait_for(lock, kRenewEvery, [&] { return stopping_; })) return false;
      for (const auto& [robot, lease] : held_) held.push_back(lease);
    }
    if (held.empty()) return true;
    if (const Status renewed = storage::RenewLeases(store_, held); !renewed) LogError(renewed.error());
    return true;
  });
}

std::optional<storage::Lease> RobotLeases::Take(storage::Store& store, const RobotId& robot) {
  std::optional<storage::Lease> lease;
  // What the last owner left open is closed in the same transaction: it cannot be this one's by then.
  const Status taken = store.Write([&]() -> Status {
    RIGCAL_ASSIGN(lease, storage::TakeLease(store, robot, owner_));
    if (lease && !lease->lost_by.empty())
      return storage::EndKilledAttempts(store, robot, clock_.Now()).map([](const auto&) {});
    return {};
  });
  if (!taken) LogError(taken.error());
  if (!taken || !lease) return std::nullopt;
  if (!lease->lost_by.empty())
    LogWarn("robot " + robot.str() + " is taken over from " +
            (lease->lost_by == owner_ ? "this process's last run" : lease->lost_by) + ", which is gone or stood still");
  const std::lock_guard lock(mutex_);
  held_.insert_or_assign(robot, *lease);
  return lease;
}

void RobotLeases::GiveBack(storage::Store& store, const storage::Lease& lease) {
  {
    const std::lock_guard lock(mutex_);
    held_.erase(lease.robot);
  }
  const Status given = Guarded([&] { return storage::GiveBackLease(store, lease); });
  if (!given) LogError(given.error());
}

std::optional<storage::Lease> RobotLeases::HeldOf(const RobotId& robot) const {
  const std::lock_guard lock(mutex_);
  const auto found = held_.find(robot);
  return found == held_.end() ? std::nullopt : std::optional(found->second);
}

LeasedRobot::LeasedRobot(RobotLocks& locks, RobotLeases* leases, storage::Store& store, const RobotId& robot)
    : lock_(locks, robot), leases_(leases), store_(store) {
  if (leases_ == nullptr || !lock_.taken()) return;
  lease_ = leases_->Take(store, robot);
  if (lease_) fenced_.emplace(store, *lease_);
}

LeasedRobot::~LeasedRobot() {
  fenced_.reset();
  if (lease_) leases_->GiveBack(store_, *lease_);
}

}  // namespace rigcal::pipeline
