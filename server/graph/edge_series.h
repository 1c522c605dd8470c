// Taylor series of the functions that Log and Jr^-1 of SE(3) are made of, for small residuals.
#pragma once

namespace rigcal::graph {

namespace series {

constexpr double kSineBelow2 = 0.00996;  // squared sine of half the angle: 0.2 rad
constexpr double kAngleBelow2 = 0.04;    // rad^2

template <int N>
inline double Polynomial(const double (&c)[N], double x) {
  double sum = c[N - 1];
  for (int i = N - 1; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

// asin(s) / s of s^2.
constexpr double kArcsineOver[] = {1.0,           1.0 / 6,       3.0 / 40,       5.0 / 112,
                                   35.0 / 1152.0, 63.0 / 2816.0, 231.0 / 13312., 143.0 / 10240.};
// The functions of t^2 that Jr^-1 of SE(3) is made of (server/math/se3.cc has their closed forms):
// (1 - t/2 cot(t/2)) / t^2,
constexpr double kHalfCotangentRestOver2[] = {1.0 / 12,      1.0 / 720,      1.0 / 30240,
                                              1.0 / 1209600, 1.0 / 47900160, 691.0 / 1307674368000.};
// (t - sin t) / t^3 of -t^2,
constexpr double kThetaMinusSineOver3[] = {1.0 / 6,      1.0 / 120,      1.0 / 5040,
                                           1.0 / 362880, 1.0 / 39916800, 1.0 / 6227020800.};
// (t^2 + 2 cos t - 2) / (2 t^4) of -t^2,
constexpr double kCosineRestOver4[] = {1.0 / 24,      1.0 / 720,       1.0 / 40320,
                                       1.0 / 3628800, 1.0 / 479001600, 1.0 / 87178291200.};
// (2 t - 3 sin t + t cos t) / (2 t^5) of -t^2.
constexpr double kSineCosineRestOver5[] = {1.0 / 120,      2.0 / 5040,        3.0 / 362880,
                                           4.0 / 39916800, 5.0 / 6227020800., 6.0 / 1307674368000.};

}  // namespace series

}  // namespace rigcal::graph
