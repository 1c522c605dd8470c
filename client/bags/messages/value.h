// A decoded message, asked by the names of its fields.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/bags/mcap/mcap_records.h"
#include "client/bags/messages/definition.h"

namespace rigcal::bags {

// Points into the message's bytes and its definition, which outlive it. What is asked for and not there is absent, or
// the given fallback: a reader runs straight through and judges what it got.
class Value {
 public:
  enum class Kind { kAbsent, kInteger, kReal, kText, kNumbers, kList, kMessage };
  [[nodiscard]] Kind kind() const { return kind_; }
  [[nodiscard]] bool IsAbsent() const { return kind_ == Kind::kAbsent; }

  // Of a message: the field of this name.
  [[nodiscard]] const Value& operator[](std::string_view name) const;
  // The same under another name, if the first is not there: fields were renamed between ROS 1 and 2.
  [[nodiscard]] const Value& Either(std::string_view name, std::string_view other) const;
  // Of a list of messages or texts: its elements. Of a message: its fields, in their order.
  [[nodiscard]] const std::vector<Value>& items() const { return items_; }
  // A number; beyond int64 as the nearest.
  [[nodiscard]] double Real(double fallback = 0) const;
  [[nodiscard]] std::int64_t Integer(std::int64_t fallback = 0) const;
  [[nodiscard]] std::string_view Text() const { return text_; }
  // Of an array of numbers: how many, one of them, and the bytes as they stand (of one byte each, or in the machine's
  // order).
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] double RealAt(std::size_t idx) const;
  [[nodiscard]] Bytes bytes() const { return bytes_; }
  [[nodiscard]] const MessageType* type() const { return type_; }  // of a message
  // The same kind, names and values, whatever bytes and byte order they come from. NaN equals NaN.
  [[nodiscard]] bool SameAs(const Value& other) const;

 private:
  friend class Decoder;
  Kind kind_ = Kind::kAbsent;
  Primitive primitive_ = Primitive::kUint8;
  bool swapped_ = false;  // bytes_ are in the other byte order
  std::int64_t integer_ = 0;
  double real_ = 0;
  std::string_view text_;
  Bytes bytes_;
  std::size_t count_ = 0;
  std::vector<Value> items_;
  const MessageType* type_ = nullptr;
};

// A message of this topic. `fields_max`: decodes only its first fields, if that is all one wants to know.
// kInvalidInput: shorter or longer than its definition says, too many values; kUnsupported: an encoding other than
// "cdr" (plain, of either byte order) and "ros1". Errors name the topic.
[[nodiscard]] Result<Value> Decode(const Topic& topic, const Definition& definition, Bytes bytes,
                                   std::size_t fields_max = SIZE_MAX);

}  // namespace rigcal::bags
