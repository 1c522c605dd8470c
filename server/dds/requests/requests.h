// Thread Q: takes requests, hands each to a thread that answers or, an order, to thread W, and passes answers on. It
// has a participant of its own: its sockets and the threads of DDS behind them are not those that sessions come in by.
// A request may come before the server's reply writer has met the reader of the client that asked; a volatile reply
// would be lost, so it waits here until they have met, bounded in number and time.
#pragma once

#include <chrono>
#include <future>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/base/process/vitals.h"
#include "server/dds/intake/inbox.h"
#include "server/dds/intake/last_question.h"
#include "server/dds/intake/retry.h"
#include "server/dds/requests/answerers.h"
#include "server/dds/requests/reply_writers.h"
#include "server/dds/service.h"

namespace rigcal::dds {

struct Question {
  std::string partition;  // where it was asked and is answered
  dds_instance_handle_t participant = 0;
  std::string id, verb, json;
};

// What is sent once it is there and its reader has been met.
struct PendingReply {
  Question question;
  std::shared_future<std::string> answer;  // of an order once it is carried out
  std::vector<std::string> parts;
  std::size_t next_idx = 0;
  std::chrono::steady_clock::time_point expires;
  bool busy = false;  // a reader is slow: tried again soon, not only when readers change
  bool is_order = false;
  std::chrono::steady_clock::time_point asked_at = std::chrono::steady_clock::now();
};

class Requests {
 public:
  // Callbacks, inbox (of thread W, for orders), `asked`, in which every question is noted, and `part`, which is told of
  // every failure, outlive it.
  [[nodiscard]] static Result<std::unique_ptr<Requests>> Open(const wire::ParticipantOptions& options,
                                                              const Callbacks& callbacks, Inbox& inbox,
                                                              LastQuestion& asked, Part& part,
                                                              std::vector<Answerers::Place> places);
  void Run();                                                                  // until Stop
  void Stop();                                                                 // any thread
  [[nodiscard]] std::size_t Waiting() const { return answerers_->Waiting(); }  // any thread

 private:
  // Its own, in DDS.
  struct Ends {
    wire::Participant participant;
    wire::Reader<rigcal_wire_Request> reader;
    wire::WaitSet waitset;
    ReplyWriters writers{participant, waitset};
    [[nodiscard]] bool IsSecured() const { return participant.identity() != nullptr; }
  };
  using Time = std::chrono::steady_clock::time_point;

  Requests(wire::Participant participant, wire::Reader<rigcal_wire_Request> reader, wire::WaitSet waitset,
           const Callbacks& callbacks, Inbox& inbox, LastQuestion& asked, Part& part);

  [[nodiscard]] std::shared_future<std::string> GiveOrder(const Question& question);
  [[nodiscard]] std::shared_future<std::string> AnswerTo(const Question& question);
  void Add(Question question);
  // True if there is nothing left to do for it.
  [[nodiscard]] bool Send(PendingReply& pending);
  [[nodiscard]] bool SendOrWait(PendingReply& pending);
  void SendPending();
  [[nodiscard]] Status Round();  // waits, takes, answers

  Ends ends_;
  const Callbacks& callbacks_;
  Inbox& inbox_;
  LastQuestion& asked_;
  std::list<PendingReply> pending_;
  Part& part_;
  Retry retry_;
  std::unique_ptr<Answerers> answerers_;  // ends before what it wakes
};

}  // namespace rigcal::dds
