#include "server/calib/lidar_lidar/surface_polish.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "server/base/process/parallel_for.h"

namespace rigcal::calib {
namespace {

constexpr std::size_t kCellsAtOnce = 512;          // cells; fixed, so that sums do not depend on threads
constexpr std::size_t kMeans = 10, kMeansMin = 5;  // that make a normal
constexpr int kBucketCells = 4;                    // a normal's means lie within so many cells

struct Near {
  double distance_m2;
  std::size_t number;
  bool operator<(const Near& other) const {
    return distance_m2 != other.distance_m2 ? distance_m2 < other.distance_m2 : number < other.number;
  }
};

// Which cells lie in each cube of kBucketCells^3.
struct Buckets {
  CellIndex index;
  std::vector<std::vector<std::size_t>> cells;
};

Eigen::Vector3i BucketOf(const Eigen::Vector3i& cell) {
  return {cell.x() >> 2, cell.y() >> 2, cell.z() >> 2};  // an arithmetic shift is the floor of the quarter
}

Buckets BucketsOf(const CellIndex& index) {
  static_assert(kBucketCells == 4);
  Buckets buckets{CellIndex(index.keys().size() / 8), {}};
  for (std::size_t number = 0; number < index.keys().size(); ++number) {
    const Eigen::Vector3i at = BucketOf(CellOf(index.keys()[number]));
    const std::uint32_t bucket = buckets.index.Add(CellKeyOf(at.x(), at.y(), at.z()));
    if (bucket == buckets.cells.size()) buckets.cells.emplace_back();
    buckets.cells[bucket].push_back(number);
  }
  return buckets;
}

// The nearest cells, itself included.
std::vector<Near> NearestOf(const SurfaceCells& surface, const Buckets& buckets, std::size_t number) {
  std::vector<Near> near;
  const Eigen::Vector3d at = surface.cells[number].mean_m;
  ForCellsAround(buckets.index, BucketOf(CellOf(surface.index.keys()[number])), 1, [&](std::size_t bucket) {
    for (const std::size_t other : buckets.cells[bucket])
      near.push_back({(surface.cells[other].mean_m - at).squaredNorm(), other});
  });
  if (near.size() > kMeans) {
    std::nth_element(near.begin(), near.begin() + kMeans, near.end());
    near.resize(kMeans);
  }
  std::sort(near.begin(), near.end());  // sums in one order
  return near;
}

void FillNormal(const Buckets& buckets, SurfaceCells& surface, std::size_t number) {
  std::vector<SurfaceCell>& cells = surface.cells;
  const std::vector<Near> near = NearestOf(surface, buckets, number);
  if (near.size() < kMeansMin) return;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Near& other : near) mean += cells[other.number].mean_m / static_cast<double>(near.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Near& other : near) {
    const Eigen::Vector3d off = cells[other.number].mean_m - mean;
    scatter += off * off.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread;
  spread.computeDirect(scatter);
  cells[number].normal = spread.eigenvectors().col(0);
  cells[number].has_normal = cells[number].normal.allFinite();
}

constexpr double kThinRatio = 1e-3;   // of a piece of surface: variance across against variance along
constexpr double kKernelCells = 3.0;  // half the pull at this distance across, in cells
constexpr int kPolishIterationsMax = 60;

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
  const auto sums = SumsOfChunks<NormalSums>(
      terms, kCellsAtOnce, [](const PolishTerm& term) { return term.b->cells.size(); },
      [&](const PolishTerm& term, std::size_t begin, std::size_t end) { return SumOf(term, begin, end, T_a_b); });
  NormalSums sum;
  for (const NormalSums& part : sums) sum.H += part.H, sum.g += part.g;
  return sum;
}

}  // namespace

const SurfaceCell* SurfaceCells::Nearest(const Eigen::Vector3d& q_m) const {
  const Eigen::Vector3d scaled = q_m / cell_m;
  if (!(scaled.cwiseAbs().maxCoeff() < kCellsMax - 4)) return nullptr;
  const SurfaceCell* nearest = nullptr;
  double best_m2 = std::numeric_limits<double>::infinity();
  ForCellsAround(index, scaled.array().floor().cast<int>(), 2, [&](std::size_t number) {
    const double distance_m2 = (cells[number].mean_m - q_m).squaredNorm();
    if (distance_m2 < best_m2) best_m2 = distance_m2, nearest = &cells[number];
  });
  return nearest;
}

SurfaceCells SurfaceCellsOf(const MomentGrid& grid) {
  SurfaceCells surface{grid.cell_m, grid.index, std::vector<SurfaceCell>(grid.cells.size())};
  for (std::size_t i = 0; i < grid.cells.size(); ++i) surface.cells[i].mean_m = grid.cells[i].Mean();
  const Buckets buckets = BucketsOf(grid.index);
  ParallelFor((grid.cells.size() + kCellsAtOnce - 1) / kCellsAtOnce, [&](std::size_t chunk) {
    const std::size_t end = std::min((chunk + 1) * kCellsAtOnce, grid.cells.size());
    for (std::size_t i = chunk * kCellsAtOnce; i < end; ++i) FillNormal(buckets, surface, i);
  });
  return surface;
}

NormalSums SumsOf(const PolishTerm& term, const Se3& T_a_b) { return SumOf(std::vector<PolishTerm>{term}, T_a_b); }

Polished Polish(const std::vector<PolishTerm>& terms, const Se3& start, const Directions& locked) {
  Polished polished{start, 0, 0, false};
  const Matrix6d keep = Matrix6d::Identity() - locked * locked.transpose();
  while (polished.iterations < kPolishIterationsMax && !polished.converged) {
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
