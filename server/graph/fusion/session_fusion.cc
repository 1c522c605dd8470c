#include "server/graph/fusion/session_fusion.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "server/math/covariance.h"
#include "server/model/edges/merged_edge.h"
#include "server/model/edges/past.h"
#include "server/model/graph/connected.h"

namespace rigcal::graph {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kIterationsMax = 30;
constexpr double kSettled = 1e-12;  // squared step in sigmas

std::set<SensorId> SensorsThatCount(const SessionId& session, const FusionInput& input) {
  std::set<SensorId> counting;
  for (const std::vector<Edge>* edges : {&input.edges, &input.within})
    for (const Edge& edge : *edges)
      if (edge.session == session && edge.state == EdgeState::kGood) counting.insert({edge.frame_a, edge.frame_b});
  return counting;
}

bool IsOfSession(const Edge& edge) { return !edge.session.empty() || IsMergedOfSessions(edge); }

bool HasRetired(const SessionId& session, const std::vector<Edge>& edges) {
  return std::any_of(edges.begin(), edges.end(), [&](const Edge& edge) {
    return edge.session == session && IsPast(edge) && edge.diagnoses.front().code == kRetiredCode;
  });
}

MatrixXd Selected(const MatrixXd& C, const std::vector<int>& first_rows) {
  std::vector<int> rows;
  for (const int first : first_rows)
    for (int i = 0; i < 6; ++i) rows.push_back(first + i);
  return C(rows, rows);
}

class Builder {
 public:
  Builder(const FusionInput& input, const SensorsOfSessions& left_out) : input_(input), left_out_(left_out) {
    for (const SensorPose& pose : input.start.poses)
      if (pose.known) start_.emplace(pose.sensor, pose.T_ref_sensor);
  }

  SessionFusion Build(const std::vector<SessionEstimate>& estimates, bool with_edges) {
    std::vector<std::pair<const SessionEstimate*, std::set<SensorId>>> taken;
    for (const SessionEstimate& estimate : estimates) {
      if (!IsFused(estimate, input_)) continue;
      const std::set<SensorId> counting = CountingIn(estimate);
      if (counting.size() < 2) continue;  // tells no pose against another
      refined_.insert(counting.begin(), counting.end());
      together_.push_back(counting);
      taken.emplace_back(&estimate, counting);
    }
    together_ = Connected(together_);
    const std::vector<const Edge*> edges = with_edges ? EdgesBeside() : std::vector<const Edge*>{};
    for (const Edge* edge : edges) refined_.insert({edge->frame_a, edge->frame_b});
    AddVariables();
    for (const auto& [estimate, counting] : taken) AddFactor(*estimate, counting);
    for (const Edge* edge : edges)
      fusion_.edges.push_back(
          {VariableOf(edge->frame_a), VariableOf(edge->frame_b), edge->T_a_b, edge->uncertainty.Omega, edge->id});
    return std::move(fusion_);
  }

 private:
  [[nodiscard]] std::set<SensorId> CountingIn(const SessionEstimate& estimate) const {
    std::set<SensorId> counting = SensorsThatCount(estimate.session, input_), refined;
    for (const RefinedPose& pose : estimate.poses)
      if (counting.contains(pose.sensor) && start_.contains(pose.sensor) &&
          !left_out_.contains({estimate.session, pose.sensor}))
        refined.insert(pose.sensor);
    return refined;
  }

  [[nodiscard]] std::vector<const Edge*> EdgesBeside() const {
    std::vector<const Edge*> beside;
    for (const Edge& edge : input_.edges) {
      if (edge.state != EdgeState::kGood || !start_.contains(edge.frame_a) || !start_.contains(edge.frame_b)) continue;
      if (!IsOfSession(edge) || !AreTiedByEstimates(edge)) beside.push_back(&edge);
    }
    return beside;
  }
  [[nodiscard]] bool AreTiedByEstimates(const Edge& edge) const {
    return std::any_of(together_.begin(), together_.end(), [&](const std::set<SensorId>& sensors) {
      return sensors.contains(edge.frame_a) && sensors.contains(edge.frame_b);
    });
  }

  void AddVariables() {
    for (const SensorPose& pose : input_.start.poses) {
      if (pose.sensor == input_.reference || !refined_.contains(pose.sensor)) continue;
      fusion_.sensors.push_back(pose.sensor);
      fusion_.T_ref.push_back(pose.T_ref_sensor);
    }
    fusion_.scatter.resize(fusion_.sensors.size());
    fusion_.walk.resize(fusion_.sensors.size());
  }

  void AddFactor(const SessionEstimate& estimate, const std::set<SensorId>& counting) {
    SessionFactor factor;
    factor.session = estimate.session;
    std::vector<int> rows;
    for (std::size_t i = 0; i < estimate.poses.size(); ++i) {
      const RefinedPose& pose = estimate.poses[i];
      const int row = RowOf(estimate, i);
      if (row < 0 || !counting.contains(pose.sensor)) continue;
      rows.push_back(row);
      factor.variable.push_back(VariableOf(pose.sensor));
      factor.T_frame_sensor.push_back(pose.T_ref_sensor);
      factor.dof.push_back(pose.dof);
    }
    factor.frame = counting.contains(estimate.reference) ? VariableOf(estimate.reference) : FreeFrame(factor);
    factor.C = Selected(estimate.covariance, rows);
    if (estimate.common.rows() > 0) factor.common = Selected(estimate.common, rows);
    if (fusion_.sessions.empty() || fusion_.sessions.back() != estimate.session)
      fusion_.sessions.push_back(estimate.session);
    fusion_.factors.push_back(std::move(factor));
  }

