#include "server/dds/requests/answerers.h"

#include <algorithm>

#include "server/base/process/guarded.h"
#include "server/base/process/thread_rank.h"

namespace rigcal::dds {
namespace {

constexpr int kOfOneClientMax = 2;

}  // namespace

Answerers::Answerers(std::vector<Place> places, Work work, std::function<void()> done)
    : places_(std::move(places)), work_(std::move(work)), done_(std::move(done)) {
  for (Place& place : places_) threads_.emplace_back([this, &place] { Run(place); });
}

Answerers::~Answerers() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  first_changed_.notify_all();
  others_changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

std::size_t Answerers::Waiting() const {
  const std::lock_guard lock(mutex_);
  return waiting_.size();
}

void Answerers::Changed() {
  const std::lock_guard lock(mutex_);
  ++changes_;
}

std::optional<std::shared_future<Answerers::Document>> Answerers::Ask(std::uint64_t client, const std::string& verb,
                                                                      const std::string& json) {
  const std::lock_guard lock(mutex_);
  const Key key{client, verb, json, changes_};
  if (const auto found = open_.find(key); found != open_.end()) return found->second->document;
  const auto own =
      std::count_if(waiting_.begin(), waiting_.end(), [&](const Key& other) { return std::get<0>(other) == client; });
  if (waiting_.size() >= kWaitingMax || static_cast<std::size_t>(own) >= kOfOneClientWaitingMax) return std::nullopt;
  auto task = std::make_shared<Task>();
  task->document = task->promise.get_future().share();
  std::list<Key> added(1, key);
  open_.emplace(key, task);
  waiting_.splice(waiting_.end(), added);
  WakeOne();
  return task->document;
}

void Answerers::WakeOne() { (first_is_free_ ? first_changed_ : others_changed_).notify_one(); }

std::list<Answerers::Key>::iterator Answerers::NextAllowed() {
  const auto rank = [&](std::uint64_t client) {
    const auto busy = of_client_.find(client);
    const auto served = served_.find(client);
    return std::pair(busy == of_client_.end() ? 0 : busy->second, served == served_.end() ? 0 : served->second);
  };
  auto next = waiting_.end();
  std::pair<int, std::uint64_t> best{kOfOneClientMax, 0};
  for (auto key = waiting_.begin(); key != waiting_.end(); ++key)
    if (const auto own = rank(std::get<0>(*key)); own < best) next = key, best = own;
  return next;
}

void Answerers::Run(Place& place) {
  const bool is_first = &place == places_.data();
  SetThreadRank(is_first ? ThreadRank::kAnswers : ThreadRank::kServes);
  GoRound(place.part, [&] {
    Lock lock(mutex_);
    return AnswerNext(place, lock);
  });
}

// What needs memory comes before anything is changed: a question that is not begun waits for the next round.
bool Answerers::AnswerNext(Place& place, Lock& lock) {
  const bool is_first = &place == places_.data();
  if (place.part != nullptr) place.part->Rest();
  if (is_first) first_is_free_ = true;
  (is_first ? first_changed_ : others_changed_).wait(lock, [&] {
    return stopping_ || NextAllowed() != waiting_.end();
  });
  if (is_first) first_is_free_ = false;
  if (stopping_) return false;
  const auto next = NextAllowed();
  const Key key = *next;
  const std::shared_ptr<Task> task = open_.at(key);
  Begin(std::get<0>(key));
  waiting_.erase(next);
  if (NextAllowed() != waiting_.end()) WakeOne();
  lock.unlock();
  if (place.part != nullptr) place.part->Turn();
  Document document = work_(place.store, std::get<1>(key), std::get<2>(key));
  lock.lock();
  End(key);  // before anybody knows the answer: from here on it is another question
  lock.unlock();
  task->promise.set_value(std::move(document));
  done_();
  return true;
}

void Answerers::Begin(std::uint64_t client) {
  int& answered = of_client_[client];
  served_[client] = ++turn_;
  ++answered;
}

void Answerers::End(const Key& key) {
  const std::uint64_t client = std::get<0>(key);
  open_.erase(key);
  if (--of_client_[client] == 0) of_client_.erase(client);
  const bool asks_more =
      std::any_of(open_.begin(), open_.end(), [&](const auto& one) { return std::get<0>(one.first) == client; });
  if (!asks_more) served_.erase(client);
}

}  // namespace rigcal::dds
