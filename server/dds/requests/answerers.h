// The threads that work answers out, each with a store of its own, so that a slow question holds up no other. One
// client has at most two at a time; who has fewer goes first, then who was served longest ago. The same question of the
// same client, asked again while it is being answered, is answered by that, unless an order was carried out since.
#pragma once

#include <condition_variable>
#include <functional>
#include <future>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "server/base/process/vitals.h"
#include "storage/store.h"

namespace rigcal::dds {

class Answerers {
 public:
  using Document = std::string;
  using Work = std::function<Document(storage::Store& store, const std::string& verb, const std::string& json)>;
  // A thread per store, told of by the part beside it. The first runs in real time (kAnswers), as one thread may that
  // answers for long; the others take what it has no time for. `done` is called from these threads after each answer;
  // must not block.
  struct Place {
    storage::Store store;
    Part* part = nullptr;
  };
  // Starts the threads, one per place; there is one at least.
  Answerers(std::vector<Place> places, Work work, std::function<void()> done);
  ~Answerers();  // what is being answered is finished; what waits gets no answer
  Answerers(const Answerers&) = delete;
  Answerers& operator=(const Answerers&) = delete;

  // `client`: any number that is alike for all questions of one. Never blocks. Beyond kWaitingMax questions that wait,
  // or kOfOneClientWaitingMax of the client, nothing.
  [[nodiscard]] std::optional<std::shared_future<Document>> Ask(std::uint64_t client, const std::string& verb,
                                                                const std::string& json);
  // Questions that no thread has taken up.
  [[nodiscard]] std::size_t Waiting() const;
  // What was begun before holds no more for who asks from here on.
  void Changed();
  static constexpr std::size_t kWaitingMax = 1024, kOfOneClientWaitingMax = 64;

 private:
  using Key =
      std::tuple<std::uint64_t, std::string, std::string, std::uint64_t>;  // client, verb, json, changes before it
  struct Task {
    std::promise<Document> promise;
    std::shared_future<Document> document;
  };
  struct State {
    std::map<Key, std::shared_ptr<Task>> open;
    std::list<Key> waiting;                         // of `open`, first come, first served
    std::map<std::uint64_t, int> of_client;         // being answered
    std::map<std::uint64_t, std::uint64_t> served;  // when each client that has questions was served last, by `turn`
    std::uint64_t turn = 0, changes = 0;
    bool first_is_free = false, stopping = false;
  };
  using Lock = std::unique_lock<std::mutex>;
  void Run(Place& place);
  [[nodiscard]] bool AnswerNext(Place& place, Lock& lock);  // false: it is to stop
  [[nodiscard]] std::list<Key>::iterator NextAllowed();     // call with mutex_
  void Begin(std::uint64_t client);                         // likewise
  void End(const Key& key);                                 // likewise
  void WakeOne();                                           // likewise: the first, if it is free

  std::vector<Place> places_;
  const Work work_;
  const std::function<void()> done_;
  mutable std::mutex mutex_;
  std::condition_variable first_changed_, others_changed_;
  State state_;  // guarded by mutex_
  std::vector<std::thread> threads_;
};

}  // namespace rigcal::dds
