#include "client/moments/sight.h"

#include <cmath>

namespace rigcal::moments {

std::optional<Shift> ShiftBetween(const Sight& a, const Sight& b) {
  if (!a.found() || a.target_idx != b.target_idx) return std::nullopt;
  constexpr int kCommonMin = 3;
  double squares_px2 = 0;
  int common = 0;
  for (std::size_t i = 0, j = 0; i < a.corner_idx.size() && j < b.corner_idx.size();) {
    if (a.corner_idx[i] == b.corner_idx[j]) {
      squares_px2 += (a.corners_px[i++] - b.corners_px[j++]).cast<double>().squaredNorm();
      ++common;
    } else {
      a.corner_idx[i] < b.corner_idx[j] ? ++i : ++j;
    }
  }
  if (common < kCommonMin) return std::nullopt;
  const double px = std::sqrt(squares_px2 / common);
  return Shift{px, px * (a.m_per_px + b.m_per_px) / 2};
}

}  // namespace rigcal::moments
