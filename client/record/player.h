// Plays a bag onto the network as the programs of a ROS 2 robot would: its bytes, under ROS 2's names and types, at the
// bag's pace.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/bags/bag.h"
#include "idl/ros/cdr_topic.h"

namespace rigcal::recording {

struct ReplayInput {
  std::filesystem::path bag;
  double rate = 1;                  // of the bag's pace; more than 0
  std::vector<std::string> topics;  // these alone; empty: all
  bool best_effort = false;         // as many drivers publish; else reliable
};

struct ReplayedTopic {
  wire::RosTopic topic;
  std::int64_t in_bag = 0, sent = 0;
  int readers = 0;      // the most that there were
  std::string trouble;  // why nothing of it is sent; empty: it is
};

struct ReplayOutcome {
  std::vector<ReplayedTopic> topics;  // that were asked for, by name
  std::int64_t bag_ns = 0, took_ns = 0;
  std::int64_t latest_ns = 0;  // how far behind the bag's pace it was at most
  bool is_whole = true;        // false: it was stopped
  std::vector<Error> damage;   // of the bag
};

// How long after the bag's first message one is due at `rate` times the bag's pace; stamps by the recorder's clock,
// whatever they are: at most a century, and nothing where it is before the first.
[[nodiscard]] std::chrono::nanoseconds DueAfter(std::int64_t first_ns, std::int64_t log_ns, double rate);

// Asked now and then: true: end now.
using Stop = std::function<bool()>;
using PlayProgress = std::function<void(std::int64_t done_bytes, std::int64_t total_bytes)>;

// One thread.
class Player {
 public:
  // Goes through the bag once, and publishes its topics; nothing is sent. kNotFound: a topic that the bag does not
  // have; kUnsupported: none of its topics is of ROS 2. `stop` ends the reading early.
  [[nodiscard]] static Result<std::unique_ptr<Player>> Open(const ReplayInput& input,
                                                            const wire::Participant& participant, const Stop& stop);
  // Until somebody reads every topic that is sent, at most so long. Those that nobody reads.
  [[nodiscard]] std::vector<std::string> AwaitReaders(std::chrono::milliseconds timeout, const Stop& stop);
  // Sends all messages. Where a reliable reader does not take, it waits.
  [[nodiscard]] Result<ReplayOutcome> Play(const Stop& stop, const PlayProgress& progress);
  // Until every reader has what was sent; kUnreachable after the timeout.
  [[nodiscard]] Status AwaitDelivery(std::chrono::milliseconds timeout, const Stop& stop);
  [[nodiscard]] std::size_t TopicCount() const;

 private:
  struct Played {
    ReplayedTopic told;
    std::optional<wire::CdrWriter> writer;
  };
  explicit Player(ReplayInput input) : input_(std::move(input)) {}
  [[nodiscard]] Status Survey(const Stop& stop);
  void Count(const bags::Message& message);
  [[nodiscard]] Status CheckNames() const;
  [[nodiscard]] Status Publish(const wire::Participant& participant);
  [[nodiscard]] Played* PlayedOf(const bags::Topic& topic);
  [[nodiscard]] Status Send(Played& played, const bags::Message& message, const Stop& stop);

  ReplayInput input_;
  std::vector<std::unique_ptr<Played>> topics_;
  std::int64_t first_ns_ = INT64_MAX, last_ns_ = INT64_MIN;  // by the recorder's clock
};

}  // namespace rigcal::recording
