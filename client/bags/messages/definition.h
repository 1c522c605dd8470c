// What a message type holds, as a tree: read from the text that a bag carries (ROS 1's and ROS 2's .msg text, OMG IDL),
// or known to this program for bags that carry none.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "client/bags/bag.h"
#include "server/base/result.h"

namespace rigcal::bags {

enum class Primitive {
  kBool,
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64,
  kString,
  kWstring,
  kMessage
};
// Bytes of one; 0 of strings and messages.
[[nodiscard]] std::size_t SizeOf(Primitive primitive);

enum class Arity { kOne, kFixed, kSequence };

struct MessageType;
struct FieldType {
  std::string name;
  Primitive primitive = Primitive::kUint8;
  std::string message;                // of kMessage: its name, "geometry_msgs/Vector3"
  const MessageType* type = nullptr;  // of kMessage; owned by the Definition
  Arity arity = Arity::kOne;
  std::size_t count = 0;      // of kFixed: how many
  std::size_t count_max = 0;  // of kSequence: 0: any number
};
struct MessageType {
  std::string name;  // "geometry_msgs/Vector3": package and type, whatever stands between
  std::vector<FieldType> fields;
};

// A type with all that it refers to. Neither copied nor moved: fields point into it.
struct Definition {
  std::map<std::string, MessageType> types;
  const MessageType* root = nullptr;
};

// "sensor_msgs/msg/Image" and "sensor_msgs::msg::dds_::Image_" give "sensor_msgs/Image".
[[nodiscard]] std::string PlainTypeName(std::string_view name);

// Of the topic's own text; where the bag has none, or leaves out a type that it names, of what this program knows.
// kUnsupported: the type is not known, or the text is of no known kind; kInvalidInput: the text is wrong. Errors name
// topic and type.
[[nodiscard]] Result<std::shared_ptr<const Definition>> DefinitionOf(const Topic& topic);

// The .msg text of a type, where this program knows it: what sensors send, and what those refer to. `is_ros1`: with the
// sequence number that a header had there. Empty: it does not.
[[nodiscard]] std::string KnownMsgText(std::string_view plain_name, bool is_ros1);

// Of the two kinds of text: adds the types that it defines to `types`; the first is that of the topic, called `name`.
// Names are not resolved yet.
using Types = std::map<std::string, MessageType>;
[[nodiscard]] Status ReadMsgText(std::string_view text, const std::string& name, Types& types);
[[nodiscard]] Status ReadIdlText(std::string_view text, Types& types);

}  // namespace rigcal::bags
