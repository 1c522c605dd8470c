#include "server/model/edges/edge.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "server/model/edges/method.h"
#include "server/model/field_hash.h"
#include "server/model/plausible.h"

namespace rigcal {
namespace {

std::string Title(const Edge& edge) { return "edge " + edge.frame_a.str() + " - " + edge.frame_b.str(); }

Status Refuse(const Edge& edge, const std::string& what, const std::string& cure) {
  return Fail(ErrorCode::kInvalidInput, Title(edge) + ": " + what, cure);
}

Status CheckNames(const Edge& edge) {
  RIGCAL_TRY(CheckName(SensorTag::kKind, edge.frame_a.str()));
  RIGCAL_TRY(CheckName(SensorTag::kKind, edge.frame_b.str()));
  RIGCAL_TRY(CheckName(RobotTag::kKind, edge.robot.str()));
  RIGCAL_TRY(CheckName("method", edge.method));
  if (!edge.session.empty()) RIGCAL_TRY(CheckDigest(SessionTag::kKind, edge.session.str()));
  if (!edge.id.empty()) RIGCAL_TRY(CheckDigest(EdgeTag::kKind, edge.id.str()));
  if (edge.frame_a == edge.frame_b)
    return Refuse(edge, "frame_a and frame_b are the same", "An edge joins two different sensors.");
  if (edge.epoch < 1) return Refuse(edge, "epoch is less than 1", "Epochs count from 1.");
  return {};
}

Status CheckPose(const Edge& edge) {
  constexpr double kUnitTolerance = 1e-6;
  if (!edge.T_a_b.p_m.allFinite()) return Refuse(edge, "p_m is not finite", "Give 3 finite numbers in metres.");
  if (!edge.T_a_b.q.coeffs().allFinite()) return Refuse(edge, "q_xyzw is not finite", "Give 4 finite numbers.");
  if (std::abs(edge.T_a_b.q.norm() - 1.0) > kUnitTolerance)
    return Refuse(edge, "q_xyzw is not a unit quaternion", "Normalise it; the order is x y z w.");
  return {};
}

// Of edges that were pushed as finished. What we estimate ourselves is judged by its residuals instead.
Status CheckBelievable(const Edge& edge) {
  if (!edge.session.empty()) return {};
  if (edge.measured_at && edge.measured_at->ns <= 0)
    return Refuse(edge, "measured_at is not after 1970", "Give the day on which it was measured, or leave it out.");
  if (Status near = CheckPlausible(edge.T_a_b.p_m); !near) return Refuse(edge, near.error().what, near.error().cure);
  if (Status sane = CheckPlausible(edge.uncertainty.Omega); !sane)
    return Refuse(edge, sane.error().what, sane.error().cure);
  return {};
}

Status CheckUncertainty(const Edge& edge) {
  if (Status valid = Validate(edge.uncertainty); !valid) return Refuse(edge, valid.error().what, valid.error().cure);
  if (edge.uncertainty.rank < 1) return Refuse(edge, "information is zero", "Leave an edge away that says nothing.");
  return {};
}

Status CheckFigures(const Edge& edge) {
  for (const auto& [name, value] : edge.figures)
    if (!std::isfinite(value)) return Refuse(edge, "figure " + name + " is not finite", "Leave unknown figures away.");
  for (const CaptureResidual& capture : edge.captures)
    if (!std::isfinite(capture.rms))
      return Refuse(edge, "rms of capture " + capture.capture.str() + " is not finite", "Leave the capture away.");
  return {};
}

}  // namespace

std::string ResidualUnitOf(const std::string& method) {
  const std::optional<Method> ours = MethodNamed(method);
  return std::string(ours ? RowOf(*ours).residual_unit : "px");
}

// Fields: robot, session, method, frame_a, frame_b.
EdgeId EstimatedEdgeId(const RobotId& robot, const SessionId& session, const std::string& method,
                       const SensorId& frame_a, const SensorId& frame_b) {
  FieldHash hash("rigcal estimated edge 1");
  hash.Text(robot.str()).Text(session.str()).Text(method).Text(frame_a.str()).Text(frame_b.str());
  return EdgeId(hash.Finish().str());
}

// Fields: the earlier edge's id.
EdgeId RepeatedEdgeId(const EdgeId& earlier) {
  FieldHash hash("rigcal repeated edge 1");
  hash.Text(earlier.str());
  return EdgeId(hash.Finish().str());
}

// Fields: robot, content digest (64 hexadecimal digits), occurrence index.
EdgeId PushedEdgeId(const RobotId& robot, const Digest& content, std::uint64_t occurrence_idx) {
  FieldHash hash("rigcal pushed edge 1");
  hash.Text(robot.str()).Text(content.str()).Number(occurrence_idx);
  return EdgeId(hash.Finish().str());
}

// Fields: frame_a, frame_b, method, pose, Omega, source, dof; then the number of blocks and each one's id and vector;
// then the number of contributions and each one's name, covariance and shifts; the jackknife's ratio if told;
// "measured" and when it was, if told. Edges that agree in all this are the same measurement given twice: then only
// their count matters, not which is which.
Digest ContentDigest(const Edge& edge) {
  const Uncertainty& uncertainty = edge.uncertainty;
  FieldHash hash("rigcal edge content 1");
  hash.Text(edge.frame_a.str()).Text(edge.frame_b.str()).Text(edge.method).Pose(edge.T_a_b).Matrix(uncertainty.Omega);
  hash.Text(NameOf(uncertainty.source)).Number(static_cast<std::uint64_t>(uncertainty.dof));
  hash.Number(uncertainty.blocks.size());
  for (const BlockVector& block : uncertainty.blocks) hash.Text(block.block_id).Vector(block.d);
  hash.Number(uncertainty.contributions.size());
  for (const Contribution& part : uncertainty.contributions) {
    hash.Text(part.name).Matrix(part.covariance);
    for (const Vector6d& shift : part.shifts) hash.Vector(shift);
  }
  if (uncertainty.jackknife_ratio > 0.0) hash.Real(uncertainty.jackknife_ratio);
  if (edge.measured_at) hash.Text("measured").Number(static_cast<std::uint64_t>(edge.measured_at->ns));
  return hash.Finish();
}

void AssignPushedIds(std::vector<Edge>& edges) {
  std::unordered_map<std::string, std::uint64_t> seen;
  for (Edge& edge : edges) {
    const Digest content = ContentDigest(edge);
    edge.id = PushedEdgeId(edge.robot, content, seen[edge.robot.str() + "/" + content.str()]++);
  }
}

// Fields: robot, number of edges, their ids in ascending order.
BatchId BatchIdOf(const RobotId& robot, const std::vector<Edge>& edges) {
  std::vector<std::string_view> ids;
  ids.reserve(edges.size());
  for (const Edge& edge : edges) ids.emplace_back(edge.id.str());
  std::sort(ids.begin(), ids.end());
  FieldHash hash("rigcal batch 1");
  hash.Text(robot.str()).Number(ids.size());
  for (std::string_view id : ids) hash.Text(id);
  return BatchId(hash.Finish().str());
}

Status Validate(const Edge& edge) {
  RIGCAL_TRY(CheckNames(edge));
  RIGCAL_TRY(CheckFigures(edge));
  if (edge.state == EdgeState::kFailed) {
    if (edge.diagnoses.empty())
      return Refuse(edge, "it failed without a diagnosis", "Say what went wrong and what to do.");
    return {};
  }
  RIGCAL_TRY(CheckPose(edge));
  RIGCAL_TRY(CheckUncertainty(edge));
  return CheckBelievable(edge);
}

}  // namespace rigcal
