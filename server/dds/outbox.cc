#include "server/dds/outbox.h"

#include "server/base/log.h"

namespace rigcal::dds {
namespace {

constexpr std::size_t kLiveRobotsMax = 16'000;  // a participant may have 16,382 publishers
constexpr std::size_t kFinishedReceiptsMax = 4'096;
constexpr std::chrono::seconds kQuietFor{5}, kLookEvery{1};
const RobotId kNoRobot("!");  // no robot may be called that

}  // namespace

const std::vector<std::string>& Outbox::Topics() {
  static const std::vector<std::string> topics = {wire::InfoOf<rigcal_wire_Receipt>().name, wire::InfoOf<rigcal_wire_Event>().name,
                                                  wire::InfoOf<rigcal_wire_Calibration>().name,
                                                  wire::InfoOf<rigcal_wire_RobotStatus>().name};
  return topics;
}

Outbox::Writers Outbox::Find(const RobotId& robot) {
  const std::lock_guard lock(mutex_);
  const auto known = robots_.find(robot);
  return known == robots_.end() ? nullptr : known->second;
}

Outbox::Writers Outbox::Opened(const RobotId& robot) {
  const std::lock_guard lock(mutex_);
  const auto known = robots_.find(robot);
  if (known != robots_.end()) return known->second;
  if (robots_.size() >= kLiveRobotsMax) {
    LogWarn("robot " + robot.str() + ": " + std::to_string(kLiveRobotsMax) + " robots are listened to already, this one is not answered");
    return nullptr;
  }
  auto opened = RobotWriters::Open(participant_, robot);
  if (!opened) {
    LogError(opened.error());
    return nullptr;
  }
  met_(robot);
  return robots_.emplace(robot, std::move(*opened)).first->second;
}

Outbox::Writers Outbox::Heard(const RobotId& robot) {
  if (Writers writers = Find(robot)) return writers;
  {
    const std::lock_guard lock(mutex_);
    if (of_all_ == nullptr) {
      auto opened = RobotWriters::Open(participant_, kNoRobot);
      if (!opened) LogError(opened.error());
      if (opened) of_all_ = std::move(*opened);
    }
    if (of_all_ == nullptr || !of_all_->HasReaders()) return nullptr;
  }
  return Opened(robot);
}

void Outbox::Send(const RobotId& partition, wire::Receipt receipt) {
  const Writers writers = Opened(partition);
  if (writers == nullptr) return;
  receipt.sequence_number = ++sequence_number_;
  writers->Send(receipt);
  // A refusal is an answer to one request, not a state that a later client should find.
  if (receipt.state == wire::ReceiptState::kRefused) writers->Forget(receipt);
  if (receipt.state == wire::ReceiptState::kClosed) ForgetOldest(partition, receipt);
}

// A client that comes later sends its header again, so it is answered even if its receipt was forgotten here.
void Outbox::ForgetOldest(const RobotId& partition, const wire::Receipt& receipt) {
  Finished oldest;
  {
    const std::lock_guard lock(mutex_);
    finished_.push_back({partition, {}});
    finished_.back().receipt.robot = receipt.robot;
    finished_.back().receipt.subject_id = receipt.subject_id;
    if (finished_.size() <= kFinishedReceiptsMax) return;
    oldest = std::move(finished_.front());
    finished_.pop_front();
  }
  if (const Writers writers = Find(oldest.partition)) writers->Forget(oldest.receipt);
}

void Outbox::Send(const Announcement& announcement) {
  if (const Writers writers = Heard(announcement.robot)) writers->Send(announcement, ++sequence_number_);
}

void Outbox::Tell(const RobotState& state) {
  if (const Writers writers = Heard(state.newest.robot)) writers->Tell(state);
}

// What is ended ends outside the lock: DDS may wait for others then.
void Outbox::CloseQuiet() {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_look_) return;
  next_look_ = now + kLookEvery;
  std::vector<Writers> ended;
  const std::lock_guard lock(mutex_);
  for (auto one = robots_.begin(); one != robots_.end();) {
    const bool quiet = one->second->QuietSince(now) + kQuietFor < now;
    if (quiet) ended.push_back(std::move(one->second));
    one = quiet ? robots_.erase(one) : std::next(one);
  }
}

}  // namespace rigcal::dds
