#include "server/graph/uncertainty/graph_jackknife.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "server/graph/solve/observability.h"
#include "server/graph/solve/start_poses.h"
#include "server/math/covariance.h"
#include "server/math/pooled_dof.h"

namespace rigcal::graph {
namespace {

using Eigen::MatrixXd;

// Adds up what the sources bring, a batch of columns at a time.
class Accumulator {
 public:
  Accumulator(const JackknifeWork& work, BlockCholesky<6>& cholesky, const std::vector<Matrix6d>& analytic)
      : work_(work),
        cholesky_(cholesky),
        C_e_(work.problem.constraints.size(), Matrix6d::Zero()),
        dof_sum_(C_e_.size(), 0.0),
        pose_dof_(analytic.begin(), analytic.end()) {
    joint_ = MatrixXd::Zero(6 * work.problem.free_count(), 6 * work.problem.free_count());
  }

  void Add(const std::vector<ErrorSource>& sources) {
    constexpr Eigen::Index kColumnsMin = 256;
    std::size_t first = 0;
    Eigen::Index columns = 0;
    for (std::size_t k = 0; k < sources.size(); ++k) {
      columns += sources[k].column_count;
      if (columns < kColumnsMin && k + 1 < sources.size()) continue;
      AddBatch(sources.data() + first, sources.data() + k + 1, columns);
      first = k + 1, columns = 0;
    }
  }

  [[nodiscard]] MatrixXd Joint() const { return joint_.selfadjointView<Eigen::Lower>(); }
  [[nodiscard]] const Matrix6d& C_e(std::size_t constraint) const { return C_e_[constraint]; }
  // Welch & Satterthwaite's, behind C_e; 0: nothing estimated.
  [[nodiscard]] double Dof(std::size_t constraint) const {
    const double trace = work_.problem.constraints[constraint].Omega.cwiseProduct(C_e_[constraint]).sum();
    const double dof_sum = dof_sum_[constraint];
    return dof_sum > 0.0 && trace > 0.0 ? trace * trace / dof_sum : 0.0;
  }
  [[nodiscard]] double PoseDof(int row) const {
    const Matrix6d lower = joint_.block<6, 6>(row, row);
    return pose_dof_[static_cast<std::size_t>(row / 6)].Of(lower.selfadjointView<Eigen::Lower>());
  }

 private:
  void AddBatch(const ErrorSource* begin, const ErrorSource* end, Eigen::Index column_count) {
    MatrixXd pull = MatrixXd::Zero(joint_.rows(), column_count);
    Eigen::Index at = 0;
    for (const ErrorSource* source = begin; source != end; at += source->column_count, ++source)
      for (const ErrorPart& part : source->parts)
        AddToGradient(work_.problem.constraints[part.constraint], work_.jacobians[part.constraint], part.de,
                      pull.middleCols(at, source->column_count));
    cholesky_.SolveInPlace(pull);
    const MatrixXd columns = -pull;  // where the optimum goes
    joint_.selfadjointView<Eigen::Lower>().rankUpdate(columns);
    AddResidualsOf(begin, end, columns);
    for (std::size_t v = 0; v < pose_dof_.size(); ++v) AddPoseDof(begin, end, columns, v);
  }

  void AddPoseDof(const ErrorSource* begin, const ErrorSource* end, const MatrixXd& columns, std::size_t free_vertex) {
    const auto rows = columns.middleRows<6>(6 * static_cast<Eigen::Index>(free_vertex));
    Eigen::Index at = 0;
    for (const ErrorSource* source = begin; source != end; at += source->column_count, ++source) {
      const auto own = rows.middleCols(at, source->column_count);
      if (source->of_blocks)
        pose_dof_[free_vertex].AddBlocks(own, source->dof);
      else
        pose_dof_[free_vertex].Add(own * own.transpose(), source->dof);
    }
  }

  // Squared share of every estimated source over its degrees of freedom (Welch & Satterthwaite).
  static double DofSum(const ErrorSource* begin, const ErrorSource* end, const Eigen::RowVectorXd& weights) {
    double sum = 0.0;
    Eigen::Index at = 0;
    for (const ErrorSource* source = begin; source != end; at += source->column_count, ++source)
      if (source->dof > 0) sum += std::pow(weights.segment(at, source->column_count).sum(), 2) / source->dof;
    return sum;
  }

