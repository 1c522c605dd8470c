#include "server/graph/solve/observability.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

using Eigen::MatrixXd;

constexpr int kBodiesMax = 200;          // beyond: not judged
constexpr double kToleranceMin = 1e-10;  // of eigenvalues, which are squared sines of angles between directions
constexpr double kToleranceMax = 1e-2;
constexpr double kNoiseFactor = 3.0;

// Vertices tied by edges of full rank. Body 0 holds the reference. A body's motion is a twist of its first vertex.
struct Bodies {
  std::vector<int> body_of_vertex;
  std::vector<int> first_vertex;
};

Bodies FindBodies(const Problem& problem) {
  UnionFind sets(static_cast<std::size_t>(problem.vertex_count));
  for (const Constraint& c : problem.constraints)
    if (c.rank == 6) sets.Join(c.i, c.j);
  Bodies bodies;
  bodies.body_of_vertex.resize(static_cast<std::size_t>(problem.vertex_count));
  for (int v = 0; v < problem.vertex_count; ++v) {
    const int root = sets.Find(v);  // the smallest of the set: seen before its members
    if (root == v) bodies.first_vertex.push_back(v);
    bodies.body_of_vertex[static_cast<std::size_t>(v)] = root == v
                                                             ? static_cast<int>(bodies.first_vertex.size()) - 1
                                                             : bodies.body_of_vertex[static_cast<std::size_t>(root)];
  }
  return bodies;
}

// A length that makes metres and radians comparable: the typical length of an edge.
double TypicalLength_m(const Problem& problem) {
  double sum_m2 = 0.0;
  for (const Constraint& c : problem.constraints) sum_m2 += c.T_i_j.p_m.squaredNorm();
  const double length_m = std::sqrt(sum_m2 / static_cast<double>(std::max<std::size_t>(problem.constraints.size(), 1)));
  return length_m > 1e-6 ? length_m : 1.0;
}

// Rows: an orthonormal basis, in scaled units, of the directions of e that the edge sees.
MatrixXd SeenDirections(const Matrix6d& Omega, const Vector6d& scale) {
  const FreeBasis unseen = Observable(Omega).unobservable_basis;
  const MatrixXd scaled = scale.cwiseInverse().asDiagonal() * unseen;
  const Matrix6d Q = Eigen::HouseholderQR<MatrixXd>(scaled).householderQ() * MatrixXd::Identity(6, 6);
  return Q.rightCols(6 - unseen.cols()).transpose() * scale.cwiseInverse().asDiagonal();
}

// What body twists the deficient edges see: one row per direction, columns in scaled body twists (body 0 is fixed).
MatrixXd GeometryMatrix(const Problem& problem, const Poses& T_ref, const Bodies& bodies, const Vector6d& scale) {
  const auto columns = 6 * (static_cast<Eigen::Index>(bodies.first_vertex.size()) - 1);
  MatrixXd G = MatrixXd::Zero(columns, columns);
  for (const Constraint& c : problem.constraints) {
    const int a = bodies.body_of_vertex[static_cast<std::size_t>(c.i)],
              b = bodies.body_of_vertex[static_cast<std::size_t>(c.j)];
    if (a == b) continue;
    const MatrixXd seen = SeenDirections(c.Omega, scale) * RightJacobianInverse(Residual(c, T_ref));
    const Se3 T_j_ref = T_ref[static_cast<std::size_t>(c.j)].Inverse();
    const auto rows_of = [&](int body) -> MatrixXd {
      const Se3& T_ref_body = T_ref[static_cast<std::size_t>(bodies.first_vertex[static_cast<std::size_t>(body)])];
      return seen * Adjoint(T_j_ref * T_ref_body) * scale.asDiagonal();
    };
    const MatrixXd rows_a = rows_of(a), rows_b = rows_of(b);
    if (a > 0) G.block<6, 6>(6 * (a - 1), 6 * (a - 1)) += rows_a.transpose() * rows_a;
    if (b > 0) G.block<6, 6>(6 * (b - 1), 6 * (b - 1)) += rows_b.transpose() * rows_b;
    if (a == 0 || b == 0) continue;
    G.block<6, 6>(6 * (a - 1), 6 * (b - 1)) -= rows_a.transpose() * rows_b;
    G.block<6, 6>(6 * (b - 1), 6 * (a - 1)) -= rows_b.transpose() * rows_a;
  }
  return G;
}

