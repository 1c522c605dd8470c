// A step as a lens shows it: the integral of a Gaussian point spread.
#pragma once

#include <array>
#include <cmath>

namespace rigcal::sim {

// 0 far on one side, 1 far on the other; `x` in standard deviations of the point spread. From a table: 1e-5.
class SoftEdge {
 public:
  static constexpr float kReach = 4.0f;  // beyond it a step is over

  // Fills the table.
  SoftEdge() {
    for (int i = 0; i <= kCells; ++i) {
      const double x = -kReach + 2.0 * kReach * i / kCells;
      table_[static_cast<std::size_t>(i)] = static_cast<float>(0.5 * std::erfc(-x / std::sqrt(2.0)));
    }
    table_.front() = 0, table_[kCells] = 1, table_[kCells + 1] = 1;
  }
  // 0 also of what is no number.
  [[nodiscard]] float operator()(float x) const {
    if (!(x > -kReach)) return 0;
    if (x >= kReach) return 1;
    const float at = (x + kReach) * (kCells / (2 * kReach));
    const int cell = static_cast<int>(at);
    const float part = at - static_cast<float>(cell);
    const float low = table_[static_cast<std::size_t>(cell)], high = table_[static_cast<std::size_t>(cell) + 1];
    return low + part * (high - low);
  }

 private:
  static constexpr int kCells = 2048;
  std::array<float, kCells + 2> table_;
};

}  // namespace rigcal::sim
