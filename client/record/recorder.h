// Takes the topics of a rig map off the network of a ROS 2 robot, and says what is amiss while it does.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "client/record/bag_file.h"
#include "client/record/followed_topic.h"

namespace rigcal::recording {

// One thread.
class Recorder {
 public:
  // `domain` is what people are told; the participant is in it. `bag` outlives the recorder. `say` is called with whole
  // sentences, each once.
  [[nodiscard]] static Result<std::unique_ptr<Recorder>> Open(std::vector<WantedTopic> wanted,
                                                              wire::Participant participant, int domain, BagFile& bag,
                                                              const Say& say);
  // Waits for news, at most so long, and puts what came into the bag.
  [[nodiscard]] Status Step(std::chrono::milliseconds wait);
  // What was seen so far; the rates of late begin anew.
  [[nodiscard]] std::vector<TopicSeen> Look();
  [[nodiscard]] std::int64_t Elapsed_ns() const;

 private:
  // Messages of one topic and type from publishers that offer one and the same.
  struct Source {
    FollowedTopic* of;
    std::string type;
    wire::RosQos qos;
    std::uint16_t channel = 0;
    wire::CdrReader reader;
  };
  struct Kept {
    FollowedTopic* of;
    ReceivedMessage message;
  };
  struct Network {
    wire::Participant participant;
    wire::RosPublishers publishers;
    wire::WaitSet waitset;
  };
  Recorder(Network network, BagFile& bag) : network_(std::move(network)), bag_(bag) {}
  [[nodiscard]] FollowedTopic* FollowedOf(dds_instance_handle_t publisher);
  [[nodiscard]] Status Come(dds_instance_handle_t handle);
  [[nodiscard]] Status TakeAll();
  void Keep(const Source& source, const wire::CdrMessage& message, std::vector<Kept>& kept);
  [[nodiscard]] Surroundings Around() const;

  Network network_;
  BagFile& bag_;
  Surroundings begun_ = {};
  std::vector<std::unique_ptr<FollowedTopic>> topics_ = {};
  std::vector<std::unique_ptr<Source>> sources_ = {};
};

}  // namespace rigcal::recording
