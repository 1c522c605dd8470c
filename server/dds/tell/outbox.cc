#include "server/dds/tell/outbox.h"

#include "server/base/log.h"
#include "server/dds/tell/receipts.h"
#include "server/metrics/noted.h"

namespace rigcal::dds {
namespace {

constexpr std::size_t kFinishedReceiptsMax = 4'096;
constexpr std::chrono::seconds kQuietFor{5}, kLookEvery{1};

}  // namespace

const std::vector<std::string>& Outbox::Topics() {
  static const std::vector<std::string> topics = {
      wire::InfoOf<rigcal_wire_Receipt>().name, wire::InfoOf<rigcal_wire_Event>().name,
      wire::InfoOf<rigcal_wire_Calibration>().name, wire::InfoOf<rigcal_wire_RobotStatus>().name};
  return topics;
}

void Outbox::NoteReadersOfMany(const std::set<dds_instance_handle_t>& readers) {
  const std::lock_guard lock(mutex_);
  if (of_many_ != readers) of_many_ = readers;
}

bool Outbox::IsHeardOf(const RobotId& robot) {
  const std::lock_guard lock(mutex_);
  return !of_many_.empty() || listened_to_.count(robot) > 0;
}

Outbox::Writers Outbox::Find(const RobotId& robot) {
  const std::lock_guard lock(mutex_);
  const auto known = listened_to_.find(robot);
  return known == listened_to_.end() ? nullptr : known->second.writers;
}

Outbox::Writers Outbox::Opened(const RobotId& robot) {
  auto opened = RobotWriters::Open(participant_, robot);
  if (opened) return std::move(*opened);
  LogError(opened.error());
  return nullptr;
}

// Once, until there is room again.
void Outbox::WarnFull(const std::string& warning) {
  if (!full_) LogWarn(warning);
  full_ = true;
}

// DDS tells of a reader before it has matched it with writers that are there: they must not end before it does, as
// nobody tells of that reader again.
Outbox::Writers Outbox::ListenedTo(const RobotId& robot) {
  const std::lock_guard lock(mutex_);
  auto known = listened_to_.find(robot);
  if (known == listened_to_.end()) {
    if (listened_to_.size() >= limits_.listened_to) {
      WarnFull("robot " + robot.str() + ": " + std::to_string(limits_.listened_to) +
               " robots are listened to already, this one is not answered");
      return nullptr;
    }
    const auto heard = with_news_.extract(robot);
    Writers writers = heard ? heard.mapped().writers : Opened(robot);
    if (writers == nullptr) return nullptr;
    met_(robot);  // whoever tells it waits until it is listened to
    known = listened_to_.emplace(robot, Live{std::move(writers), {}}).first;
  }
  known->second.quiet_since = now_();
  return known->second.writers;
}

Outbox::Writers Outbox::WithNews(const RobotId& robot) {
  const std::lock_guard lock(mutex_);
  if (const auto known = listened_to_.find(robot); known != listened_to_.end()) return known->second.writers;
  if (of_many_.empty()) return nullptr;
  auto known = with_news_.find(robot);
  if (known == with_news_.end()) {
    if (with_news_.size() >= limits_.with_news) {
      WarnFull("robot " + robot.str() + ": " + std::to_string(limits_.with_news) +
               " robots have news at once, who reads of many robots does not hear of this one");
      return nullptr;
    }
    Writers writers = Opened(robot);
    if (writers == nullptr) return nullptr;
    known = with_news_.emplace(robot, Live{std::move(writers), {}}).first;
  }
  known->second.quiet_since = now_();
  return known->second.writers;
}

void Outbox::Send(const RobotId& partition, wire::Receipt receipt) {
  const bool is_taken = receipt_sent_ && receipt_sent_(receipt);
  if (is_taken && Find(partition) == nullptr) return metrics::NoteReceipt(NameOf(receipt.state));
  const Writers writers = ListenedTo(partition);
  if (writers == nullptr) return;
  receipt.sequence_number = ++sequence_number_;
  metrics::NoteReceipt(NameOf(receipt.state));  // before: who has the receipt finds it counted
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

void Outbox::HoldAnnouncements(std::chrono::milliseconds time) {
  const std::lock_guard lock(mutex_);
  held_until_ = now_() + time;
}

// What comes while others are still held is not sent before them.
bool Outbox::Held(const Announcement& announcement) {
  const std::lock_guard lock(mutex_);
  if (held_.empty() && !going_out_ && !(now_() < held_until_)) return false;
  if (held_.size() >= kHeldMax) {
    WarnFull(std::to_string(kHeldMax) + " events wait for those who listen to be met again: the oldest are dropped");
    held_.pop_front();
  }
  held_.push_back(announcement);
  return true;
}

// Until none is held any more: what another thread sends meanwhile is held, too, and goes out behind them.
std::optional<Announcement> Outbox::NextHeld() {
  const std::lock_guard lock(mutex_);
  going_out_ = !held_.empty() && !(now_() < held_until_);
  if (!going_out_) return std::nullopt;
  Announcement next = std::move(held_.front());
  held_.pop_front();
  return next;
}

std::deque<Announcement> Outbox::TakeHeld() {
  const std::lock_guard lock(mutex_);
  return std::exchange(held_, {});
}

void Outbox::SendHeld() {
  while (const auto next = NextHeld())
    if (const Writers writers = WithNews(next->robot)) writers->Send(*next, ++sequence_number_);
}

void Outbox::Send(const Announcement& announcement) {
  if (Held(announcement)) return;
  if (const Writers writers = WithNews(announcement.robot)) writers->Send(announcement, ++sequence_number_);
}

Status Outbox::Tell(const RobotState& state) {
  const Writers writers = WithNews(state.newest.robot);
  return writers == nullptr ? Status() : writers->Tell(state);
}

void Outbox::EndQuiet(Robots& robots, Time now, std::vector<Writers>& ended) {
  for (auto one = robots.begin(); one != robots.end();) {
    const bool quiet = one->second.quiet_since + kQuietFor < now;
    if (quiet) ended.push_back(std::move(one->second.writers));
    one = quiet ? robots.erase(one) : std::next(one);
  }
}

// What is ended ends outside the lock: DDS may wait for others then.
void Outbox::CloseQuiet() {
  SendHeld();
  const Time now = now_();
  if (now < next_look_) return;
  next_look_ = now + kLookEvery;
  std::vector<Writers> ended;
  const std::lock_guard lock(mutex_);
  for (auto& [robot, live] : listened_to_)
    if (live.writers->HasReaderBeside(of_many_)) live.quiet_since = now;
  EndQuiet(listened_to_, now, ended);
  EndQuiet(with_news_, now, ended);
  if (!ended.empty()) full_ = false;
}

}  // namespace rigcal::dds
