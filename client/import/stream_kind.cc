#include "client/import/stream_kind.h"

#include <algorithm>

namespace rigcal::importing {
namespace {

constexpr std::int64_t kSlowest_ns = 250'000'000;
constexpr std::size_t kMessagesMin = 20;

bool RatesDiffer(const std::vector<std::int64_t>& periods_ns) {
  if (periods_ns.size() < 2) return false;
  const auto [least, most] = std::minmax_element(periods_ns.begin(), periods_ns.end());
  return 5 * *most >= 6 * *least;
}

bool FewMatch(const std::vector<SensorStamps>& sensors, std::int64_t tolerance_ns) {
  if (sensors.size() < 2) return false;
  std::size_t fewest = SIZE_MAX;
  for (const SensorStamps& sensor : sensors) fewest = std::min(fewest, sensor.stamps_ns.size());
  return 2 * PlanCaptures(sensors, tolerance_ns, 0).captures.size() < fewest;
}

}  // namespace

std::optional<std::int64_t> Period_ns(std::vector<std::int64_t> stamps_ns) {
  if (stamps_ns.size() < 3) return std::nullopt;
  std::sort(stamps_ns.begin(), stamps_ns.end());
  std::vector<std::int64_t> steps_ns;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) steps_ns.push_back(stamps_ns[i] - stamps_ns[i - 1]);
  const auto middle = steps_ns.begin() + static_cast<std::ptrdiff_t>(steps_ns.size() / 2);
  std::nth_element(steps_ns.begin(), middle, steps_ns.end());
  return *middle;
}

bool RunsFreely(const std::vector<SensorStamps>& cameras, const std::vector<SensorStamps>& others,
                std::int64_t tolerance_ns) {
  std::vector<std::int64_t> fast_ns;
  for (const SensorStamps& camera : cameras)
    if (const auto period_ns = Period_ns(camera.stamps_ns);
        period_ns && *period_ns <= kSlowest_ns && camera.stamps_ns.size() >= kMessagesMin)
      fast_ns.push_back(*period_ns);
  if (fast_ns.empty()) return false;
  std::vector<SensorStamps> all = cameras;
  all.insert(all.end(), others.begin(), others.end());
  return RatesDiffer(fast_ns) || FewMatch(all, tolerance_ns);
}

}  // namespace rigcal::importing
