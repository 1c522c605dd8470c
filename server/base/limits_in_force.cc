#include "server/base/limits_in_force.h"

#include <array>
#include <atomic>
#include <list>
#include <memory>

namespace rigcal::limits {
namespace {

constexpr std::int64_t kMiB = 1 << 20;
constexpr std::int64_t kChunk = kChunkBytesMax;

// Where the ceiling is the default, the stored documents are built on it: an operator may be stricter, not laxer.
constexpr std::array kSettings = {
    Setting{"payload_bytes", &Limits::payload_bytes, 1, kPayloadBytesMax},
    Setting{"session_bytes", &Limits::session_bytes, 1, kSessionBytesMax},
    Setting{"payloads_per_session", &Limits::payloads_per_session, 1, kPayloadsPerSessionMax},
    Setting{"sensors_per_session", &Limits::sensors_per_session, 1, kSensorsPerSessionMax},
    Setting{"window_bytes", &Limits::window_bytes, 2 * kChunk, 256 * kMiB},
    Setting{"intake_bytes", &Limits::intake_bytes, 4 * kChunk, 4096 * kMiB},
    Setting{"open_sessions", &Limits::open_sessions, 1, 4096},
    Setting{"image_pixels", &Limits::image_pixels, 1, 1'000'000'000},
    Setting{"decoded_bytes", &Limits::decoded_bytes, 16 * kMiB, 1024 * 1024 * kMiB},
    Setting{"http_connections", &Limits::http_connections, 2, 1024},
    Setting{"reports_of_robot", &Limits::reports_of_robot, 1, 100'000},
};

constexpr Limits kDefaults;
std::atomic<const Limits*> in_force{&kDefaults};

}  // namespace

std::span<const Setting> Settings() { return kSettings; }
const Limits& InForce() { return *in_force; }

// Those of before are never freed: somebody may be reading them.
void Enforce(const Limits& limits) {
  static auto& all = *std::make_unique<std::list<Limits>>().release();
  in_force = &all.emplace_back(limits);
}

}  // namespace rigcal::limits
