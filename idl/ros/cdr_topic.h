// Readers and writers of topics of ROS 2 whatever their type, by its name alone: messages are bytes, as bags of ROS 2
// hold them.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "idl/dds.h"
#include "idl/ros/cdr_type.h"

namespace rigcal::wire {

// "/left/image_raw" is "rt/left/image_raw" on the wire; nothing of a name on the wire that is no topic of ROS 2 (a
// service's, DDS's own).
[[nodiscard]] std::string WireTopicOf(std::string_view ros_topic);
[[nodiscard]] std::optional<std::string> RosTopicOf(std::string_view wire_topic);
// "sensor_msgs/msg/Image" is "sensor_msgs::msg::dds_::Image_" on the wire. What is not spelt like that stays as it is.
[[nodiscard]] std::string WireTypeOf(std::string_view ros_type);
[[nodiscard]] std::string RosTypeOf(std::string_view wire_type);

// What a publisher offers, or a subscription asks for; all else is DDS's default, as in ROS 2.
struct RosQos {
  bool reliable = true;
  bool transient_local = false;  // late joiners are given what was sent before, as far as it is kept
  int depth = 0;                 // messages that a writer keeps; 0: all
  friend bool operator==(const RosQos&, const RosQos&) = default;
};

// A topic as ROS 2 calls it and its type.
struct RosTopic {
  std::string name;  // "/left/image_raw"
  std::string type;  // "sensor_msgs/msg/Image"
  friend auto operator<=>(const RosTopic&, const RosTopic&) = default;
};

class CdrWriter {
 public:
  [[nodiscard]] static Result<CdrWriter> Open(const Participant& participant, const RosTopic& topic, const RosQos& qos);
  // `cdr` begins with the four bytes of its encapsulation. kBusy: a reader did not take in time; nothing was written,
  // try again.
  [[nodiscard]] Status Write(std::span<const std::byte> cdr);
  [[nodiscard]] int MatchedReaders() const { return internal::MatchedCount(writer_.get(), true); }
  // Until every matched reader has what was written; kUnreachable after the timeout.
  [[nodiscard]] Status WaitForAcks(std::chrono::milliseconds timeout) const {
    return internal::WaitForAcks(writer_.get(), timeout);
  }
  [[nodiscard]] dds_entity_t get() const { return writer_.get(); }

 private:
  CdrWriter(std::string name, Entity topic, const ddsi_sertype* type, Entity writer)
      : name_(std::move(name)), topic_(std::move(topic)), type_(type), writer_(std::move(writer)) {}
  std::string name_;
  Entity topic_;
  const ddsi_sertype* type_;  // the topic's
  Entity writer_;
};

struct CdrMessage {
  std::span<const std::byte> bytes;       // while it is looked at; with what the sender added to fill the last word
  std::int64_t sent_ns = 0;               // by the sender's clock
  dds_instance_handle_t publication = 0;  // as RosPublishers has it
  std::int64_t sequence = 0;              // the publisher's number of it, from 1 on without gaps; 0: not known
};

// It holds all that came until it is taken: who does not take in time pays in memory.
class CdrReader {
 public:
  [[nodiscard]] static Result<CdrReader> Open(const Participant& participant, const RosTopic& topic, const RosQos& qos);
  // All that came, in its order; how many.
  [[nodiscard]] Result<int> Take(const std::function<void(const CdrMessage&)>& body);
  [[nodiscard]] dds_entity_t get() const { return reader_.get(); }

 private:
  CdrReader(std::string name, Entity topic, Entity reader)
      : name_(std::move(name)), topic_(std::move(topic)), reader_(std::move(reader)) {}
  std::string name_;
  Entity topic_, reader_;
};

}  // namespace rigcal::wire
