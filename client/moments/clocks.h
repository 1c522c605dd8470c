// The clocks of a rig's cameras against each other: as stated, or of the board that they saw moving.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/moments/sight.h"
#include "server/model/sessions/session.h"

namespace rigcal::moments {

enum class ClockSource { kReference, kStated, kEstimated, kUnknown };
// "reference", "stated", "estimated", "unknown".
[[nodiscard]] std::string NameOf(ClockSource source);
// Of that name; nothing of any other.
[[nodiscard]] std::optional<ClockSource> ClockSourceOf(const std::string& name);

// For one instant, a sensor's stamp minus the reference's: offset_s + drift_ratio (stamp - at_ns).
struct SensorClock {
  ClockSource source = ClockSource::kUnknown;
  std::int64_t at_ns = 0;
  double offset_s = 0, drift_ratio = 0, offset_sigma_s = 0, drift_sigma_ratio = 0;

  // The stamp that the reference's clock would have given.
  [[nodiscard]] std::int64_t OnReference_ns(std::int64_t stamp_ns) const;
  // At its worst from `first_ns` to `last_ns`; nothing of an unknown clock.
  [[nodiscard]] std::optional<std::int64_t> Sigma_ns(std::int64_t first_ns, std::int64_t last_ns) const;
};

struct WatchedCamera {
  const Sensor* camera = nullptr;
  std::vector<const Target*> targets;  // that it may see, as its sights count them
  const std::vector<Sight>* sights = nullptr;
  std::optional<double> stated_offset_s;  // against the rig's clock
};

// One of each. The reference is the camera of that name, or where that is none the one that saw boards most often; it
// has the rig's clock. A camera that shares no board with it is tied to one that is known already. Boards that are seen
// in most pictures of both tell it (clock_fit.h).
[[nodiscard]] std::vector<SensorClock> ClocksOf(const std::vector<WatchedCamera>& cameras, const SensorId& reference);

}  // namespace rigcal::moments
