#include "server/calib/camera/monotonic.h"

#include <array>

namespace rigcal::calib {
namespace {

constexpr int kCountMax = 9;
constexpr int kDepthMax = 24;

using Bernstein = std::array<double, kCountMax>;

double Binomial(int n, int k) {
  double value = 1;
  for (int i = 0; i < k; ++i) value = value * (n - i) / (i + 1);
  return value;
}

Bernstein OnUnitInterval(const double* coefficients, int count, double s_max) {
  Bernstein control{};
  double power = 1;
  for (int i = 0; i < count; ++i, power *= s_max)
    for (int j = i; j < count; ++j)
      control[static_cast<std::size_t>(j)] += Binomial(j, i) / Binomial(count - 1, i) * coefficients[i] * power;
  return control;
}

// Halves the interval (de Casteljau): `control` becomes the left half, the right half is returned.
Bernstein SplitOff(Bernstein& control, std::size_t count) {
  Bernstein right{};
  Bernstein level = control;
  for (std::size_t step = 0; step < count; ++step) {
    control[step] = level[0];
    right[count - 1 - step] = level[count - 1 - step];
    for (std::size_t i = 0; i + 1 + step < count; ++i) level[i] = 0.5 * (level[i] + level[i + 1]);
  }
  return right;
}

bool Positive(Bernstein control, std::size_t count, int depth) {
  if (!(control[0] > 0 && control[count - 1] > 0)) return false;
  const auto end = control.begin() + static_cast<std::ptrdiff_t>(count);
  if (std::all_of(control.begin(), end, [](double value) { return value > 0; })) return true;
  if (depth == kDepthMax) return false;
  const Bernstein right = SplitOff(control, count);
  return Positive(control, count, depth + 1) && Positive(right, count, depth + 1);
}

}  // namespace

bool PositiveBySubdivision(const double* coefficients, int count, double s_max) {
  return Positive(OnUnitInterval(coefficients, count, s_max), static_cast<std::size_t>(count), 0);
}

}  // namespace rigcal::calib
