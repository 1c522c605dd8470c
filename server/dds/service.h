// The whole DDS edge of rigcald: readers, recorder, requests, writers. Owns its threads:
//   D takes everything at once (a reader that stops taking stalls every topic of the process) and never waits;
//   W records: files, one transaction per batch, then receipts; carries out orders;   T tells what is stored of robots
//   to those who read of them;   Q takes requests and sends the answers that others work out.
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "idl/dds.h"
#include "server/base/process/vitals.h"
#include "server/base/stamp.h"
#include "server/dds/intake/arrival.h"
#include "server/metrics/exposition.h"
#include "server/model/approval/order_origin.h"
#include "server/model/robots/robot_state.h"
#include "storage/store.h"

namespace rigcal::dds {

struct Options {
  wire::ParticipantOptions participant;
  storage::StorePlace place;  // the service opens its own connections
  const Clock* clock = nullptr;
  Vitals* vitals = nullptr;  // told how D, W, T and Q are; none: nobody asks
  // Announcements are kept so long: where DDS is opened anew, until who listened before is met again.
  std::chrono::milliseconds announces_after{0};
  std::string intake = {};  // of the store's intake folder the part that is this service's; empty: all of it
};

struct Callbacks {
  // Answers one request with the /api/v1 document of (verb, json). Called from several threads, each with a store of
  // its own.
  std::function<Result<std::string>(storage::Store& store, const std::string& verb, const std::string& json)> answer;
  // Verbs that change something. They are asked in the partition of people only, and carried out by thread W alone, on
  // its own connection to the store; what `carry_out` returns is durable. Over DDS nobody has verified who gives one,
  // unless identities do.
  std::function<bool(const std::string& verb)> is_order = [](const std::string&) { return false; };
  std::function<Result<OrderDone>(storage::Store& store, const std::string& verb, const std::string& json,
                                  const OrderOrigin& origin)>
      carry_out = {};
  // What is stored of a robot that somebody reads of; nothing: no revision. Called from thread T, which tries again
  // after an error.
  std::function<Result<std::optional<RobotState>>(storage::Store& store, const RobotId&)> state_of =
      [](storage::Store&, const RobotId&) { return std::optional<RobotState>(); };
  // Something durable arrived that may mean work (session closed, edges stored). Called from thread W; must not block.
  std::function<void(const RobotId&)> work_arrived;
  // A receipt goes out; whether whoever pushed by another way than DDS (Service::TakeIn) has it herewith. Called from
  // threads that send; must not block. None: nobody does.
  std::function<bool(const wire::Receipt&)> receipt_sent = {};
};

// What the pipeline announces; sent in the robot's partition.
struct Announcement {
  RobotId robot;
  std::string kind;  // Event::kind
  std::string subject_id;
  Stamp at;
  std::string json;
};

class Service {
 public:
  // Answers and receives when it returns. The error says what could not be opened: the network or the store.
  [[nodiscard]] static Result<Service> Start(const Options& options, Callbacks callbacks);
  ~Service();  // stops and joins the threads; what was receipted is on disk
  // A service that was moved from does nothing: the other goes on.
  Service(Service&&) noexcept;
  Service& operator=(Service&&) noexcept;

  // To those who read of the robot now; who comes later is told its state, and no events of before.
  void Announce(const Announcement& announcement);
  // There is a new revision of the robot: those who read of it are told soon what is stored, its one line and the poses
  // for it to use. Without these, what was told of sensors is taken back. Never blocks.
  void Tell(const RobotId& robot);

  // Stops and joins the threads, as its end does; what was announced and nobody heard yet (Options::announces_after),
  // oldest first.
  [[nodiscard]] std::deque<Announcement> Close();

  // What a person who logged in asks to be changed, handed to thread W like an order over DDS: the document once it is
  // on disk. kBusy where W does not come to it within 10 s: it may do so later. Any thread but the service's own.
  [[nodiscard]] Result<std::string> GiveOrder(const std::string& verb, const std::string& json);

  // What robots pushed elsewhere and another server sends on, handed to thread W as if it had come over DDS: each
  // chunk, manifest and edge is checked, stored and receipted likewise (Callbacks::receipt_sent). Waits for room; kBusy
  // where there is none within 10 s. Any thread but the service's own.
  [[nodiscard]] Status TakeIn(Arrival arrival);

  // What waits to be taken in and to be answered now, and how much of it there may be. Any thread, never blocks.
  [[nodiscard]] std::vector<metrics::Reading> Readings() const;

 private:
  struct Impl;
  explicit Service(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigcal::dds
