// Takes the topics of a rig map off the network of a ROS 2 robot, and says what is amiss while it does.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "client/record/arrivals.h"
#include "client/record/bag_file.h"
#include "client/record/wanted_topics.h"
#include "idl/ros/publishers.h"

namespace rigcal::recording {

// Of one wanted topic, for who looks on.
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

// One thread.
class Recorder {
 public:
  // `domain` is what people are told; the participant is in it. `bag` outlives the recorder. `say` is called with whole sentences, each
  // once.
  [[nodiscard]] static Result<std::unique_ptr<Recorder>> Open(std::vector<WantedTopic> wanted, wire::Participant participant, int domain,
                                                              BagFile& bag, Say say);
  // Waits for news, at most so long, and puts what came into the bag.
  [[nodiscard]] Status Step(std::chrono::milliseconds wait);
  // What was seen so far; the rates of late begin anew.
  [[nodiscard]] std::vector<TopicSeen> Look();
  [[nodiscard]] std::int64_t Elapsed_ns() const;

 private:
  // Messages of one type from publishers that offer one and the same.
  struct Source {
    std::string type;
    wire::RosQos qos;
    std::uint16_t channel = 0;
    wire::CdrReader reader;
  };
  struct Followed {
    TopicSeen seen;
    std::vector<std::unique_ptr<Source>> sources;
    std::set<dds_instance_handle_t> publishers, refused;  // there now
    std::int64_t first_came_ns = 0;
    std::set<std::string> said;  // what is said once
    bool is_stalled = false;
  };
  Recorder(wire::Participant participant, wire::RosPublishers publishers, wire::WaitSet waitset, int domain, BagFile& bag, Say say);
  [[nodiscard]] Followed* FollowedOf(const std::string& topic);
  [[nodiscard]] Status Come(dds_instance_handle_t handle);
  void End(dds_instance_handle_t handle);
  void TellArrival(Followed& of, const wire::RosPublisher& publisher);
  [[nodiscard]] Status OpenSource(Followed& of, const wire::RosPublisher& publisher);
  [[nodiscard]] Status TakeAll();
  struct Kept {
    Followed* of;
    ReceivedMessage message;
  };
  void Keep(Followed& of, const Source& source, const wire::CdrMessage& message, std::vector<Kept>& kept);
  void TellTroubles(Followed& of, std::int64_t now_ns);
  void TellNobody(Followed& of);
  void SayOnce(Followed& of, const std::string& what, const std::string& sentence);
  [[nodiscard]] TopicState StateOf(const Followed& of) const;

  wire::Participant participant_;
  wire::RosPublishers publishers_;
  wire::WaitSet waitset_;
  int domain_;
  BagFile& bag_;
  Say say_;
  std::int64_t start_ns_;
  std::vector<std::unique_ptr<Followed>> topics_;
};

}  // namespace rigcal::recording