// Deficient edges' residual rotations turn their unseen directions against each other.
double Tolerance(const Problem& problem, const Poses& T_ref) {
  double sum_rad2 = 0.0;
  int count = 0;
  for (const Constraint& c : problem.constraints) {
    if (c.rank == 6) continue;
    sum_rad2 += Residual(c, T_ref).tail<3>().squaredNorm();
    ++count;
  }
  const double noise_rad2 = count > 0 ? sum_rad2 / count : 0.0;
  return std::clamp(kNoiseFactor * kNoiseFactor * noise_rad2, kToleranceMin, kToleranceMax);
}

// Null vectors of G as columns, in scaled body twists.
MatrixXd NullVectors(const MatrixXd& G, double tolerance) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(G);
  Eigen::Index count = 0;
  while (count < G.rows() && eigen.eigenvalues()(count) <= tolerance) ++count;
  return eigen.eigenvectors().leftCols(count);
}

// An orthonormal basis of the columns, without what is only noise in them.
MatrixXd RangeOf(const MatrixXd& columns, double visible) {
  if (columns.cols() == 0) return MatrixXd(6, 0);
  const Eigen::JacobiSVD<MatrixXd> svd(columns, Eigen::ComputeThinU);
  Eigen::Index count = 0;
  while (count < svd.singularValues().size() && svd.singularValues()(count) > visible) ++count;
  return svd.matrixU().leftCols(count);
}

// One coordinate per null vector, chosen so that holding them all leaves no motion.
std::vector<Pin> ChoosePins(const MatrixXd& null_vectors, const Bodies& bodies) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(null_vectors.transpose());
  std::vector<Pin> pins;
  for (Eigen::Index k = 0; k < null_vectors.cols(); ++k) {
    const int column = qr.colsPermutation().indices()(k);
    const int vertex = bodies.first_vertex[static_cast<std::size_t>(column / 6) + 1];
    pins.push_back({6 * (vertex - 1) + column % 6});
  }
  return pins;
}

// What of these motions, in metres and radians, is more than noise. Null vectors have unit length over all bodies; a
// body that is held shows in them only as much as the tolerance lets through.
FreeBasis FreeDirections(const FreeBasis& motions, const Observability& observability) {
  const Vector6d& scale = observability.scale;
  return scale.asDiagonal() * RangeOf(scale.cwiseInverse().asDiagonal() * motions, observability.visible);
}

// Everything outside the reference's body, held as a whole.
void LeaveUnjudged(const Problem& problem, const Bodies& bodies, Observability& result) {
  result.judged = false;
  for (std::size_t body = 1; body < bodies.first_vertex.size(); ++body)
    for (int axis = 0; axis < 6; ++axis) result.pins.push_back({6 * (bodies.first_vertex[body] - 1) + axis});
  for (int v = 0; v < problem.vertex_count; ++v)
    if (bodies.body_of_vertex[static_cast<std::size_t>(v)] > 0)
      result.free_of_vertex[static_cast<std::size_t>(v)] = Matrix6d::Identity();
}

constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

// "z", or "(0.71, 0.71, 0.00)" if it is no axis.
std::string NameAxis(const Eigen::Vector3d& direction) {
  Eigen::Vector3d unit = direction.normalized();
  Eigen::Index largest = 0;
  unit.cwiseAbs().maxCoeff(&largest);
  constexpr double kAlongAxis = 0.9998;  // within a degree
  if (std::abs(unit(largest)) > kAlongAxis) return kAxes[static_cast<std::size_t>(largest)];
  if (unit(largest) < 0.0) unit = -unit;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "(%.2f, %.2f, %.2f)", unit.x() + 0.0, unit.y() + 0.0, unit.z() + 0.0);
  return text.data();
}

std::string NameDirection(const Vector6d& direction) {
  const Eigen::Vector3d translation = direction.head<3>(), rotation = direction.tail<3>();
  constexpr double kNothing = 1e-3;
  if (rotation.norm() < kNothing) return "translation along " + NameAxis(translation);
  std::string text = "rotation about " + NameAxis(rotation);
  if (translation.norm() >= kNothing) text += " coupled with translation along " + NameAxis(translation);
  return text;
}

}  // namespace

