// One wanted topic while it is recorded: who publishes it, what came, and what people are told of it. Without a
// network: what discovery and readers say is put in.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "client/record/arrivals.h"
#include "client/record/wanted_topics.h"
#include "idl/ros/publishers.h"

namespace rigcal::recording {

// For who looks on.
enum class TopicState {
  kRecorded,   // messages come
  kNobody,     // nobody publishes it
  kOtherType,  // who publishes it sends what its sensor does not take
  kSilent,     // somebody publishes it, and has sent nothing
  kStalled,    // nothing has come for long
  kEnded,      // who published it is gone
};
struct TopicSeen {
  WantedTopic topic;
  TopicState state = TopicState::kNobody;
  std::vector<std::string> types;  // that are recorded, or of kOtherType that are sent
  std::size_t publishers = 0;      // there now
  bool best_effort = false;        // one of those is, or was
  Arrivals arrivals;
  std::int64_t at_ns = 0;      // when it was looked at, by the clock of `arrivals`
  std::int64_t unwritten = 0;  // that came, and were not recorded: the disk was too slow, or full
  // Nothing is missing that was sent, as far as that can be known.
  [[nodiscard]] bool IsWhole() const { return unwritten == 0 && arrivals.missed() == 0; }
};

using Say = std::function<void(const std::string& sentence)>;

// What is around it, for what is told.
struct Surroundings {
  std::int64_t now_ns = 0, start_ns = 0;                                            // of the recording
  int domain = 0;                                                                   // of ROS 2
  const std::map<dds_instance_handle_t, wire::RosPublisher>* publishers = nullptr;  // all that were met
};

class FollowedTopic {
 public:
  // `say` is called with whole sentences, each once.
  FollowedTopic(WantedTopic topic, Say say) : say_(std::move(say)) { seen_.topic = std::move(topic); }
  // A publisher of it. True: its messages are to be recorded.
  [[nodiscard]] bool Come(dds_instance_handle_t handle, const wire::RosPublisher& publisher, std::int64_t now_ns);
  // One that ended, after its last message was put in.
  void End(dds_instance_handle_t handle);
  // A message as Arrivals has it.
  void Arrive(std::int64_t now_ns, std::int64_t bytes, dds_instance_handle_t publisher, std::int64_t sequence) {
    seen_.arrivals.Add(now_ns, bytes, publisher, sequence);
  }
  // One of those could not be recorded.
  void Drop() { ++seen_.unwritten; }
  // Says what is amiss now, and was not said.
  void TellTroubles(const Surroundings& around);
  // What was seen so far; the rates of late begin anew.
  [[nodiscard]] TopicSeen Look(const Surroundings& around);
  [[nodiscard]] const WantedTopic& topic() const { return seen_.topic; }

 private:
  void TellNobody(const Surroundings& around);
  void SayOnce(const std::string& what, const std::string& sentence);
  [[nodiscard]] TopicState StateNow() const;

  TopicSeen seen_;
  Say say_;
  std::set<dds_instance_handle_t> publishers_, refused_;  // there now
  std::int64_t first_came_ns_ = 0;
  std::set<std::string> said_;
  bool is_stalled_ = false;
};

}  // namespace rigcal::recording
