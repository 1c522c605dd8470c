// Visits of a robot of three sensors, drawn from their own covariances.
#pragma once

#include <Eigen/Cholesky>
#include <random>

#include "server/graph/fusion/session_fusion.h"
#include "server/graph/solve/solve.h"
#include "server/math/covariance.h"

namespace rigcal::graph {

inline const SensorId kBase("base"), kLeft("left"), kRight("right");
inline const std::vector<SensorId> kSensors = {kBase, kLeft, kRight};

inline SessionId SessionNamed(int k) {
  return SessionId(std::string(62, 'a') + (k < 10 ? "0" : "") + std::to_string(k));
}
inline Se3 Pose(double x_m, double rz_rad) {
  return Se3::Exp((Vector6d() << x_m, 0.2, 0.1, 0.05, -0.1, rz_rad).finished());
}
inline std::vector<Se3> Truth() { return {Se3{}, Pose(0.5, 0.3), Pose(-0.4, 1.2)}; }
inline Eigen::MatrixXd CovarianceOf(double sigma_m, double sigma_rad) {
  Eigen::VectorXd variance(12);
  for (int i = 0; i < 12; ++i) variance[i] = std::pow(i % 6 < 3 ? sigma_m : sigma_rad, 2);
  Eigen::MatrixXd C = variance.asDiagonal();
  C.topRightCorner(6, 6) = C.bottomLeftCorner(6, 6) = 0.4 * Eigen::MatrixXd(C.topLeftCorner(6, 6));
  return C;
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  Eigen::VectorXd Normal(Eigen::Index size) {
    return Eigen::VectorXd::NullaryExpr(size, [&] { return normal_(engine_); });
  }
  Eigen::VectorXd Of(const Eigen::MatrixXd& C) { return C.llt().matrixL() * Normal(C.rows()); }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

inline std::vector<Se3> Scattered(const std::vector<Se3>& truth, double sigma_m, double sigma_rad, Random& random) {
  std::vector<Se3> visit = truth;
  for (std::size_t s = 1; s < visit.size(); ++s) {
    Vector6d b = random.Normal(6);
    b.head<3>() *= sigma_m;
    b.tail<3>() *= sigma_rad;
    visit[s] = visit[s] * Se3::Exp(b);
  }
  return visit;
}

// Drawn around `truth` by C, in the frame of the base.
inline SessionEstimate Drawn(int k, const std::vector<Se3>& truth, const Eigen::MatrixXd& C, Random& random) {
  SessionEstimate estimate;
  estimate.session = SessionNamed(k);
  estimate.reference = kBase;
  const Eigen::VectorXd e = random.Of(C);
  estimate.poses = {{kBase, {}, 0.0},
                    {kLeft, truth[1] * Se3::Exp(e.head<6>()), 200.0},
                    {kRight, truth[2] * Se3::Exp(e.tail<6>()), 200.0}};
  estimate.covariance = C;
  return estimate;
}

inline Edge GoodEdge(const SessionId& session, std::size_t a, std::size_t b, const Se3& T_a_b, double sigma_m,
                     double sigma_rad) {
  Edge edge;
  edge.robot = RobotId("robot");
  edge.frame_a = kSensors[a], edge.frame_b = kSensors[b];
  edge.method = session.empty() ? "given" : "stereo";
  edge.id = EstimatedEdgeId(edge.robot, session.empty() ? SessionNamed(99) : session, edge.method, edge.frame_a,
                            edge.frame_b);
  edge.session = session;
  edge.T_a_b = T_a_b;
  edge.state = EdgeState::kGood;
  Vector6d information;
  information << Eigen::Vector3d::Constant(1 / (sigma_m * sigma_m)),
      Eigen::Vector3d::Constant(1 / (sigma_rad * sigma_rad));
  edge.uncertainty = FromInformation(information.asDiagonal(), UncertaintySource::kModel, 0);
  return edge;
}

// The pairs of a session say less exactly what its refinement says.
inline std::vector<Edge> PairsOf(const SessionEstimate& estimate) {
  std::vector<Edge> edges;
  for (const auto& [a, b] : {std::pair<std::size_t, std::size_t>{0, 1}, {0, 2}, {1, 2}})
    edges.push_back(GoodEdge(
        estimate.session, a, b,
        estimate.poses[a].T_ref_sensor.Inverse() * estimate.poses[b].T_ref_sensor * Se3::Exp(1e-4 * Vector6d::Ones()),
        0.01, 0.01));
  return edges;
}

struct Robot {
  std::vector<Edge> edges;
  std::vector<SessionEstimate> estimates;
  void Add(const SessionEstimate& estimate) {
    for (Edge& edge : PairsOf(estimate)) edges.push_back(std::move(edge));
    estimates.push_back(estimate);
  }
  [[nodiscard]] GraphSolution Fused(const PooledScatter& pooled = {}) const {
    GraphSolution solution = Solve(GraphOf(edges, kBase));
    FuseSessions(edges, {}, kBase, estimates, solution, pooled);
    return solution;
  }
};

inline Robot Visits(int count, const std::vector<Se3>& truth, double sigma_m, double sigma_rad,
                    const Eigen::MatrixXd& C, Random& random) {
  Robot robot;
  for (int k = 0; k < count; ++k) robot.Add(Drawn(k, Scattered(truth, sigma_m, sigma_rad, random), C, random));
  return robot;
}

}  // namespace rigcal::graph
