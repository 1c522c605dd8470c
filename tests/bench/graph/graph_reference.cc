#include "tests/bench/graph/graph_reference.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <array>
#include <chrono>
#include <map>
#include <random>

namespace rigcal::bench {
namespace {

using Pose = std::array<double, 7>;  // p, q_xyzw

Se3 Se3Of(const double* pose) { return {Eigen::Map<const Eigen::Vector3d>(pose), Eigen::Quaterniond(pose + 3)}; }

void Write(const Se3& T, double* pose) {
  Eigen::Map<Eigen::Vector3d>{pose} = T.p_m;
  Eigen::Map<Eigen::Vector4d>(pose + 3) = T.q.coeffs();
}

// T * Exp(step). Costs give their Jacobians by the step itself, in the first six columns.
class RightSteps final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* step, double* sum) const override {
    return Write((Se3Of(x) * Se3::Exp(Eigen::Map<const Vector6d>(step))).Normalized(), sum), true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* step) const override {
    Eigen::Map<Vector6d>{step} = (Se3Of(x).Inverse() * Se3Of(y)).Log();
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
};

class EdgeCost final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  explicit EdgeCost(const GraphEdge& edge) : T_b_a_(edge.T_a_b.Inverse()), root_(edge.Omega.llt().matrixU()) {}
  bool Evaluate(double const* const* poses, double* residual, double** jacobians) const override {
    const Se3 T_a_b = Se3Of(poses[0]).Inverse() * Se3Of(poses[1]);
    const Vector6d e = (T_b_a_ * T_a_b).Log();
    Eigen::Map<Vector6d>{residual} = root_ * e;
    if (jacobians == nullptr) return true;
    const Matrix6d J_b = root_ * RightJacobianInverse(e);
    Fill(-J_b * Adjoint(T_a_b.Inverse()), jacobians[0]);
    Fill(J_b, jacobians[1]);
    return true;
  }

 private:
  static void Fill(const Matrix6d& J, double* target) {
    if (target == nullptr) return;
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> jacobian(target);
    jacobian.setZero();
    jacobian.leftCols<6>() = J;
  }
  Se3 T_b_a_;
  Matrix6d root_;
};

std::map<SensorId, Pose> StartOf(const Graph& graph) {
  std::map<SensorId, Pose> poses;
  Write(Se3(), poses[graph.reference].data());
  for (std::size_t before = 0; before != poses.size();) {
    before = poses.size();
    for (const GraphEdge& edge : graph.edges) {
      const bool a = poses.contains(edge.frame_a), b = poses.contains(edge.frame_b);
      if (a && !b) Write(Se3Of(poses[edge.frame_a].data()) * edge.T_a_b, poses[edge.frame_b].data());
      if (b && !a) Write(Se3Of(poses[edge.frame_b].data()) * edge.T_a_b.Inverse(), poses[edge.frame_a].data());
    }
  }
  return poses;
}

}  // namespace

std::vector<Edge> RandomEdges(std::size_t vertices, std::size_t edges, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&](double sigma_m, double sigma_rad) {
    Vector6d xi;
    for (int k = 0; k < 6; ++k) xi(k) = normal(random) * (k < 3 ? sigma_m : sigma_rad);
    return Se3::Exp(xi);
  };
  constexpr double kSigma_m = 0.005, kSigma_rad = 0.3 * 3.14159265358979323846 / 180.0;
  std::vector<Se3> T_ref_sensor(vertices);
  for (std::size_t v = 1; v < vertices; ++v) T_ref_sensor[v] = draw(0.7, 0.8);
  std::vector<Edge> result(edges);
  for (std::size_t k = 0; k < edges; ++k) {
    const std::size_t b = k + 1 < vertices ? k + 1 : random() % vertices;
    std::size_t a = k + 1 < vertices ? random() % b : random() % vertices;
    if (a == b) a = (b + 1) % vertices;
    result[k].robot = RobotId("bench");
    result[k].frame_a = SensorId(std::to_string(a));
    result[k].frame_b = SensorId(std::to_string(b));
    result[k].T_a_b = (T_ref_sensor[a].Inverse() * T_ref_sensor[b] * draw(kSigma_m, kSigma_rad)).Normalized();
    result[k].uncertainty.Omega.diagonal() << Eigen::Vector3d::Constant(1 / (kSigma_m * kSigma_m)),
        Eigen::Vector3d::Constant(1 / (kSigma_rad * kSigma_rad));
    result[k].uncertainty.rank = 6;
    result[k].method = "synthetic";
    result[k].state = EdgeState::kGood;
  }
  AssignPushedIds(result);
  return result;
}

nlohmann::json SolveWithCeres(const Graph& graph) {
  const auto begin = std::chrono::steady_clock::now();
  std::map<SensorId, Pose> poses = StartOf(graph);
  ceres::Problem problem;
  for (auto& [sensor, pose] : poses) problem.AddParameterBlock(pose.data(), 7, new RightSteps);
  problem.SetParameterBlockConstant(poses[graph.reference].data());
  for (const GraphEdge& edge : graph.edges)
    if (poses.contains(edge.frame_a))
      problem.AddResidualBlock(new EdgeCost(edge), nullptr, poses[edge.frame_a].data(), poses[edge.frame_b].data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.initial_trust_region_radius = 1e12;
  options.function_tolerance = 1e-10;
  options.max_num_iterations = 100;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - begin;
  return {{"total_ms", elapsed.count()}, {"iterations", summary.iterations.size()}, {"cost", 2.0 * summary.final_cost}};
}

}  // namespace rigcal::bench
