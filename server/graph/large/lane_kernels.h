// The innermost loops of a solve on plain numbers, compiled twice: for every x86-64, and for processors with AVX. Both
// do the same operations in the same order, without fused multiply-add, so that bytes do not depend on the machine.
#pragma once

#include <cstddef>

namespace rigcal::graph {

constexpr int kLanes = 4;  // numbers side by side
constexpr int kPanel = 6;  // columns that are factored together

// The lower triangle of a square matrix, column by column. `rows` is a multiple of kPanel; kLanes more zeros follow
// every column, and stride >= rows + kLanes. Once factored, the diagonal of L is stored inverted.
struct Triangle {
  double* entries = nullptr;
  std::ptrdiff_t rows = 0, stride = 0;
};

// Numbers of four edges, see Constraint: 36 of Omega, 3 of a translation, 4 of a quaternion (x y z w).
struct EdgeLanes {
  const double* Omega[kLanes];
  const double *p_j_i_m[kLanes], *q_j_i[kLanes];                            // as measured, inverted
  const double *p_i_m[kLanes], *q_i[kLanes], *p_j_m[kLanes], *q_j[kLanes];  // poses of both ends
};

// W: 36 numbers of a symmetric matrix; T_i_j.
struct BlockLanes {
  const double *W[kLanes], *p_i_j_m[kLanes], *q_i_j[kLanes];
};

// A twist or a force [translation, rotation] per edge.
struct EdgeTwists {
  double numbers[6][kLanes];
};

struct EdgeForces {
  EdgeTwists on_i, on_j;  // -J_i^T Omega e and J_j^T Omega e
  double cost[kLanes];    // e^T Omega e
};

// What four information matrices are like, of their symmetric parts: L D L^T without square roots, for it is asked of
// every edge of every solve.
struct InformationLanes {
  double asymmetry[kLanes];            // the largest difference between an entry and its mirror image
  double largest_of_diagonal[kLanes];  // where it is clear
  double is_clear[kLanes];             // not 0: every pivot is above kClearPivotRatio of its diagonal entry
  double pivot_product[kLanes];        // the determinant, where it is clear
};
constexpr double kClearPivotRatio = 1e-10;  // far above the tolerance of a rank

struct LaneKernels {
  // The Cholesky factor in place, from panel `first` on, where the panels before it are those of a factor; false if
  // the matrix is not positive definite.
  bool (*Factor)(Triangle matrix, std::ptrdiff_t first);
  // x <- (L L^T)^-1 x. x has rows + kLanes numbers, the last of them zero.
  void (*Solve)(Triangle L, double* x);
  // Rows `begin` .. rows - 1 of columns begin .. begin + 7 of L^-1, row by row, 8 numbers each. `begin` is a multiple
  // of 3; columns beyond the last are zero.
  void (*InverseColumns)(Triangle L, std::ptrdiff_t begin, double* columns);
  // `Omega`: 36 numbers of each matrix.
  void (*Information)(const double* const Omega[kLanes], InformationLanes& lanes);
  // False where a residual's rotation is too large for the series: then nothing is written.
  bool (*Residuals)(const EdgeLanes& edges, EdgeTwists& e);
  bool (*Forces)(const EdgeLanes& edges, EdgeForces& forces);
  // W A and A^T W A with A = Ad(T_j_i), 36 numbers each.
  void (*Blocks)(const BlockLanes& edges, double* const WA[kLanes], double* const AWA[kLanes]);
};

// Those for the processor at hand.
[[nodiscard]] const LaneKernels& Kernels();
// Those that every x86-64 runs, for comparison.
[[nodiscard]] const LaneKernels& PortableKernels();

// Taylor series of the functions that Log and Jr^-1 of SE(3) are made of, for small residuals.
namespace series {

constexpr double kSineBelow2 = 0.00996;  // squared sine of half the angle: 0.2 rad
constexpr double kAngleBelow2 = 0.04;    // rad^2

// c[0] + c[1] x + c[2] x^2 + ...
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