  // What one edge alone errs by has six directions, however many blocks told it: with de^T = Q R, C = de de^T is R^T R,
  // and the poses follow de. So each of its columns need not meet each edge of the graph.
  void AddResidualsOf(const ErrorSource* begin, const ErrorSource* end, const MatrixXd& columns) {
    std::vector<ErrorSource> narrow(begin, end);
    MatrixXd narrow_columns(columns.rows(), columns.cols());
    Eigen::Index from = 0, to = 0;
    for (ErrorSource& source : narrow) {
      const auto wide = columns.middleCols(from, source.column_count);
      from += source.column_count;
      if (source.parts.size() == 1 && source.column_count > 6) {
        const Eigen::HouseholderQR<Eigen::Matrix<double, Eigen::Dynamic, 6>> qr(source.parts[0].de.transpose());
        const MatrixXd Q = qr.householderQ() * MatrixXd::Identity(source.column_count, 6);
        source.column_count = 6;
        source.parts[0].de = qr.matrixQR().topRows<6>().triangularView<Eigen::Upper>().transpose();
        narrow_columns.middleCols<6>(to) = wide * Q;
      } else {
        narrow_columns.middleCols(to, source.column_count) = wide;
      }
      to += source.column_count;
    }
    AddResiduals(narrow.data(), narrow.data() + narrow.size(), narrow_columns.leftCols(to));
  }

  void AddResiduals(const ErrorSource* begin, const ErrorSource* end, const MatrixXd& columns) {
    std::vector<MatrixXd> changes(C_e_.size());
    for (std::size_t k = 0; k < C_e_.size(); ++k)
      changes[k] = ResidualChange(work_.problem.constraints[k], work_.jacobians[k], columns);
    Eigen::Index at = 0;
    for (const ErrorSource* source = begin; source != end; at += source->column_count, ++source)
      for (const ErrorPart& part : source->parts)
        changes[part.constraint].middleCols(at, source->column_count) += part.de;
    for (std::size_t k = 0; k < C_e_.size(); ++k) {
      C_e_[k] += changes[k] * changes[k].transpose();
      const Eigen::RowVectorXd weights =
          changes[k].cwiseProduct(work_.problem.constraints[k].Omega * changes[k]).colwise().sum();
      dof_sum_[k] += DofSum(begin, end, weights);
    }
  }

