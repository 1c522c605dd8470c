// Time: int64 nanoseconds since 1970-01-01 UTC, and the clock it is read from.
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/base/result.h"

namespace rigcal {

struct Stamp {
  std::int64_t ns = 0;
  friend auto operator<=>(const Stamp&, const Stamp&) = default;
};

// "2026-01-31T12:00:00Z" (seconds; the fraction is shown only if it is not zero).
[[nodiscard]] std::string ToIso(Stamp stamp);
// Accepts "YYYY-MM-DD", "YYYY-MM-DDThh:mm:ss[.fraction][Z|+hh:mm]"; years 1970-2200.
[[nodiscard]] Result<Stamp> ParseIso(std::string_view text);
// "90d", "12h", "30m", "45s" -> nanoseconds.
[[nodiscard]] Result<std::int64_t> ParseDuration(std::string_view text);
// "12 s", "5 min", "30 h", "12 days", "4 months", "5.9 years": for people.
[[nodiscard]] std::string AgeText(std::int64_t age_ns);

// Seam for tests. Thread-safe.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual Stamp Now() const = 0;  // nanoseconds since 1970, UTC
};
// The machine's clock; lives as long as the process.
[[nodiscard]] const Clock& SystemClock();

}  // namespace rigcal
