#include "server/graph/fuse_sessions.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "server/graph/visit_scatter.h"
#include "server/math/covariance.h"
#include "server/math/pooled_dof.h"
#include "server/model/past.h"

namespace rigcal::graph {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kFixed = -1;  // the robot's reference
constexpr int kIterationsMax = 30, kScatterRoundsMax = 30;
constexpr double kSettled = 1e-12;       // squared step in sigmas
constexpr double kScatterSettled = 0.01;
// A variance alike along three axes, from 3 (visits - 1) numbers, twice: as sure as a 6 x 6 covariance of so many degrees
// of freedom per visit beyond the first (the same expected error in PooledDof's measure: 42 / 4).
constexpr double kScatterDofPerVisit = 10.0;

// What counts of one session's refinement: poses in the frame of its reference.
struct Factor {
  int frame = kFixed;           // variable: the reference's pose, or a free one
  std::vector<int> variable;    // of each pose
  std::vector<SensorId> sensor;
  std::vector<Se3> T_frame_sensor;
  std::vector<double> dof;
  MatrixXd C, common;           // joint covariance; the part of it that is alike on every visit (may be empty)
};
struct EdgeFactor {
  int a = kFixed, b = kFixed;
  Se3 T_a_b;
  Matrix6d Omega = Matrix6d::Zero();
};

// Sensors first, then the free frames of sessions.
struct Fusion {
  std::vector<SensorId> sensors;
  std::vector<Se3> T_ref;
  std::vector<Factor> factors;
  std::vector<EdgeFactor> edges;
  std::vector<VisitVariance> scatter;  // per sensor

  [[nodiscard]] Eigen::Index Size() const { return 6 * static_cast<Eigen::Index>(T_ref.size()); }
  [[nodiscard]] Se3 Pose(int variable) const { return variable == kFixed ? Se3{} : T_ref[static_cast<std::size_t>(variable)]; }
};

std::set<SensorId> SensorsThatCount(const SessionId& session, const std::vector<Edge>& edges) {
  std::set<SensorId> counting;
  for (const Edge& edge : edges)
    if (edge.session == session && edge.state == EdgeState::kGood) counting.insert({edge.frame_a, edge.frame_b});
  return counting;
}

// What somebody said is wrong is in the refinement of its session all the same.
bool IsFused(const SessionEstimate& estimate, const std::vector<Edge>& edges) {
  return estimate.why_not.empty() && std::none_of(edges.begin(), edges.end(), [&](const Edge& edge) {
    return edge.session == estimate.session && IsPast(edge) && edge.diagnoses.front().code == kRetiredCode;
  });
}

MatrixXd Selected(const MatrixXd& C, const std::vector<int>& rows) {
  MatrixXd selected(6 * static_cast<Eigen::Index>(rows.size()), 6 * static_cast<Eigen::Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < rows.size(); ++j)
      selected.block<6, 6>(6 * static_cast<Eigen::Index>(i), 6 * static_cast<Eigen::Index>(j)) =
          C.block<6, 6>(rows[i], rows[j]);
  return selected;
}

class Builder {
 public:
  Builder(const std::vector<Edge>& edges, const SensorId& reference, const GraphSolution& solution)
      : edges_(edges), reference_(reference) {
    for (const SensorPose& pose : solution.poses) {
      if (!pose.known) continue;
      known_.insert(pose.sensor);
      if (pose.sensor == reference) continue;
      fusion_.sensors.push_back(pose.sensor);
      fusion_.T_ref.push_back(pose.T_ref_sensor);
    }
    fusion_.scatter.resize(fusion_.sensors.size());
  }

  void AddSession(const SessionEstimate& estimate) {
    std::set<SensorId> counting = SensorsThatCount(estimate.session, edges_);
    std::erase_if(counting, [&](const SensorId& sensor) { return !known_.contains(sensor); });
    Factor factor;
    std::vector<int> rows;
    for (std::size_t i = 0; i < estimate.poses.size(); ++i) {
      const RefinedPose& pose = estimate.poses[i];
      const int row = RowOf(estimate, i);
      if (row < 0 || !counting.contains(pose.sensor)) continue;
      rows.push_back(row);
      factor.sensor.push_back(pose.sensor);
      factor.variable.push_back(VariableOf(pose.sensor));
      factor.T_frame_sensor.push_back(pose.T_ref_sensor);
      factor.dof.push_back(pose.dof);
    }
    const bool has_reference = counting.contains(estimate.reference);
    if (rows.size() + (has_reference ? 1 : 0) < 2) return;  // tells no pose against another
    factor.frame = has_reference ? VariableOf(estimate.reference)
                                 : FreeFrame(factor.variable.front(), factor.T_frame_sensor.front());
    factor.C = Selected(estimate.covariance, rows);
    if (estimate.common.rows() > 0) factor.common = Selected(estimate.common, rows);
    refined_.insert(factor.sensor.begin(), factor.sensor.end());
    if (has_reference) refined_.insert(estimate.reference);
    sessions.push_back(estimate.session);
    fusion_.factors.push_back(std::move(factor));
  }

