// How far what a sensor sees moves about one of its messages.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "client/moments/choose.h"

namespace rigcal::moments {

// Neighbours farther away in time tell nothing.
constexpr std::int64_t kNeighbour_ns = 350'000'000;

// The messages of one stream by stamp.
class MotionTeller {
 public:
  // The stream outlives it.
  explicit MotionTeller(const Stream& stream);
  // From the message to each other within `span_ns`, and to the next on either side: the largest shift. Poses tell
  // metres only. Nothing where there is none on one side near enough, or it does not show the same.
  [[nodiscard]] std::optional<Shift> About(std::size_t message, std::int64_t span_ns) const;

 private:
  [[nodiscard]] std::optional<Shift> Between(std::size_t a, std::size_t b) const;
  [[nodiscard]] bool Widen(std::size_t message, std::size_t other, Shift& most) const;

  const Stream& stream_;
  std::vector<std::size_t> order_;  // by stamp
  std::vector<std::size_t> rank_;   // of each message in it
};

}  // namespace rigcal::moments
