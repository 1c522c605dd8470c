#include "client/import/captures.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <numeric>

namespace rigcal::importing {
namespace {

// The messages of one sensor by stamp, each stamp once.
struct Sorted {
  std::vector<std::size_t> messages;
  std::vector<bool> taken;  // as `messages`
};

std::uint64_t Apart(std::int64_t a, std::int64_t b) {
  return a > b ? static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b)
               : static_cast<std::uint64_t>(b) - static_cast<std::uint64_t>(a);
}

std::string NameOf(std::int64_t stamp_ns) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t nanoseconds = ((stamp_ns % kSecond_ns) + kSecond_ns) % kSecond_ns;
  char text[40];
  // A clock that began before 1970 is no clock, yet its stamps have names: "m12-..." of second -12.
  const std::int64_t seconds = (stamp_ns - nanoseconds) / kSecond_ns;
  std::snprintf(text, sizeof text, "%s%lld-%09lld", seconds < 0 ? "m" : "",
                static_cast<long long>(seconds < 0 ? -seconds : seconds), static_cast<long long>(nanoseconds));
  return text;
}

class Planner {
 public:
  Planner(const std::vector<SensorStamps>& sensors, std::int64_t tolerance_ns)
      : sensors_(sensors), tolerance_ns_(static_cast<std::uint64_t>(tolerance_ns)), sorted_(sensors.size()) {
    plan_.uses.resize(sensors.size());
    for (std::size_t s = 0; s < sensors.size(); ++s) Sort(s);
  }

  CapturePlan Plan(std::int64_t every_ns) {
    std::vector<std::size_t> order;
    for (std::size_t s = 0; s < sensors_.size(); ++s)
      if (sensors_[s].forms_captures) order.push_back(s);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return sorted_[a].messages.size() < sorted_[b].messages.size();
    });
    for (const std::size_t anchor : order)
      for (std::size_t i = 0; i < sorted_[anchor].messages.size(); ++i)
        if (!sorted_[anchor].taken[i]) TryCapture(anchor, i, order.size() > 1 ? 2 : 1);
    std::sort(plan_.captures.begin(), plan_.captures.end(),
              [](const PlannedCapture& a, const PlannedCapture& b) { return a.stamp_ns < b.stamp_ns; });
    Thin(every_ns);
    CountUses();
    return std::move(plan_);
  }

 private:
  void Sort(std::size_t s) {
    const std::vector<std::int64_t>& stamps = sensors_[s].stamps_ns;
    std::vector<std::size_t>& messages = sorted_[s].messages;
    messages.resize(stamps.size());
    std::iota(messages.begin(), messages.end(), std::size_t{0});
    std::stable_sort(messages.begin(), messages.end(),
                     [&](std::size_t a, std::size_t b) { return stamps[a] < stamps[b]; });
    const auto last = std::unique(messages.begin(), messages.end(),
                                  [&](std::size_t a, std::size_t b) { return stamps[a] == stamps[b]; });
    plan_.uses[s].repeated_stamp = static_cast<std::size_t>(messages.end() - last);
    messages.erase(last, messages.end());
    sorted_[s].taken.assign(messages.size(), false);
  }
  [[nodiscard]] std::int64_t StampOf(std::size_t s, std::size_t i) const {
    return sensors_[s].stamps_ns[sorted_[s].messages[i]];
  }

  // The nearest of sensor `s`; of two as near the earlier. A message of a tracker may serve two captures, so that it is
  // never taken.
  [[nodiscard]] std::optional<std::size_t> Nearest(std::size_t s, std::int64_t stamp_ns, bool free_only) const {
    const Sorted& sorted = sorted_[s];
    const auto first_after =
        std::lower_bound(sorted.messages.begin(), sorted.messages.end(), stamp_ns,
                         [&](std::size_t message, std::int64_t at) { return sensors_[s].stamps_ns[message] < at; });
    std::optional<std::size_t> nearest;
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    const auto consider = [&](std::size_t i) {
      const std::uint64_t apart = Apart(StampOf(s, i), stamp_ns);
      if (apart <= tolerance_ns_ && apart < least && !(free_only && sorted.taken[i])) {
        nearest = i;
        least = apart;
      }
      return apart <= tolerance_ns_;
    };
    const auto begin = static_cast<std::size_t>(first_after - sorted.messages.begin());
    for (std::size_t i = begin; i > 0 && !nearest && consider(i - 1); --i) {
    }
    for (std::size_t i = begin; i < sorted.messages.size() && consider(i) && nearest != i; ++i) {
    }
    return nearest;
  }

  void TryCapture(std::size_t anchor, std::size_t i, std::size_t sensors_min) {
    const std::int64_t stamp_ns = StampOf(anchor, i);
    PlannedCapture capture{NameOf(stamp_ns), stamp_ns, std::vector<std::optional<std::size_t>>(sensors_.size())};
    std::vector<std::pair<std::size_t, std::size_t>> chosen = {{anchor, i}};
    for (std::size_t s = 0; s < sensors_.size(); ++s) {
      if (s == anchor) continue;
      const auto nearest = Nearest(s, stamp_ns, sensors_[s].forms_captures);
      if (!nearest) continue;
      if (!sensors_[s].forms_captures)
        capture.message[s] = sorted_[s].messages[*nearest];
      else if (Nearest(anchor, StampOf(s, *nearest), true) == i)
        chosen.emplace_back(s, *nearest);
    }
    if (chosen.size() < sensors_min) return;
    for (const auto& [s, at] : chosen) {
      capture.message[s] = sorted_[s].messages[at];
      sorted_[s].taken[at] = true;
    }
    plan_.captures.push_back(std::move(capture));
  }

  void Thin(std::int64_t every_ns) {
    std::vector<PlannedCapture> kept;
    for (PlannedCapture& capture : plan_.captures) {
      if (kept.empty() || Apart(capture.stamp_ns, kept.back().stamp_ns) >= static_cast<std::uint64_t>(every_ns)) {
        kept.push_back(std::move(capture));
        continue;
      }
      for (std::size_t s = 0; s < sensors_.size(); ++s)
        if (capture.message[s] && sensors_[s].forms_captures) ++plan_.uses[s].thinned_out;
    }
    plan_.captures = std::move(kept);
  }

  void CountUses() {
    for (std::size_t s = 0; s < sensors_.size(); ++s) {
      SensorUse& use = plan_.uses[s];
      for (const PlannedCapture& capture : plan_.captures) use.used += capture.message[s] ? 1 : 0;
      const std::size_t told = use.used + use.repeated_stamp + use.thinned_out + use.left_out,
                        all = sensors_[s].stamps_ns.size();
      use.without_partner = all > told ? all - told : 0;
    }
  }

  const std::vector<SensorStamps>& sensors_;
  std::uint64_t tolerance_ns_;
  std::vector<Sorted> sorted_;
  CapturePlan plan_;
};

}  // namespace

CapturePlan PlanCaptures(const std::vector<SensorStamps>& sensors, std::int64_t tolerance_ns, std::int64_t every_ns) {
  return Planner(sensors, tolerance_ns).Plan(every_ns);
}

}  // namespace rigcal::importing
