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
    state_.stopping = true;
  }
  first_changed_.notify_all();
  others_changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

std::size_t Answerers::Waiting() const {
  const std::lock_guard lock(mutex_);
  return state_.waiting.size();
}

void Answerers::Changed() {
  const std::lock_guard lock(mutex_);
  ++state_.changes;
}

std::optional<std::shared_future<Answerers::Document>> Answerers::Ask(std::uint64_t client, const std::string& verb,
                                                                      const std::string& json) {
  const std::lock_guard lock(mutex_);
  const Key key{client, verb, json, state_.changes};
  if (const auto found = state_.open.find(key); found != state_.open.end()) return found->second->document;
  const auto own = std::count_if(state_.waiting.begin(), state_.waiting.end(),
                                 [&](const Key& other) { return std::get<0>(other) == client; });
  if (state_.waiting.size() >= kWaitingMax || static_cast<std::size_t>(own) >= kOfOneClientWaitingMax)
    return std::nullopt;
  auto task = std::make_shared<Task>();
  task->document = task->promise.get_future().share();
  std::list<Key> added(1, key);
  state_.open.emplace(key, task);
  state_.waiting.splice(state_.waiting.end(), added);
  WakeOne();
  return task->document;
}

void Answerers::WakeOne() { (state_.first_is_free ? first_changed_ : others_changed_).notify_one(); }

std::list<Answerers::Key>::iterator Answerers::NextAllowed() {
  const auto rank = [&](std::uint64_t client) {
    const auto busy = state_.of_client.find(client);
    const auto served = state_.served.find(client);
    return std::pair(busy == state_.of_client.end() ? 0 : busy->second,
                     served == state_.served.end() ? 0 : served->second);
  };
  auto next = state_.waiting.end();
  std::pair<int, std::uint64_t> best{kOfOneClientMax, 0};
  for (auto key = state_.waiting.begin(); key != state_.waiting.end(); ++key)
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
  if (is_first) state_.first_is_free = true;
  (is_first ? first_changed_ : others_changed_).wait(lock, [&] {
    return state_.stopping || NextAllowed() != state_.waiting.end();
  });
  if (is_first) state_.first_is_free = false;
  if (state_.stopping) return false;
  const auto next = NextAllowed();
  const Key key = *next;
  const std::shared_ptr<Task> task = state_.open.at(key);
  Begin(std::get<0>(key));
  state_.waiting.erase(next);
  if (NextAllowed() != state_.waiting.end()) WakeOne();
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
  int& answered = state_.of_client[client];
  state_.served[client] = ++state_.turn;
  ++answered;
}

void Answerers::End(const Key& key) {
  const std::uint64_t client = std::get<0>(key);
  state_.open.erase(key);
  if (--state_.of_client[client] == 0) state_.of_client.erase(client);
  const bool asks_more = std::any_of(state_.open.begin(), state_.open.end(),
                                     [&](const auto& one) { return std::get<0>(one.first) == client; });
  if (!asks_more) state_.served.erase(client);
}

}  // namespace rigcal::dds
