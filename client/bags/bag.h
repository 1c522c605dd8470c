// A recording of topics, whatever file it lies in: a stream of messages as bytes, with what is needed to decode them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/base/result.h"

namespace rigcal::bags {

struct Topic {
  std::string name;             // "/left/image_raw"
  std::string type;             // as the bag spells it: "sensor_msgs/msg/Image", "sensor_msgs/Image"
  std::string encoding;         // of its messages: "cdr", "ros1"; others are listed and not decoded
  std::string schema_encoding;  // "ros2msg", "ros2idl", "ros1msg"; empty: the bag has no definition of the type
  std::string schema;           // the definition's text
};

struct Message {
  std::shared_ptr<const Topic> topic;
  std::int64_t log_ns = 0;           // when it was recorded, by the recorder's clock
  std::int64_t publish_ns = 0;       // when it was sent, if the bag knows; else log_ns
  std::span<const std::byte> bytes;  // until the next call of Next()
};

// What could not be read of a bag, each in its sentence. Beyond kDamageToldMax they are counted.
class Damage {
 public:
  // Notes one more.
  void Add(Error error);
  // Those of another part, too.
  void Add(const Damage& other);
  [[nodiscard]] bool empty() const { return told_.empty(); }
  // In the order of the bag; where there were too many, the last says how many more.
  [[nodiscard]] std::vector<Error> All() const;

 private:
  std::vector<Error> told_;
  std::int64_t more_ = 0;
};

// One thread at a time. Memory: a record or a chunk at a time, whatever the size of the bag.
class Bag {
 public:
  virtual ~Bag() = default;
  // The next message in the order of the file; false at the end, or where nothing more can be read.
  [[nodiscard]] virtual bool Next(Message& message) = 0;
  // Topics known so far: all of them once Next() said false. A name may occur twice (of two senders).
  [[nodiscard]] virtual std::vector<std::shared_ptr<const Topic>> Topics() const = 0;
  // What could not be read so far. The messages before and after it were given.
  [[nodiscard]] virtual Damage Unread() const = 0;
  // For progress: bytes of files gone through, and in all.
  [[nodiscard]] virtual std::int64_t bytes_done() const = 0;
  [[nodiscard]] virtual std::int64_t bytes_total() const = 0;
};

}  // namespace rigcal::bags