Observability Observe(const Problem& problem, const Poses& T_ref) {
  Observability result;
  result.free_of_vertex.assign(static_cast<std::size_t>(problem.vertex_count), FreeBasis(6, 0));
  if (problem.HasFullRank()) return result;
  const Bodies bodies = FindBodies(problem);
  const int free_bodies = static_cast<int>(bodies.first_vertex.size()) - 1;
  if (free_bodies == 0) return result;
  if (free_bodies > kBodiesMax) return LeaveUnjudged(problem, bodies, result), result;
  result.scale = EachAxis(TypicalLength_m(problem), 1.0);
  const double tolerance = Tolerance(problem, T_ref);
  result.visible = std::clamp(kNoiseFactor * std::sqrt(tolerance), 1e-5, 0.1);
  const MatrixXd null_vectors = NullVectors(GeometryMatrix(problem, T_ref, bodies, result.scale), tolerance);
  result.nullity = static_cast<int>(null_vectors.cols());
  if (result.nullity == 0) return result;
  result.pins = ChoosePins(null_vectors, bodies);
  result.motion_of_vertex.assign(result.free_of_vertex.size(), FreeBasis::Zero(6, result.nullity));
  for (std::size_t v = 0; v < result.free_of_vertex.size(); ++v) {
    const int body = bodies.body_of_vertex[v];
    if (body == 0) continue;
    const Se3& T_ref_body = T_ref[static_cast<std::size_t>(bodies.first_vertex[static_cast<std::size_t>(body)])];
    result.motion_of_vertex[v] = Adjoint(T_ref[v].Inverse() * T_ref_body) * result.scale.asDiagonal() *
                                 null_vectors.middleRows(6 * (body - 1), 6);
    result.free_of_vertex[v] = FreeDirections(result.motion_of_vertex[v], result);
  }
  return result;
}

FreeBasis FreeBetween(const Observability& observability, int i, int j, const Se3& T_i_j) {
  if (observability.motion_of_vertex.empty()) return FreeBasis(6, 0);
  const auto& motions = observability.motion_of_vertex;
  const FreeBasis apart =
      motions[static_cast<std::size_t>(j)] - Adjoint(T_i_j.Inverse()) * motions[static_cast<std::size_t>(i)];
  return FreeDirections(apart, observability);
}

std::unique_ptr<BlockCholesky<6>> FactorAt(const Problem& problem, const Poses& T_ref) {
  NormalEquations equations;
  Linearize(problem, T_ref, equations);
  AddPins(Observe(problem, T_ref).pins, equations.H);
  auto cholesky = MakeCholesky<6>(problem.pattern);
  return cholesky != nullptr && cholesky->Factor(equations.H, 0.0) ? std::move(cholesky) : nullptr;
}

// Reduced column echelon form: every column gets a coordinate of its own, so that pure axes show as such. Rotations are
// eliminated first: what remains are pure translations.
FreeBasis Reduced(FreeBasis basis) {
  std::array<bool, 6> used{};
  for (Eigen::Index c = 0; c < basis.cols(); ++c) {
    Eigen::Index row = -1, column = c;
    for (const auto& [start, count] : {std::pair(3, 3), std::pair(0, 3)}) {
      double best = 1e-3;
      for (Eigen::Index k = c; k < basis.cols(); ++k)
        for (Eigen::Index r = start; r < start + count; ++r)
          if (!used[static_cast<std::size_t>(r)] && std::abs(basis(r, k)) > best)
            best = std::abs(basis(r, k)), row = r, column = k;
      if (row >= 0) break;
    }
    if (row < 0) break;
    used[static_cast<std::size_t>(row)] = true;
    basis.col(c).swap(basis.col(column));
    basis.col(c) /= basis(row, c);
    for (Eigen::Index k = 0; k < basis.cols(); ++k)
      if (k != c) basis.col(k) -= basis(row, k) * basis.col(c);
  }
  constexpr double kRounding = 1e-9;
  return (basis.array().abs() < kRounding).select(0.0, basis);
}

std::vector<Vector6d> ColumnsOf(const FreeBasis& basis) {
  std::vector<Vector6d> directions;
  for (Eigen::Index k = 0; k < basis.cols(); ++k) directions.emplace_back(basis.col(k));
  return directions;
}

FreeBasis BasisOf(const std::vector<Vector6d>& directions) {
  FreeBasis basis(6, static_cast<Eigen::Index>(directions.size()));
  for (std::size_t k = 0; k < directions.size(); ++k) basis.col(static_cast<Eigen::Index>(k)) = directions[k];
  return basis;
}

std::string NameDirections(const FreeBasis& basis) {
  const FreeBasis reduced = Reduced(basis);
  std::string text;
  for (Eigen::Index c = 0; c < reduced.cols(); ++c) {
    if (c > 0) text += c + 1 == reduced.cols() ? " and " : ", ";
    text += NameDirection(reduced.col(c));
  }
  return text;
}

}  // namespace rigcal::graph
