// The limits that an operator may set. limits.h holds their defaults, docs/limits.md explains
// them. They are judged where something enters; what is stored stays readable whatever is set later.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "server/base/limits.h"

namespace rigcal::limits {

struct Limits {
  std::int64_t payload_bytes = kPayloadBytesMax;
  std::int64_t session_bytes = kSessionBytesMax;
  std::int64_t payloads_per_session = kPayloadsPerSessionMax;
  std::int64_t sensors_per_session = kSensorsPerSessionMax;
  std::int64_t window_bytes = kWindowBytes;
  std::int64_t intake_bytes = kIntakeBytesMax;
  std::int64_t open_sessions = kOpenSessionsMax;
  std::int64_t image_pixels = kImagePixelsMax;
  std::int64_t decoded_bytes = kDecodedBytes;
  std::int64_t http_connections = kHttpConnectionsMax;
  std::int64_t reports_of_robot = kReportsOfRobot;

  friend bool operator==(const Limits&, const Limits&) = default;
};

// `name` is the member's name; a value lies in [least, ceiling]. The ceilings are what the code is built for.
struct Setting {
  std::string_view name;
  std::int64_t Limits::*value;
  std::int64_t least, ceiling;
};
// All of them, in the order of the members above; valid as long as the process.
[[nodiscard]] std::span<const Setting> Settings();

// What holds in this process: the defaults until Enforce. Any thread; what it gave stays as it is.
[[nodiscard]] const Limits& InForce();
// From here on; one thread at a time. Whoever was built on other limits keeps them.
void Enforce(const Limits& limits);

}  // namespace rigcal::limits
