// Who publishes topics of ROS 2 on the network, as discovery tells it.
#pragma once

#include <map>
#include <string>

#include "idl/ros/cdr_topic.h"

namespace rigcal::wire {

struct RosPublisher {
  RosTopic topic;
  RosQos qos;
  bool is_there = true;  // false: it ended; what it sent may still come
};

// One thread.
class RosPublishers {
 public:
  [[nodiscard]] static Result<RosPublishers> Open(const Participant& participant);
  // Takes what discovery told since the last call: who came and who ended, by their handles.
  struct News {
    std::vector<dds_instance_handle_t> came, ended;
  };
  [[nodiscard]] Result<News> Look();
  // All that were met so far, those that ended too, by the handle that their messages have (CdrMessage::publication).
  [[nodiscard]] const std::map<dds_instance_handle_t, RosPublisher>& Met() const { return met_; }
  [[nodiscard]] dds_entity_t get() const { return publications_.get(); }

 private:
  explicit RosPublishers(Entity publications) : publications_(std::move(publications)) {}
  void Forget();
  Entity publications_;
  std::map<dds_instance_handle_t, RosPublisher> met_;
};

}  // namespace rigcal::wire
