#include "client/moments/motion.h"

#include <algorithm>
#include <numeric>

namespace rigcal::moments {

MotionTeller::MotionTeller(const Stream& stream)
    : stream_(stream), order_(stream.stamps_ns.size()), rank_(stream.stamps_ns.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::stable_sort(order_.begin(), order_.end(),
                   [&](std::size_t a, std::size_t b) { return stream.stamps_ns[a] < stream.stamps_ns[b]; });
  for (std::size_t i = 0; i < order_.size(); ++i) rank_[order_[i]] = i;
}

std::optional<Shift> MotionTeller::Between(std::size_t a, std::size_t b) const {
  if (stream_.kind == Stream::Kind::kCamera) return ShiftBetween(stream_.sights[a], stream_.sights[b]);
  return Shift{0, (stream_.places_m[a] - stream_.places_m[b]).norm()};
}

bool MotionTeller::Widen(std::size_t message, std::size_t other, Shift& most) const {
  const auto shift = Between(message, other);
  if (!shift) return false;
  most = {std::max(most.px, shift->px), std::max(most.m, shift->m)};
  return true;
}

std::optional<Shift> MotionTeller::About(std::size_t message, std::int64_t span_ns) const {
  const std::int64_t at_ns = stream_.stamps_ns[message];
  Shift most;
  for (const int side : {-1, 1}) {
    bool told = false;
    for (std::size_t i = rank_[message] + static_cast<std::size_t>(side); i < order_.size();
         i += static_cast<std::size_t>(side)) {
      const std::int64_t apart_ns = std::abs(stream_.stamps_ns[order_[i]] - at_ns);
      if (apart_ns > kNeighbour_ns || (told && apart_ns > span_ns)) break;
      if (!Widen(message, order_[i], most)) return std::nullopt;
      told = true;
    }
    if (!told) return std::nullopt;
  }
  return most;
}

}  // namespace rigcal::moments
