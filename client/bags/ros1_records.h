// A record of a ROS 1 bag: fields by name, and data (wiki.ros.org/Bags/Format/2.0).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string_view>

#include "client/bags/cursor.h"

namespace rigcal::bags {

enum class Ros1Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

// Fields of a header: "name=value", a 32-bit length before each.
class Ros1Fields {
 public:
  // Nothing where `bytes` are no such fields.
  [[nodiscard]] static std::optional<Ros1Fields> Read(std::span<const std::byte> bytes);
  [[nodiscard]] std::string_view Text(std::string_view name) const;                // empty: none
  [[nodiscard]] std::optional<std::uint32_t> Number(std::string_view name) const;  // of 4 bytes
  [[nodiscard]] std::optional<std::int64_t> Time_ns(std::string_view name) const;  // seconds, nanoseconds
  [[nodiscard]] std::optional<Ros1Op> op() const;

 private:
  std::map<std::string_view, std::string_view> fields_;  // point into the bytes
};

}  // namespace rigcal::bags
