#include <cmath>

#include "storage/database/query.h"
#include "storage/edges/edge_row.h"
#include "storage/edges/edges.h"
#include "storage/sessions/sessions.h"

namespace rigcal::storage {
namespace {

std::string Subject(const Edge& edge) { return "edge " + edge.id.str() + " of robot " + edge.robot.str(); }

Status Refuse(const Edge& edge, const std::string& what) {
  return Fail(ErrorCode::kInvalidInput, Subject(edge) + ": " + what, "Validate edges before they are stored.");
}

Status CheckUncertainty(const Edge& edge) {
  const Uncertainty& uncertainty = edge.uncertainty;
  if (!uncertainty.Omega.allFinite()) return Refuse(edge, "information is not finite");
  if (!uncertainty.covariance.allFinite()) return Refuse(edge, "covariance is not finite");
  if (uncertainty.rank < 0 || uncertainty.rank > 6) return Refuse(edge, "rank is not between 0 and 6");
  if (uncertainty.dof < 0) return Refuse(edge, "dof is negative");
  if (!(uncertainty.jackknife_ratio >= 0 && uncertainty.jackknife_ratio <= 1))
    return Refuse(edge, "jackknife_ratio is not between 0 and 1");
  if (uncertainty.unobservable_basis.cols() != 6 - uncertainty.rank)
    return Refuse(edge, "rank and the number of unobservable directions do not add up to 6");
  if (!uncertainty.unobservable_basis.allFinite()) return Refuse(edge, "an unobservable direction is not finite");
  for (const BlockVector& block : uncertainty.blocks) {
    if (!block.d.allFinite()) return Refuse(edge, "block vector " + block.block_id + " is not finite");
    if (block.block_id.find('\n') != std::string::npos) return Refuse(edge, "a block id has more than one line");
  }
  for (const Contribution& part : uncertainty.contributions)
    if (!part.covariance.allFinite()) return Refuse(edge, "contribution " + part.name + " is not finite");
  return {};
}

}  // namespace

Status CheckEdgeRow(const Edge& edge) {
  RIGCAL_TRY(CheckDigest(EdgeTag::kKind, edge.id.str()));
  RIGCAL_TRY(CheckName(RobotTag::kKind, edge.robot.str()));
  for (const auto& [name, value] : edge.figures)
    if (!std::isfinite(value)) return Refuse(edge, "figure " + name + " is not finite");
  for (const CaptureResidual& capture : edge.captures)
    if (!std::isfinite(capture.rms)) return Refuse(edge, "rms of capture " + capture.capture.str() + " is not finite");
  if (edge.state != EdgeState::kGood) return {};
  if (!edge.T_a_b.p_m.allFinite() || !edge.T_a_b.q.coeffs().allFinite()) return Refuse(edge, "T_a_b is not finite");
  return CheckUncertainty(edge);
}

namespace {

void BindPose(Query& insert, const Se3& T_a_b) {
  insert.Bind(T_a_b.p_m.x(), T_a_b.p_m.y(), T_a_b.p_m.z());
  insert.Bind(T_a_b.q.x(), T_a_b.q.y(), T_a_b.q.z(), T_a_b.q.w());
}

void BindUncertainty(Query& insert, const Uncertainty& uncertainty) {
  const auto& basis = uncertainty.unobservable_basis;  // column-major: one direction after the other
  insert.Bind(BlobOf(uncertainty.Omega), uncertainty.rank, uncertainty.dof, NameOf(uncertainty.source),
              BlobOf(uncertainty.covariance), BlobOf(basis.data(), static_cast<std::size_t>(basis.size())),
              uncertainty.jackknife_ratio);
}

// Its number; nothing if the edge is there already. What is not bound is NULL.
std::optional<std::int64_t> InsertEdge(Store& store, const Edge& edge, Stamp now) {
  Query insert(store,
               "INSERT INTO edge (edge_id, robot_id, session_id, epoch, frame_a, frame_b, method, state, appended_ns, "
               "measured_ns, "
               "T_a_b_x_m, T_a_b_y_m, T_a_b_z_m, T_a_b_qx, T_a_b_qy, T_a_b_qz, T_a_b_qw, "
               "information, rank, dof, source, covariance, unobservable_basis, jackknife_ratio) "
               "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING "
               "RETURNING number");
  const bool good = edge.state == EdgeState::kGood;
  insert.Bind(edge.id, edge.robot, NullIfEmpty(edge.session), edge.epoch, edge.frame_a, edge.frame_b, edge.method,
              std::string(good ? "good" : "failed"), now, edge.measured_at);
  if (good) BindPose(insert, edge.T_a_b);
  if (good) BindUncertainty(insert, edge.uncertainty);
  return insert.RunForKey();
}

std::int64_t NumberOf(Store& store, const EdgeId& id) {
  Query query(store, "SELECT number FROM edge WHERE edge_id = ?");
  return query.Bind(id).Step() ? query.Int(0) : 0;
}

Blob BlobOfShifts(const std::vector<Vector6d>& shifts) {
  std::vector<double> values;
  for (const Vector6d& shift : shifts) values.insert(values.end(), shift.data(), shift.data() + 6);
  return BlobOf(values.data(), values.size());
}

// Zero has no sign, as in columns of SQLite.
Blob BlobOfBlocks(const std::vector<BlockVector>& blocks) {
  std::vector<double> values;
  for (const BlockVector& block : blocks)
    for (const double value : block.d) values.push_back(value + 0.0);
  return BlobOf(values.data(), values.size());
}

std::string LinesOfIds(const std::vector<BlockVector>& blocks) {
  std::string lines;
  for (const BlockVector& block : blocks) lines += block.block_id + "\n";
  return lines;
}

void InsertBlocks(Store& store, std::int64_t edge_number, const std::vector<BlockVector>& blocks) {
  if (blocks.empty()) return;
  Query(store, "INSERT INTO edge_blocks VALUES (?, ?, ?)")
      .Bind(edge_number, LinesOfIds(blocks), BlobOfBlocks(blocks))
      .Run();
}

void InsertContributions(Store& store, std::int64_t edge_number, const std::vector<Contribution>& contributions) {
  for (std::size_t i = 0; i < contributions.size(); ++i) {
    const Contribution& part = contributions[i];
    Query(store, "INSERT INTO edge_contribution VALUES (?, ?, ?, ?, ?)")
        .Bind(edge_number, i, part.name, BlobOf(part.covariance), BlobOfShifts(part.shifts))
        .Run();
  }
}

void InsertWords(Store& store, std::int64_t edge_number, const Edge& edge) {
  for (std::size_t i = 0; i < edge.diagnoses.size(); ++i) {
    const Diagnosis& diagnosis = edge.diagnoses[i];
    Query(store, "INSERT INTO edge_diagnosis VALUES (?, ?, ?, ?, ?)")
        .Bind(edge_number, i, diagnosis.code, diagnosis.what, diagnosis.cure)
        .Run();
  }
  for (const auto& [name, value] : edge.figures)
    Query(store, "INSERT INTO edge_figure VALUES (?, ?, ?)").Bind(edge_number, name, value).Run();
}

void InsertCaptures(Store& store, std::int64_t edge_number, const Edge& edge) {
  for (std::size_t i = 0; i < edge.captures.size(); ++i) {
    const CaptureResidual& residual = edge.captures[i];
    Query(store, "INSERT INTO edge_capture VALUES (?, ?, ?, ?, ?, ?)")
        .Bind(edge_number, i, residual.capture, residual.rms, residual.used, residual.note)
        .Run();
  }
  for (std::size_t i = 0; i < edge.evidence.size(); ++i) {
    const Evidence& shown = edge.evidence[i];
    Query(store, "INSERT INTO edge_evidence VALUES (?, ?, ?, ?, ?, ?, ?)")
        .Bind(edge_number, i, shown.title, shown.sensor, shown.capture, shown.digest, shown.suffix)
        .Run();
  }
}

}  // namespace

std::int64_t InsertEdgeRow(Store& store, const Edge& edge, Stamp now) {
  const auto inserted = InsertEdge(store, edge, now);
  if (!inserted) return NumberOf(store, edge.id);
  const std::int64_t edge_number = *inserted;
  if (edge.state == EdgeState::kGood) {
    InsertBlocks(store, edge_number, edge.uncertainty.blocks);
    InsertContributions(store, edge_number, edge.uncertainty.contributions);
  }
  InsertWords(store, edge_number, edge);
  InsertCaptures(store, edge_number, edge);
  return edge_number;
}

Status AppendEdge(Store& store, const Edge& edge, Stamp now) {
  return store.connection().Append(Subject(edge), [&]() -> Status {
    RIGCAL_TRY(CheckEdgeRow(edge));
    RIGCAL_TRY(AppendRobot(store, edge.robot, now));
    Query(store, "INSERT INTO counted_edge (edge_number, robot_id) VALUES (?, ?) ON CONFLICT DO NOTHING")
        .Bind(InsertEdgeRow(store, edge, now), edge.robot)
        .Run();
    return {};
  });
}

}  // namespace rigcal::storage