  [[nodiscard]] int VariableOf(const SensorId& sensor) const {
    if (sensor == input_.reference) return kFixed;
    return static_cast<int>(std::find(fusion_.sensors.begin(), fusion_.sensors.end(), sensor) -
                            fusion_.sensors.begin());
  }
  int FreeFrame(const SessionFactor& factor) {
    fusion_.T_ref.push_back(fusion_.Pose(factor.variable.front()) * factor.T_frame_sensor.front().Inverse());
    return static_cast<int>(fusion_.T_ref.size()) - 1;
  }

  const FusionInput& input_;
  const SensorsOfSessions& left_out_;
  std::map<SensorId, Se3> start_;
  std::set<SensorId> refined_;
  std::vector<std::set<SensorId>> together_;  // of them, those that estimates tie
  SessionFusion fusion_;
};

// Residual and Jacobian of T_a_b = T_a^-1 T_b with right tangents at both.
void AddRelative(const SessionFusion& fusion, int a, int b, const Se3& T_a_b, Eigen::Index row, LinearFactor& linear) {
  const Se3 predicted = fusion.Pose(a).Inverse() * fusion.Pose(b);
  const Vector6d e = (T_a_b.Inverse() * predicted).Log();
  const Matrix6d by_b = RightJacobianInverse(e);
  linear.e.segment<6>(row) = e;
  if (b != kFixed) linear.J.block<6, 6>(row, 6 * b) += by_b;
  if (a != kFixed) linear.J.block<6, 6>(row, 6 * a) -= by_b * Adjoint(predicted.Inverse());
}

// What the sensors' places change by over so many days: variances of variables.
VectorXd WalkOver(double days, const SessionFusion& fusion) {
  VectorXd Q = VectorXd::Zero(fusion.Size());
  for (std::size_t s = 0; s < fusion.walk.size() && days > 0; ++s)
    Q.segment<6>(6 * static_cast<Eigen::Index>(s)) = days * fusion.walk[s].Matrix().diagonal();
  return Q;
}

struct Normal {
  MatrixXd H;
  VectorXd b;

  void Add(const LinearFactor& linear) {
    const MatrixXd half = linear.J.transpose() * linear.W;
    H.noalias() += half * linear.J;
    b.noalias() += half * linear.e;
  }
  // (H^-1 + Q)^-1 = H - H L (1 + L^T H L)^-1 L^T H of Q = L L^T, which holds where H is singular, too. Comes back: what
  // an information vector of before is multiplied by.
  MatrixXd Walk(const VectorXd& Q) {
    std::vector<Eigen::Index> axes;
    for (Eigen::Index i = 0; i < Q.size(); ++i)
      if (Q(i) > 0) axes.push_back(i);
    const VectorXd root = Q(axes).cwiseSqrt();
    const MatrixXd HL = H(Eigen::all, axes) * root.asDiagonal();
    MatrixXd inner = root.asDiagonal() * HL(axes, Eigen::all);
    inner.diagonal().array() += 1.0;
    const Eigen::LLT<MatrixXd> llt(inner);
    MatrixXd after = MatrixXd::Identity(H.rows(), H.cols());
    after(Eigen::all, axes) -= llt.solve(HL.transpose()).transpose() * root.asDiagonal();
    const MatrixXd half = llt.matrixL().solve(HL.transpose());
    H.noalias() -= half.transpose() * half;
    b = after * b;
    return after;
  }
};

// A session or an edge.
struct Step {
  double age_days = 0.0;
  const SessionFactor* session = nullptr;
  const EdgeFactor* edge = nullptr;
};
std::vector<Step> OldestFirst(const SessionFusion& fusion) {
  std::vector<Step> steps;
  for (auto factor = fusion.factors.rbegin(); factor != fusion.factors.rend(); ++factor)
    steps.push_back({factor->age_days, &*factor, nullptr});
  for (const EdgeFactor& edge : fusion.edges) steps.push_back({edge.age_days, nullptr, &edge});
  std::stable_sort(steps.begin(), steps.end(), [](const Step& x, const Step& y) { return x.age_days > y.age_days; });
  return steps;
}

LinearFactor Linearized(const SessionFusion& fusion, const Step& step) {
  if (step.session) return graph::Linearized(fusion, *step.session);
  LinearFactor linear{VectorXd::Zero(6), MatrixXd::Zero(6, fusion.Size()), step.edge->Omega};
  AddRelative(fusion, step.edge->a, step.edge->b, step.edge->T_a_b, 0, linear);
  return linear;
}

// Before a step, if anything walked since the one before it.
struct Walked {
  VectorXd Q;
  MatrixXd after, H;  // of Normal::Walk, and behind it
};

Normal NormalOf(const SessionFusion& fusion, const std::vector<Step>& steps, std::vector<Walked>* walked = nullptr) {
  Normal normal{MatrixXd::Zero(fusion.Size(), fusion.Size()), VectorXd::Zero(fusion.Size())};
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const VectorXd Q = WalkOver(k > 0 ? steps[k - 1].age_days - steps[k].age_days : 0.0, fusion);
    if (Q.size() > 0 && Q.maxCoeff() > 0) {
      MatrixXd after = normal.Walk(Q);
      if (walked) walked->at(k) = {Q, std::move(after), normal.H};
    }
    normal.Add(Linearized(fusion, steps[k]));
  }
  return normal;
}

}  // namespace

