#include "server/model/edges/admission.h"

#include <string>

#include "server/base/text.h"

namespace rigcal {
namespace {

Status Within(const std::string& what, std::int64_t value, std::int64_t most, const std::string& limit,
              const std::string& cure) {
  if (value <= most) return {};
  return Fail(ErrorCode::kInvalidInput,
              what + ", " + std::to_string(value) + ", beyond this server's limit of " + std::to_string(most),
              cure + ", or raise the limit " + limit + " of rigcald (docs/limits.md).");
}

}  // namespace

Status CheckAdmission(const Manifest& manifest, const limits::Limits& limits) {
  RIGCAL_TRY(Within("the session has too many sensors", static_cast<std::int64_t>(manifest.header.sensors.size()),
                    limits.sensors_per_session, "sensors_per_session", "Split the rig into several sessions"));
  RIGCAL_TRY(Within("the session has too many files", static_cast<std::int64_t>(manifest.payloads.size()),
                    limits.payloads_per_session, "payloads_per_session", "Split it into several sessions"));
  std::int64_t total_bytes = 0;
  for (const Payload& payload : manifest.payloads) {
    RIGCAL_TRY(Within("file " + Quoted(payload.path) + " has too many bytes", payload.size_bytes, limits.payload_bytes,
                      "payload_bytes", "Store the capture in a smaller file"));
    total_bytes += payload.size_bytes;
  }
  return Within("the session has too many bytes", total_bytes, limits.session_bytes, "session_bytes",
                "Split it into several sessions");
}

namespace {

Status NotAhead(const std::string& what, Stamp at, Stamp now, const std::string& whose, const std::string& cure) {
  constexpr std::int64_t kAheadMax_ns = 86'400'000'000'000, kSecond_ns = 1'000'000'000;
  if (at.ns - kAheadMax_ns <= now.ns) return {};
  return Fail(ErrorCode::kInvalidInput,
              what + " " + ToIso(at) + " is more than a day ahead of " + whose + "'s clock, " +
                  ToIso({now.ns - now.ns % kSecond_ns}),
              cure);
}

}  // namespace

Status CheckCapturedAt(const SessionHeader& header, Stamp now, const std::string& whose) {
  return NotAhead("captured_at", header.captured_at, now, whose,
                  "Correct captured_at in session.yaml, or the clock that is wrong.");
}

Status CheckMeasuredAt(const Edge& edge, Stamp now) {
  if (!edge.measured_at) return {};
  return NotAhead("edge " + edge.frame_a.str() + " - " + edge.frame_b.str() + ": measured_at", *edge.measured_at, now,
                  "this server", "Correct measured_at in the file, or the clock that is wrong.");
}

}  // namespace rigcal
