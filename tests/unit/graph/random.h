// Random sensor graphs with known truth.
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "server/base/digests/sha256.h"
#include "server/graph/solve/solve.h"
#include "server/math/covariance.h"

namespace rigcal::graph {

struct RandomRig {
  Graph graph;
  std::vector<Se3> truth;  // T_ref_sensor, in the order of graph.sensors
};

inline Vector6d RandomVector(std::mt19937& random, double sigma_m, double sigma_rad) {
  std::normal_distribution<double> normal;
  Vector6d v;
  for (int k = 0; k < 6; ++k) v(k) = normal(random) * (k < 3 ? sigma_m : sigma_rad);
  return v;
}

// A positive definite information matrix with correlated axes and eigenvalues over two decades.
inline Matrix6d RandomInformation(std::mt19937& random, double sigma_m, double sigma_rad) {
  Matrix6d A;
  for (int c = 0; c < 6; ++c) A.col(c) = RandomVector(random, 1.0, 1.0);
  Vector6d scale;
  scale << Eigen::Vector3d::Constant(sigma_m), Eigen::Vector3d::Constant(sigma_rad);
  const Matrix6d C = scale.asDiagonal() * (A * A.transpose() / 6.0 + 0.05 * Matrix6d::Identity()) * scale.asDiagonal();
  return Symmetrized(C.inverse());
}

// A draw from N(0, Omega^-1).
inline Vector6d DrawError(std::mt19937& random, const Matrix6d& Omega) {
  const Eigen::LLT<Matrix6d> llt(Omega);
  return llt.matrixU().solve(RandomVector(random, 1.0, 1.0));
}

inline EdgeId IdOf(std::size_t k) { return EdgeId(Sha256Of("edge " + std::to_string(k)).str()); }

inline SensorId Name(std::size_t k) { return SensorId(std::to_string(k)); }

inline GraphEdge MakeEdge(std::size_t k, std::size_t a, std::size_t b, const Se3& T_a_b, const Matrix6d& Omega) {
  return {IdOf(k), Name(a), Name(b), T_a_b, Omega, Observable(Omega).rank, 0, SessionId()};
}

// Sensors 0..vertices-1 within a cube; a random tree first, then random further pairs. Information as given, or random.
inline RandomRig MakeRig(std::size_t vertices, std::size_t edges, unsigned seed, double sigma_m = 0.005,
                         double sigma_rad = 0.005, bool anisotropic = true) {
  std::mt19937 random(seed);
  RandomRig rig;
  for (std::size_t v = 0; v < vertices; ++v) {
    rig.graph.sensors.push_back(Name(v));
    rig.truth.push_back(v == 0 ? Se3() : Se3::Exp(RandomVector(random, 0.7, 0.8)).Normalized());
  }
  rig.graph.reference = Name(0);
  for (std::size_t k = 0; k < edges; ++k) {
    std::size_t a = k + 1 < vertices ? random() % (k + 1) : random() % vertices;
    std::size_t b = k + 1 < vertices ? k + 1 : random() % vertices;
    while (a == b) b = random() % vertices;
    if (random() % 2 == 0) std::swap(a, b);
    Matrix6d Omega = Matrix6d::Zero();
    Omega.diagonal() << Eigen::Vector3d::Constant(1 / (sigma_m * sigma_m)),
        Eigen::Vector3d::Constant(1 / (sigma_rad * sigma_rad));
    if (anisotropic) Omega = RandomInformation(random, sigma_m, sigma_rad);
    const Se3 T_a_b = (rig.truth[a].Inverse() * rig.truth[b] * Se3::Exp(-DrawError(random, Omega))).Normalized();
    rig.graph.edges.push_back(MakeEdge(k, a, b, T_a_b, Omega));
  }
  return rig;
}

// Every pair of `count` sensors once.
inline RandomRig FullRig(std::size_t count, unsigned seed) {
  RandomRig rig = MakeRig(count, count - 1, seed);
  rig.graph.edges.clear();
  std::mt19937 random(seed + 1);
  std::size_t k = 0;
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = a + 1; b < count; ++b) {
      const Matrix6d Omega = RandomInformation(random, 0.002, 0.002);
      const Se3 T = rig.truth[a].Inverse() * rig.truth[b] * Se3::Exp(DrawError(random, Omega));
      rig.graph.edges.push_back(MakeEdge(k++, a, b, T, Omega));
    }
  return rig;
}

// Honest over analytic sigma, axis by axis; 1 where both are zero.
inline Vector6d SigmaRatio(const Matrix6d& honest, const Matrix6d& analytic) {
  Vector6d ratio = Vector6d::Ones();
  for (int axis = 0; axis < 6; ++axis)
    if (analytic(axis, axis) > 0.0) ratio(axis) = std::sqrt(std::max(0.0, honest(axis, axis)) / analytic(axis, axis));
  return ratio;
}

}  // namespace rigcal::graph