  // After all sessions.
  void AddEdges() {
    for (const Edge& edge : edges_) {
      if (edge.state != EdgeState::kGood || !known_.contains(edge.frame_a) || !known_.contains(edge.frame_b)) continue;
      if (!edge.session.empty() && refined_.contains(edge.frame_a) && refined_.contains(edge.frame_b)) continue;
      fusion_.edges.push_back(
          {VariableOf(edge.frame_a), VariableOf(edge.frame_b), edge.T_a_b, edge.uncertainty.Omega});
    }
  }

  Fusion& fusion() { return fusion_; }
  std::vector<SessionId> sessions;

 private:
  [[nodiscard]] int VariableOf(const SensorId& sensor) const {
    if (sensor == reference_) return kFixed;
    const auto found = std::find(fusion_.sensors.begin(), fusion_.sensors.end(), sensor);
    return static_cast<int>(found - fusion_.sensors.begin());
  }
  int FreeFrame(int variable, const Se3& T_frame_sensor) {
    fusion_.T_ref.push_back(fusion_.Pose(variable) * T_frame_sensor.Inverse());
    return static_cast<int>(fusion_.T_ref.size()) - 1;
  }

  const std::vector<Edge>& edges_;
  const SensorId reference_;
  std::set<SensorId> known_, refined_;
  Fusion fusion_;
};

// Residual and Jacobian of T_a_b = T_a^-1 T_b with right tangents at both.
void AddRelative(const Fusion& fusion, int a, int b, const Se3& T_a_b, Eigen::Index row, VectorXd& e, MatrixXd& J) {
  const Se3 predicted = fusion.Pose(a).Inverse() * fusion.Pose(b);
  const Vector6d own = (T_a_b.Inverse() * predicted).Log();
  const Matrix6d by_b = RightJacobianInverse(own);
  e.segment<6>(row) = own;
  if (b != kFixed) J.block<6, 6>(row, 6 * b) += by_b;
  if (a != kFixed) J.block<6, 6>(row, 6 * a) -= by_b * Adjoint(predicted.Inverse());
}

struct Linear {
  VectorXd e;
  MatrixXd J, W;
};

Linear LinearizedOf(const Fusion& fusion, const Factor& factor) {
  const auto rows = 6 * static_cast<Eigen::Index>(factor.variable.size());
  Linear linear{VectorXd::Zero(rows), MatrixXd::Zero(rows, fusion.Size()), {}};
  MatrixXd C = factor.C;
  for (std::size_t i = 0; i < factor.variable.size(); ++i) {
    const auto row = 6 * static_cast<Eigen::Index>(i);
    AddRelative(fusion, factor.frame, factor.variable[i], factor.T_frame_sensor[i], row, linear.e, linear.J);
    if (factor.variable[i] != kFixed)
      C.block<6, 6>(row, row) += fusion.scatter[static_cast<std::size_t>(factor.variable[i])].Matrix();
  }
  const VectorXd scale = C.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd inverse = (scale.asDiagonal() * C * scale.asDiagonal()).llt().solve(MatrixXd::Identity(rows, rows));
  linear.W = scale.asDiagonal() * inverse * scale.asDiagonal();
  return linear;
}

struct Normal {
  MatrixXd H;
  VectorXd b;
};
Normal NormalOf(const Fusion& fusion) {
  Normal normal{MatrixXd::Zero(fusion.Size(), fusion.Size()), VectorXd::Zero(fusion.Size())};
  const auto add = [&](const Linear& linear) {
    const MatrixXd half = linear.J.transpose() * linear.W;
    normal.H.noalias() += half * linear.J;
    normal.b.noalias() += half * linear.e;
  };
  for (const Factor& factor : fusion.factors) add(LinearizedOf(fusion, factor));
  for (const EdgeFactor& edge : fusion.edges) {
    Linear linear{VectorXd::Zero(6), MatrixXd::Zero(6, fusion.Size()), edge.Omega};
    AddRelative(fusion, edge.a, edge.b, edge.T_a_b, 0, linear.e, linear.J);
    add(linear);
  }
  return normal;
}

// H^-1, scaled; nothing where something is left open.
std::optional<MatrixXd> InverseOf(const MatrixXd& H) {
  if (!(H.diagonal().minCoeff() > 0)) return std::nullopt;
  const VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<MatrixXd> llt(scale.asDiagonal() * H * scale.asDiagonal());
  if (llt.info() != Eigen::Success || llt.matrixLLT().diagonal().minCoeff() < 1e-7) return std::nullopt;
  const MatrixXd inverse = llt.solve(MatrixXd::Identity(H.rows(), H.cols()));
  return MatrixXd(scale.asDiagonal() * inverse * scale.asDiagonal());
}

// To the optimum; its H^-1.
std::optional<MatrixXd> Settle(Fusion& fusion) {
  for (int iteration = 0; iteration < kIterationsMax; ++iteration) {
    const Normal normal = NormalOf(fusion);
    const auto inverse = InverseOf(normal.H);
    if (!inverse) return std::nullopt;
    const VectorXd step = -*inverse * normal.b;
    for (std::size_t v = 0; v < fusion.T_ref.size(); ++v)
      fusion.T_ref[v] = (fusion.T_ref[v] * Se3::Exp(step.segment<6>(6 * static_cast<Eigen::Index>(v)))).Normalized();
    if (-normal.b.dot(step) < kSettled) return inverse;
  }
  return std::nullopt;
}

std::vector<VisitVariance> ScatterOf(const Fusion& fusion) {
  std::vector<std::vector<VisitResidual>> visits(fusion.sensors.size());
  for (const Factor& factor : fusion.factors) {
    const Linear linear = LinearizedOf(fusion, factor);
    for (std::size_t i = 0; i < factor.variable.size(); ++i) {
      const auto row = 6 * static_cast<Eigen::Index>(i);
      if (factor.variable[i] != kFixed)
        visits[static_cast<std::size_t>(factor.variable[i])].push_back(
            {linear.e.segment<6>(row), factor.C.block<6, 6>(row, row)});
    }
  }
  std::vector<VisitVariance> scatter;
  for (const auto& of_sensor : visits) scatter.push_back(BetweenVisits(of_sensor));
  return scatter;
}

bool Same(const std::vector<VisitVariance>& x, const std::vector<VisitVariance>& y) {
  const auto close = [](double a, double b) { return std::abs(a - b) <= kScatterSettled * std::max(a, b); };
  return std::equal(x.begin(), x.end(), y.begin(), [&](const VisitVariance& a, const VisitVariance& b) {
    return close(a.translation_m2, b.translation_m2) && close(a.rotation_rad2, b.rotation_rad2);
  });
}

// Weights and scatter in turn: how visits are weighed depends on how they scatter.
std::optional<MatrixXd> SettleWithScatter(Fusion& fusion) {
  auto inverse = Settle(fusion);
  for (int round = 0; inverse && round < kScatterRoundsMax; ++round) {
    const std::vector<VisitVariance> scatter = ScatterOf(fusion);
    if (Same(scatter, fusion.scatter)) break;
    fusion.scatter = scatter;
    inverse = Settle(fusion);
  }
  return inverse;
}

// Symmetric root of a covariance of mixed units: with alike sources and alike geometry it is alike on every visit.
MatrixXd RootOf(const MatrixXd& C) {
  const VectorXd scale = C.diagonal().unaryExpr([](double c) { return c > 0 ? std::sqrt(c) : 1.0; });
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(scale.cwiseInverse().asDiagonal() * C *
                                                     scale.cwiseInverse().asDiagonal());
  return scale.asDiagonal() * axes.eigenvectors() * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         axes.eigenvectors().transpose();
}

struct Told {
  MatrixXd covariance;      // of a visit's poses, rows of the sensors
  std::vector<double> dof;  // per sensor
};

// What a session's own errors move the sensors by: covariance of that alone.
MatrixXd MovedBy(const MatrixXd& inverse, const Linear& linear) { return inverse * linear.J.transpose() * linear.W; }

MatrixXd CommonPart(const Fusion& fusion, const MatrixXd& inverse) {
  const Eigen::Index size = fusion.Size();
  MatrixXd moved = MatrixXd::Zero(size, size + 6);  // by what is common, a source per row of a sensor; the last: the reference
  MatrixXd counted = MatrixXd::Zero(size, size);    // of it in `inverse` already, as if visits erred apart
  for (const Factor& factor : fusion.factors) {
    if (factor.common.rows() == 0) continue;
    const MatrixXd G = MovedBy(inverse, LinearizedOf(fusion, factor)), by = G * RootOf(factor.common);
    counted += G * factor.common * G.transpose();
    for (std::size_t i = 0; i < factor.variable.size(); ++i)
      moved.middleCols<6>(factor.variable[i] == kFixed ? size : 6 * factor.variable[i]) +=
          by.middleCols<6>(6 * static_cast<Eigen::Index>(i));
  }
  return moved * moved.transpose() - counted;
}

double DofOf(const Fusion& fusion, const MatrixXd& inverse, const std::vector<Linear>& linear, const Matrix6d& all,
             std::size_t sensor) {
  const auto row = 6 * static_cast<Eigen::Index>(sensor);
  PooledDof pooled(all);
  int visits = 0;
  for (std::size_t k = 0; k < fusion.factors.size(); ++k) {
    const Factor& factor = fusion.factors[k];
    const MatrixXd G = MovedBy(inverse, linear[k]).middleRows<6>(row);
    double dof = *std::min_element(factor.dof.begin(), factor.dof.end());
    for (std::size_t i = 0; i < factor.variable.size(); ++i)
      if (factor.variable[i] == static_cast<int>(sensor)) dof = factor.dof[i], ++visits;
    pooled.Add(G * factor.C * G.transpose(), static_cast<int>(std::lround(dof)));
  }
  if (visits > 1) pooled.Add(fusion.scatter[sensor].Matrix(), static_cast<int>(kScatterDofPerVisit * (visits - 1)));
  return pooled.Of(all);
}

Told ToldOf(const Fusion& fusion, const MatrixXd& inverse) {
  const auto rows = 6 * static_cast<Eigen::Index>(fusion.sensors.size());
  Told told{(inverse + CommonPart(fusion, inverse)).topLeftCorner(rows, rows), {}};
  std::vector<Linear> linear;
  for (const Factor& factor : fusion.factors) linear.push_back(LinearizedOf(fusion, factor));
  for (std::size_t s = 0; s < fusion.sensors.size(); ++s) {
    const auto row = 6 * static_cast<Eigen::Index>(s);
    told.covariance.block<6, 6>(row, row) += fusion.scatter[s].Matrix();
    told.dof.push_back(DofOf(fusion, inverse, linear, told.covariance.block<6, 6>(row, row), s));
  }
  return told;
}

int SessionsOf(const Fusion& fusion, const SensorId& sensor) {
  return static_cast<int>(std::count_if(fusion.factors.begin(), fusion.factors.end(), [&](const Factor& factor) {
    return std::find(factor.sensor.begin(), factor.sensor.end(), sensor) != factor.sensor.end();
  }));
}

void TakePoses(const Fusion& fusion, const Told& told, GraphSolution& solution) {
  for (SensorPose& pose : solution.poses) {
    const auto found = std::find(fusion.sensors.begin(), fusion.sensors.end(), pose.sensor);
    if (found == fusion.sensors.end()) continue;
    const auto s = static_cast<std::size_t>(found - fusion.sensors.begin());
    const VisitVariance& scatter = fusion.scatter[s];
    pose.fused = FusedPose{pose.T_ref_sensor, pose.covariance, SessionsOf(fusion, pose.sensor),
                           std::sqrt(scatter.translation_m2), std::sqrt(scatter.rotation_rad2)};
    const auto row = 6 * static_cast<Eigen::Index>(s);
    pose.T_ref_sensor = fusion.T_ref[s];
    pose.covariance = Symmetrized(told.covariance.block<6, 6>(row, row));
    pose.dof = told.dof[s];
  }
}

}  // namespace

void FuseSessions(const std::vector<Edge>& edges, const SensorId& reference,
                  const std::vector<SessionEstimate>& estimates, GraphSolution& solution) {
  Builder builder(edges, reference, solution);
  for (const SessionEstimate& estimate : estimates)
    if (IsFused(estimate, edges)) builder.AddSession(estimate);
  Fusion& fusion = builder.fusion();
  if (fusion.factors.empty() || fusion.sensors.size() > kFusedSensorsMax) return;
  builder.AddEdges();
  const auto inverse = SettleWithScatter(fusion);
  if (!inverse) return;
  const Told told = ToldOf(fusion, *inverse);
  TakePoses(fusion, told, solution);
  solution.fused = {builder.sessions, fusion.sensors, told.covariance};
}

}  // namespace rigcal::graph
