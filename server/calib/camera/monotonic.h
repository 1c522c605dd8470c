// How far a lens' radial distortion grows without folding over: polynomials that stay positive.
#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace rigcal::calib {

// By subdivision in Bernstein form; a polynomial that touches zero counts as not positive. At most degree 8.
[[nodiscard]] bool PositiveBySubdivision(const double* coefficients, int count, double s_max);

// Whether c0 + c1 s + c2 s^2 + ... > 0 for every s in [0, s_max]. False where something is NaN.
template <int kCount>
[[nodiscard]] inline bool PositiveUpTo(const Eigen::Matrix<double, kCount, 1>& coefficients, double s_max) {
  double falling = std::min(coefficients[kCount - 1], 0.0);
  for (int i = kCount - 2; i > 0; --i) falling = falling * s_max + std::min(coefficients[i], 0.0);
  // Each negative term is at its lowest at s_max: most points are settled here.
  if (coefficients[0] + falling * s_max > 0) return true;
  return PositiveBySubdivision(coefficients.data(), kCount, s_max);
}

}  // namespace rigcal::calib