bool IsFused(const SessionEstimate& estimate, const FusionInput& input) {
  return estimate.why_not.empty() && !HasRetired(estimate.session, input.edges) &&
         !HasRetired(estimate.session, input.within);
}

SessionFusion FusionOf(const FusionInput& input, const std::vector<SessionEstimate>& estimates, bool with_edges,
                       const SensorsOfSessions& left_out) {
  return Builder(input, left_out).Build(estimates, with_edges);
}

MatrixXd WithScatter(const SessionFusion& fusion, const SessionFactor& factor) {
  MatrixXd C = factor.C;
  for (std::size_t i = 0; i < factor.variable.size(); ++i)
    if (factor.variable[i] != kFixed)
      C.block<6, 6>(6 * static_cast<Eigen::Index>(i), 6 * static_cast<Eigen::Index>(i)) +=
          fusion.scatter[static_cast<std::size_t>(factor.variable[i])].Matrix();
  return C;
}

LinearFactor Linearized(const SessionFusion& fusion, const SessionFactor& factor) {
  const auto rows = 6 * static_cast<Eigen::Index>(factor.variable.size());
  LinearFactor linear{VectorXd::Zero(rows), MatrixXd::Zero(rows, fusion.Size()), {}};
  for (std::size_t i = 0; i < factor.variable.size(); ++i)
    AddRelative(fusion, factor.frame, factor.variable[i], factor.T_frame_sensor[i], 6 * static_cast<Eigen::Index>(i),
                linear);
  linear.W = InverseOfDefinite(WithScatter(fusion, factor))
                 .value_or(MatrixXd::Zero(rows, rows));  // no covariance: says nothing
  return linear;
}

std::optional<MatrixXd> Settle(SessionFusion& fusion) {
  const std::vector<Step> steps = OldestFirst(fusion);
  for (int iteration = 0; iteration < kIterationsMax; ++iteration) {
    const Normal normal = NormalOf(fusion, steps);
    auto inverse = InverseOfDefinite(normal.H);
    if (!inverse) return std::nullopt;
    const VectorXd step = -*inverse * normal.b;
    for (std::size_t v = 0; v < fusion.T_ref.size(); ++v)
      fusion.T_ref[v] = (fusion.T_ref[v] * Se3::Exp(step.segment<6>(6 * static_cast<Eigen::Index>(v)))).Normalized();
    if (-normal.b.dot(step) < kSettled) return inverse;
  }
  return std::nullopt;
}

Gains GainsOf(const SessionFusion& fusion, const MatrixXd& inverse) {
  const std::vector<Step> steps = OldestFirst(fusion);
  std::vector<Walked> walked(steps.size());
  NormalOf(fusion, steps, &walked);
  Gains gains{std::vector<MatrixXd>(fusion.factors.size()), MatrixXd::Zero(fusion.Size(), fusion.Size())};
  MatrixXd left = inverse;  // of an information vector at this step, what it moves the poses by
  for (std::size_t k = steps.size(); k-- > 0;) {
    if (const SessionFactor* session = steps[k].session) {
      const LinearFactor linear = graph::Linearized(fusion, *session);
      gains.of_sessions[static_cast<std::size_t>(session - fusion.factors.data())] =
          left * linear.J.transpose() * linear.W;
    }
    if (walked[k].Q.size() == 0) continue;
    const MatrixXd moved = left * walked[k].H;
    gains.by_walk += moved * walked[k].Q.asDiagonal() * moved.transpose();
    left = left * walked[k].after;
  }
  return gains;
}

std::vector<std::vector<VisitResidual>> ResidualsOfVisits(const SessionFusion& fusion) {
  std::vector<std::vector<VisitResidual>> visits(fusion.sensors.size());
  for (const SessionFactor& factor : fusion.factors) {
    const LinearFactor linear = Linearized(fusion, factor);
    const MatrixXd apart = factor.common.rows() > 0 ? MatrixXd(factor.C - factor.common) : factor.C;
    for (std::size_t i = 0; i < factor.variable.size(); ++i) {
      const auto row = 6 * static_cast<Eigen::Index>(i);
      if (factor.variable[i] != kFixed)
        visits[static_cast<std::size_t>(factor.variable[i])].push_back(
            {linear.e.segment<6>(row), apart.block<6, 6>(row, row), factor.age_days});
    }
  }
  return visits;
}

}  // namespace rigcal::graph
