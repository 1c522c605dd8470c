#include "tests/unit/graph/ceres.h"

#include <ceres/autodiff_manifold.h>
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <string>

namespace rigcal::graph {
namespace {

template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

// Log of SE(3) by its own route: matrix V(phi) solved, not inverted in closed form. Angles stay below pi in these
// tests.
template <typename T>
Eigen::Matrix<T, 6, 1> LogOf(const Eigen::Quaternion<T>& q_in, const Vector3<T>& p) {
  const Eigen::Quaternion<T> q = q_in.w() < T(0) ? Eigen::Quaternion<T>(-q_in.coeffs()) : q_in;
  const std::array<T, 4> wxyz = {q.w(), q.x(), q.y(), q.z()};
  std::array<T, 3> phi_array;
  ceres::QuaternionToAngleAxis(wxyz.data(), phi_array.data());
  const Vector3<T> phi(phi_array[0], phi_array[1], phi_array[2]);
  const T theta2 = phi.squaredNorm() + T(1e-30);
  const T theta = sqrt(theta2);
  Eigen::Matrix<T, 3, 3> P;
  P << T(0), -phi.z(), phi.y(), phi.z(), T(0), -phi.x(), -phi.y(), phi.x(), T(0);
  T b = (T(1) - cos(theta)) / theta2, c = (theta - sin(theta)) / (theta2 * theta);
  if (theta < T(1e-3)) b = T(0.5) - theta2 / T(24), c = T(1) / T(6) - theta2 / T(120);
  const Eigen::Matrix<T, 3, 3> V = Eigen::Matrix<T, 3, 3>::Identity() + b * P + c * P * P;
  Eigen::Matrix<T, 6, 1> xi;
  xi.template head<3>() = V.inverse() * p;
  xi.template tail<3>() = phi;
  return xi;
}

struct EdgeCost {
  Se3 T_a_b;
  Matrix6d sqrt_Omega;
  template <typename T>
  bool operator()(const T* a, const T* b, T* residual) const {
    const Eigen::Map<const Vector3<T>> p_a(a), p_b(b);
    const Eigen::Map<const Eigen::Quaternion<T>> q_a(a + 3), q_b(b + 3);
    const Eigen::Quaternion<T> q_m = T_a_b.q.conjugate().cast<T>();
    const Eigen::Quaternion<T> q = q_m * (q_a.conjugate() * q_b);
    const Vector3<T> p = q_m * (q_a.conjugate() * (p_b - p_a) - T_a_b.p_m.cast<T>());
    Eigen::Map<Eigen::Matrix<T, 6, 1>> e(residual);
    e = sqrt_Omega.cast<T>() * LogOf<T>(q, p);
    return true;
  }
};

// [p, q_xyzw]: world-frame translation step, rotation vector on the right.
struct PoseSteps {
  template <typename T>
  bool Plus(const T* x, const T* delta, T* sum) const {
    for (int k = 0; k < 3; ++k) sum[k] = x[k] + delta[k];
    std::array<T, 4> wxyz;
    ceres::AngleAxisToQuaternion(delta + 3, wxyz.data());
    const Eigen::Quaternion<T> step(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
    Eigen::Map<Eigen::Quaternion<T>> result(sum + 3);
    result = Eigen::Map<const Eigen::Quaternion<T>>(x + 3) * step;
    return true;
  }
  template <typename T>
  bool Minus(const T* y, const T* x, T* delta) const {
    for (int k = 0; k < 3; ++k) delta[k] = y[k] - x[k];
    const Eigen::Quaternion<T> q =
        Eigen::Map<const Eigen::Quaternion<T>>(x + 3).conjugate() * Eigen::Map<const Eigen::Quaternion<T>>(y + 3);
    const std::array<T, 4> wxyz = {q.w(), q.x(), q.y(), q.z()};
    ceres::QuaternionToAngleAxis(wxyz.data(), delta + 3);
    return true;
  }
};
using PoseManifold = ceres::AutoDiffManifold<PoseSteps, 7, 6>;

}  // namespace

CeresSolution SolveWithCeres(const Graph& graph, const GraphSolution& start) {
  CeresSolution solution;
  for (const SensorPose& pose : start.poses) {
    const Se3& T = pose.T_ref_sensor;
    solution.poses.push_back({T.p_m.x(), T.p_m.y(), T.p_m.z(), T.q.x(), T.q.y(), T.q.z(), T.q.w()});
  }
  ceres::Problem problem;
  for (auto& pose : solution.poses) problem.AddParameterBlock(pose.data(), 7, new PoseManifold);
  problem.SetParameterBlockConstant(solution.poses[0].data());
  for (const GraphEdge& edge : graph.edges) {
    const Matrix6d sqrt_Omega = edge.Omega.llt().matrixU();
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<EdgeCost, 6, 7, 7>(new EdgeCost{edge.T_a_b, sqrt_Omega}),
                             nullptr, solution.poses[std::stoul(edge.frame_a.str())].data(),
                             solution.poses[std::stoul(edge.frame_b.str())].data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 1e-16;
  options.initial_trust_region_radius = 1e12;
  options.max_num_iterations = 100;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  solution.cost = 2.0 * summary.final_cost;
  return solution;
}

}  // namespace rigcal::graph
