// Writes CDR of the machine's byte order, for tests of what reads it.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "client/bags/messages/value.h"

namespace rigcal::bags {

class CdrMessage {
 public:
  template <typename T>
  CdrMessage& Put(T value) {
    bytes_.resize((bytes_.size() + sizeof(T) - 1) / sizeof(T) * sizeof(T));
    const auto* raw = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), raw, raw + sizeof(T));
    return *this;
  }
  CdrMessage& Text(const std::string& text) {
    Put(static_cast<std::uint32_t>(text.size() + 1));
    const auto* raw = reinterpret_cast<const std::byte*>(text.c_str());
    bytes_.insert(bytes_.end(), raw, raw + text.size() + 1);
    return *this;
  }
  CdrMessage& Header(std::int32_t sec, std::uint32_t nanosec, const std::string& frame) {
    return Put(sec).Put(nanosec).Text(frame);
  }
  CdrMessage& Block(const std::string& bytes) {
    Put(static_cast<std::uint32_t>(bytes.size()));
    const auto* raw = reinterpret_cast<const std::byte*>(bytes.data());
    bytes_.insert(bytes_.end(), raw, raw + bytes.size());
    return *this;
  }
  template <typename T>
  CdrMessage& List(const std::vector<T>& values) {
    Put(static_cast<std::uint32_t>(values.size()));
    for (const T value : values) Put(value);
    return *this;
  }
  [[nodiscard]] std::vector<std::byte> Done() const {
    std::vector<std::byte> message = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
    message.insert(message.end(), bytes_.begin(), bytes_.end());
    return message;
  }

 private:
  std::vector<std::byte> bytes_;
};

// A message of a type that this program knows, decoded; owns what its value points into.
struct DecodedMessage {
  DecodedMessage(const std::string& type, const CdrMessage& message) : bytes(message.Done()) {
    topic.name = "/t";
    topic.type = type;
    topic.encoding = "cdr";
    definition = DefinitionOf(topic).value();
    value = Decode(topic, *definition, bytes).value();
  }
  Topic topic;
  std::shared_ptr<const Definition> definition;
  std::vector<std::byte> bytes;
  Value value;
};

}  // namespace rigcal::bags