  const JackknifeWork& work_;
  BlockCholesky<6>& cholesky_;
  MatrixXd joint_;
  std::vector<Matrix6d> C_e_;
  std::vector<double> dof_sum_;
  std::vector<PooledDof> pose_dof_;
};

void FillSensors(const JackknifeWork& work, const GraphSolution& solution, const Accumulator& accumulator,
                 GraphJackknife& jackknife) {
  const std::size_t count = work.graph.sensors.size();
  jackknife.sensors = work.graph.sensors;
  jackknife.row_of_sensor.assign(count, -1);
  jackknife.placed.assign(count, false);
  jackknife.dof.assign(count, 0.0);
  for (std::size_t s = 0; s < count; ++s) {
    const int vertex = work.problem.vertex_of_sensor[s];
    jackknife.placed[s] = vertex >= 0 && solution.poses[s].Placed() != nullptr;
    if (!jackknife.placed[s] || vertex == 0) continue;
    jackknife.row_of_sensor[s] = 6 * (vertex - 1);
    jackknife.dof[s] = accumulator.PoseDof(jackknife.row_of_sensor[s]);
  }
}

bool Usable(const Graph& graph, const Problem& problem, const GraphSolution& solution) {
  return solution.converged && problem.free_count() > 0 && problem.free_count() < kJackknifeSensorsMax &&
         solution.poses.size() == graph.sensors.size() && solution.residuals.size() == graph.edges.size();
}

Result<std::size_t> FindPlaced(const GraphJackknife& jackknife, const SensorId& sensor) {
  const auto found = std::find(jackknife.sensors.begin(), jackknife.sensors.end(), sensor);
  if (found == jackknife.sensors.end())
    return Fail(ErrorCode::kNotFound, "sensor " + sensor.str() + " has no jackknife covariance in this graph",
                "Check the name; sessions with block vectors are needed.");
  const auto index = static_cast<std::size_t>(found - jackknife.sensors.begin());
  if (!jackknife.placed[index])
    return Fail(ErrorCode::kInvalidInput, "the pose of sensor " + sensor.str() + " is not known in this solution",
                "Add an edge that connects it with the reference.");
  return index;
}

void JudgeResidual(const Matrix6d& Omega, const ResidualCovariance& covariance, EdgeResidual& residual) {
  const Matrix6d W = SquareRoot(Omega).transpose();  // W^T W = Omega: whitens by what the edge says of itself
  const CheckedDirections checked = CheckWhitened(W * covariance.C_e * W.transpose(), W * residual.e);
  residual.by_jackknife = true;
  residual.t_squared = checked.t_squared;
  residual.rank = checked.rank;
  residual.dof = covariance.dof;
}

Matrix6d Block(const GraphJackknife& jackknife, std::size_t a, std::size_t b) {
  const int row = jackknife.row_of_sensor[a], col = jackknife.row_of_sensor[b];
  if (row < 0 || col < 0) return Matrix6d::Zero();
  return jackknife.joint.block<6, 6>(row, col);
}

}  // namespace

GraphJackknife JackknifeGraph(const Graph& graph, const GraphSolution& solution, const BlocksByEdge& blocks) {
  GraphJackknife jackknife;
  if (blocks.empty()) return jackknife;
  const Problem problem = MakeProblem(graph);
  JackknifeWork work{graph, problem, blocks, {}};
  if (!Usable(graph, problem, solution) || !AnySession(work)) return jackknife;
  const Poses T_ref = SolvedPoses(graph, problem, solution);
  for (const Constraint& constraint : problem.constraints) work.jacobians.push_back(JacobianOf(constraint, T_ref));
  const auto cholesky = FactorAt(problem, T_ref);
  if (cholesky == nullptr) return jackknife;
  const std::vector<Matrix6d> analytic = cholesky->InverseDiagonal();
  Accumulator accumulator(work, *cholesky, analytic);
  accumulator.Add(SourcesOf(work));
  jackknife.joint = accumulator.Joint();
  if (!jackknife.joint.allFinite()) return jackknife;
  FillSensors(work, solution, accumulator, jackknife);
  jackknife.residuals.resize(solution.residuals.size());
  for (std::size_t k = 0; k < problem.constraints.size(); ++k)
    jackknife.residuals[problem.constraints[k].edge] = {true, accumulator.C_e(k), accumulator.Dof(k)};
  jackknife.available = true;
  return jackknife;
}

Result<Matrix6d> SensorCovariance(const GraphJackknife& jackknife, const SensorId& sensor) {
  RIGCAL_ASSIGN(const std::size_t index, FindPlaced(jackknife, sensor));
  return Symmetrized(Block(jackknife, index, index));
}

Result<RelativePose> RelativeByJackknife(const GraphJackknife& jackknife, const GraphSolution& solution,
                                         const SensorId& a, const SensorId& b, const std::vector<Vector6d>& open) {
  RIGCAL_ASSIGN(const std::size_t index_a, FindPlaced(jackknife, a));
  RIGCAL_ASSIGN(const std::size_t index_b, FindPlaced(jackknife, b));
  RelativePose relative;
  if (a == b) return relative;
  relative.T_A_B = (solution.poses[index_a].Placed()->Inverse() * *solution.poses[index_b].Placed()).Normalized();
  relative.covariance =
      CovarianceAcross(RelativeCovariance(relative.T_A_B, Block(jackknife, index_a, index_a),
                                          Block(jackknife, index_b, index_b), Block(jackknife, index_a, index_b)),
                       BasisOf(open));
  relative.unobservable_basis = open;
  return relative;
}

void ApplyJackknifeCovariance(const Graph& graph, const GraphJackknife& jackknife, GraphSolution& solution) {
  if (!jackknife.available) return;
  for (std::size_t s = 0; s < solution.poses.size(); ++s) {
    SensorPose& pose = solution.poses[s];
    const auto honest = SensorCovariance(jackknife, pose.sensor);
    if (!honest || pose.sensor == graph.reference) continue;
    if (pose.measured_part) {
      pose.measured_part->covariance = CovarianceAcross(*honest, BasisOf(pose.unobservable_basis));
      pose.measured_part->by_jackknife = true;
      continue;
    }
    pose.covariance_analytic = pose.covariance;
    pose.covariance = *honest;
    pose.by_jackknife = true;
    pose.dof = jackknife.dof[s];
  }
  std::map<EdgeId, const GraphEdge*> by_id;
  for (const GraphEdge& edge : graph.edges) by_id.emplace(edge.id, &edge);
  for (std::size_t k = 0; k < solution.residuals.size(); ++k)
    if (jackknife.residuals[k].in_solution)
      JudgeResidual(by_id.at(solution.residuals[k].edge)->Omega, jackknife.residuals[k], solution.residuals[k]);
}

}  // namespace rigcal::graph
