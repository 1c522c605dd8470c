#include "server/calib/lidar_lidar/surface_polish.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "server/base/parallel_for.h"

namespace rigcal::calib {
namespace {

constexpr double kThinRatio = 1e-3;   // of a piece of surface: variance across against variance along
constexpr double kKernelCells = 3.0;  // half the pull at this distance across, in cells
constexpr std::size_t kChunk = 512;
constexpr int kIterationsMax = 60;

bool IsIn(const PolishTerm& term, const Eigen::Vector3d& mean_m) {
  if (term.half < 0) return true;
  const Eigen::Vector3i at = (mean_m / term.block_m).array().floor().cast<int>();
  return ((at.x() + at.y() + at.z()) & 1) == term.half;
}

// (C_a + R C_b R^T)^-1 of two flat pieces with unit variance along them.
Eigen::Matrix3d InformationOf(const Eigen::Vector3d& normal_a, const Eigen::Vector3d& normal_b) {
  const Eigen::Matrix3d C = 2 * Eigen::Matrix3d::Identity() -
                            (1 - kThinRatio) * (normal_a * normal_a.transpose() + normal_b * normal_b.transpose());
  return C.inverse();
}

NormalSums SumOf(const PolishTerm& term, std::size_t begin, std::size_t end, const Se3& T_a_b) {
  const Eigen::Matrix3d R = T_a_b.R();
  const double kernel_m = kKernelCells * term.a->cell_m, kernel2 = kernel_m * kernel_m / (2 * kThinRatio);
  NormalSums sum;
  for (std::size_t i = begin; i < end; ++i) {
    const SurfaceCell& b = term.b->cells[i];
    if (!b.has_normal || !IsIn(term, b.mean_m)) continue;
    const Eigen::Vector3d q = R * b.mean_m + T_a_b.p_m;
    const SurfaceCell* a = term.a->Nearest(q);
    if (a == nullptr || !a->has_normal) continue;
    const Eigen::Vector3d e = q - a->mean_m;
    const Eigen::Matrix3d W = InformationOf(a->normal, R * b.normal);
    const double pull = 1 / (1 + e.dot(W * e) / kernel2);
    Eigen::Matrix<double, 3, 6> J;  // of e, for T * Exp(xi)
    J << R, -R * Hat(b.mean_m);
    const Eigen::Matrix<double, 6, 3> JtW = pull * pull * J.transpose() * W;
    sum.H += JtW * J;
    sum.g += JtW * e;
  }
  return sum;
}

NormalSums SumOf(const std::vector<PolishTerm>& terms, const Se3& T_a_b) {
  struct Chunk {
    const PolishTerm* term;
    std::size_t begin, end;
  };
  std::vector<Chunk> chunks;
  for (const PolishTerm& term : terms)
    for (std::size_t begin = 0; begin < term.b->cells.size(); begin += kChunk)
      chunks.push_back({&term, begin, std::min(begin + kChunk, term.b->cells.size())});
  std::vector<NormalSums> parts(chunks.size());
  ParallelFor(chunks.size(),
              [&](std::size_t i) { parts[i] = SumOf(*chunks[i].term, chunks[i].begin, chunks[i].end, T_a_b); });
  NormalSums sum;
  for (const NormalSums& part : parts) {
    sum.H += part.H;
    sum.g += part.g;
  }
  return sum;
}

}  // namespace

NormalSums SumsOf(const PolishTerm& term, const Se3& T_a_b) { return SumOf(std::vector<PolishTerm>{term}, T_a_b); }

Polished Polish(const std::vector<PolishTerm>& terms, const Se3& start, const Directions& locked) {
  Polished polished{start, 0, 0, false};
  const Matrix6d keep = Matrix6d::Identity() - locked * locked.transpose();
  while (polished.iterations < kIterationsMax && !polished.converged) {
    ++polished.iterations;
    const NormalSums sum = SumOf(terms, polished.T_a_b);
    const double largest = std::max(sum.H.diagonal().maxCoeff(), 1e-9);
    const Matrix6d H = keep * sum.H * keep + largest * (locked * locked.transpose() + 1e-9 * Matrix6d::Identity());
    Vector6d step = -H.ldlt().solve(keep * sum.g);
    if (!step.allFinite()) {
      polished.last_step = std::numeric_limits<double>::infinity();
      break;
    }
    // Pairs that change to and fro would keep it going for ever: later steps are shorter.
    if (polished.iterations > 20) step *= 20.0 / polished.iterations / 2;
    polished.last_step = step.norm();
    polished.T_a_b = (polished.T_a_b * Se3::Exp(step)).Normalized();
    polished.converged = polished.last_step <= kNdtStepMax / 10;
  }
  polished.converged = polished.last_step <= kNdtStepMax;
  return polished;
}

}  // namespace rigcal::calib
