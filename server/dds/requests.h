// Thread Q: answers requests. A request may come before the server's reply writer has met the reader of the client that
// asked; a volatile reply would be lost, so it waits here until they have met, bounded in number, bytes and time.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <list>
#include <mutex>
#include <string>
#include <vector>

#include "server/dds/outbox.h"

namespace rigcal::dds {

struct Question {
  std::string partition;  // where it was asked and is answered
  dds_instance_handle_t participant = 0;
  std::string id, verb, json;
};

class Requests {
 public:
  // Both outlive it. `answer` as in Callbacks.
  Requests(Outbox& outbox, const std::function<Result<std::string>(const std::string&, const std::string&)>& answer)
      : outbox_(outbox), answer_(answer) {}

  // Thread D. Never waits; beyond the limit the question is dropped (the client asks again or gives up).
  void Offer(Question question);
  // A reader of replies came or went: any thread.
  void ReadersChanged();
  void Run();  // until Stop
  void Stop();

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Pending {
    Question question;
    std::vector<std::string> parts;
    std::size_t next_idx = 0;
    Time expires;
    bool busy = false;  // a reader is slow: tried again soon, not only when readers change
  };

  [[nodiscard]] std::string DocumentOf(const Question& question) const;
  void Add(Question question);
  // True if there is nothing left to do for it.
  [[nodiscard]] bool Send(Pending& pending) const;
  void SendPending();
  [[nodiscard]] std::optional<Question> Next();

  Outbox& outbox_;
  const std::function<Result<std::string>(const std::string&, const std::string&)>& answer_;
  std::list<Pending> pending_;  // thread Q only
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Question> questions_;
  bool readers_changed_ = false, stopped_ = false;
};

}  // namespace rigcal::dds
