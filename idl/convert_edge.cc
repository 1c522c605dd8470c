#include <algorithm>
#include <cmath>
#include <cstring>

#include "idl/convert.h"
#include "server/base/limits.h"

namespace rigcal::wire {
namespace {

constexpr std::uint32_t kContributionsMax = 64;
constexpr double kUnitTolerance = 1e-6;

struct EdgeMemory {
  std::vector<rigcal_wire_BlockVector> blocks;
  std::vector<rigcal_wire_Contribution> contributions;
};

template <std::size_t N>
Status Put(const std::string& text, char (&to)[N], const char* field) {
  return CopyText(text, to, N, field);
}

void PutMatrix(const Matrix6d& matrix, double* to) {
  for (int row = 0; row < 6; ++row)
    for (int col = 0; col < 6; ++col) to[6 * row + col] = matrix(row, col);
}

Matrix6d MatrixOf(const double* from) {
  Matrix6d matrix;
  for (int row = 0; row < 6; ++row)
    for (int col = 0; col < 6; ++col) matrix(row, col) = from[6 * row + col];
  return matrix;
}

tl::unexpected<Error> Refused(const rigcal_wire_PairwiseResult& sample, const std::string& why,
                              const std::string& cure) {
  const std::string name =
      "edge " + std::to_string(sample.batch_idx) + " (" + sample.frame_a + " - " + sample.frame_b + ")";
  return Fail(ErrorCode::kInvalidInput, name + ": " + why, cure);
}

Status AllFinite(const rigcal_wire_PairwiseResult& sample, const double* values, std::size_t count, const char* field) {
  if (std::all_of(values, values + count, [](double value) { return std::isfinite(value); })) return {};
  return Refused(sample, std::string(field) + " holds a value that is not a number", "Send finite numbers only");
}

// Content counts equal edges of a batch, so that a file's order doesn't matter; the count is searched where it is made.
Result<std::uint32_t> OccurrenceOf(const BatchItem& item) {
  const Digest content = ContentDigest(item.edge);
  for (std::uint32_t i = 0; i < item.count; ++i)
    if (PushedEdgeId(item.edge.robot, content, i) == item.edge.id) return i;
  return Fail(ErrorCode::kInvalidInput, "edge id " + item.edge.id.str() + " is not that of its content",
              "Set ids with AssignPushedIds");
}

Status PutNames(const BatchItem& item, rigcal_wire_PairwiseResult& sample) {
  const Edge& edge = item.edge;
  RIGCAL_TRY(CheckName("method", edge.method));
  RIGCAL_TRY(Put(edge.robot.str(), sample.robot_id, "robot_id"));
  RIGCAL_TRY(Put(item.batch.str(), sample.batch_id, "batch_id"));
  RIGCAL_TRY(Put(edge.id.str(), sample.edge_id, "edge_id"));
  RIGCAL_TRY(Put(edge.frame_a.str(), sample.frame_a, "frame_a"));
  RIGCAL_TRY(Put(edge.frame_b.str(), sample.frame_b, "frame_b"));
  RIGCAL_TRY(Put(NameOf(edge.uncertainty.source), sample.source, "source"));
  return Put(edge.method, sample.method, "method");
}

void PutNumbers(const Edge& edge, rigcal_wire_PairwiseResult& sample) {
  for (int i = 0; i < 3; ++i) sample.p_m[i] = edge.T_a_b.p_m[i];
  for (int i = 0; i < 4; ++i) sample.q_xyzw[i] = edge.T_a_b.q.coeffs()[i];
  PutMatrix(edge.uncertainty.Omega, sample.information);
  sample.rank = edge.uncertainty.rank;
  sample.dof = edge.uncertainty.dof;
  sample.jackknife_ratio = edge.uncertainty.jackknife_ratio;
  sample.measured_ns = edge.measured_at ? edge.measured_at->ns : 0;
}

Status PutParts(const Uncertainty& uncertainty, EdgeMemory& memory) {
  for (const BlockVector& block : uncertainty.blocks) {
    rigcal_wire_BlockVector& to = memory.blocks.emplace_back();
    RIGCAL_TRY(Put(block.block_id, to.block_id, "block_id"));
    for (int i = 0; i < 6; ++i) to.d[i] = block.d[i];
  }
  for (const Contribution& part : uncertainty.contributions) {
    rigcal_wire_Contribution& to = memory.contributions.emplace_back();
    RIGCAL_TRY(Put(part.name, to.name, "contribution name"));
    PutMatrix(part.covariance, to.covariance);
  }
  return {};
}

Status TakeNames(const rigcal_wire_PairwiseResult& sample, BatchItem& item) {
  RIGCAL_ASSIGN(item.edge.robot, RobotId::Parse(sample.robot_id));
  RIGCAL_ASSIGN(item.batch, BatchId::Parse(sample.batch_id));
  RIGCAL_ASSIGN(item.edge.id, EdgeId::Parse(sample.edge_id));
  RIGCAL_ASSIGN(item.edge.frame_a, SensorId::Parse(sample.frame_a));
  RIGCAL_ASSIGN(item.edge.frame_b, SensorId::Parse(sample.frame_b));
  RIGCAL_TRY(CheckName("method", sample.method));
  item.edge.method = sample.method;
  item.idx = sample.batch_idx;
  item.count = sample.batch_count;
  if (item.count <= limits::kEdgesPerBatchMax && item.idx < item.count) return {};
  return Refused(sample, "item " + std::to_string(item.idx) + " of a batch of " + std::to_string(item.count),
                 "A batch holds at most " + std::to_string(limits::kEdgesPerBatchMax) + " edges: send several");
}

Status TakePose(const rigcal_wire_PairwiseResult& sample, Se3& T_a_b) {
  RIGCAL_TRY(AllFinite(sample, sample.p_m, 3, "p_m"));
  RIGCAL_TRY(AllFinite(sample, sample.q_xyzw, 4, "q_xyzw"));
  for (int i = 0; i < 3; ++i) T_a_b.p_m[i] = sample.p_m[i];
  for (int i = 0; i < 4; ++i) T_a_b.q.coeffs()[i] = sample.q_xyzw[i];
  if (std::abs(T_a_b.q.norm() - 1.0) <= kUnitTolerance) return {};
  return Refused(sample, "q_xyzw has norm " + std::to_string(T_a_b.q.norm()), "Send a unit quaternion, order x y z w");
}

Status TakeParts(const rigcal_wire_PairwiseResult& sample, Uncertainty& uncertainty) {
  if (sample.blocks._length > limits::kPayloadsPerSessionMax || sample.contributions._length > kContributionsMax)
    return Refused(sample, "too many block vectors or contributions",
                   "At most " + std::to_string(limits::kPayloadsPerSessionMax) + " blocks and 64 contributions");
  for (std::uint32_t i = 0; i < sample.blocks._length; ++i) {
    const rigcal_wire_BlockVector& from = sample.blocks._buffer[i];
    RIGCAL_TRY(AllFinite(sample, from.d, 6, "blocks"));
    BlockVector& block = uncertainty.blocks.emplace_back();
    block.block_id = from.block_id;
    for (int k = 0; k < 6; ++k) block.d[k] = from.d[k];
  }
  for (std::uint32_t i = 0; i < sample.contributions._length; ++i) {
    const rigcal_wire_Contribution& from = sample.contributions._buffer[i];
    RIGCAL_TRY(AllFinite(sample, from.covariance, 36, "contributions"));
    uncertainty.contributions.push_back({from.name, MatrixOf(from.covariance)});
  }
  return {};
}

Status TakeUncertainty(const rigcal_wire_PairwiseResult& sample, Uncertainty& uncertainty) {
  RIGCAL_TRY(AllFinite(sample, sample.information, 36, "information"));
  RIGCAL_ASSIGN(const UncertaintySource source, UncertaintySourceOf(sample.source));
  const Matrix6d Omega = MatrixOf(sample.information);
  uncertainty = FromInformation(Omega, source, sample.dof);
  uncertainty.jackknife_ratio = sample.jackknife_ratio;
  uncertainty.Omega = Omega;  // as received, bit by bit: the edge's id is made of these bits
  if (uncertainty.rank != sample.rank)
    return Refused(sample,
                   "rank " + std::to_string(sample.rank) + ", but its information matrix has rank " +
                       std::to_string(uncertainty.rank),
                   "Send the rank of the matrix");
  return TakeParts(sample, uncertainty);
}

Status CheckIdentity(const rigcal_wire_PairwiseResult& sample, const Edge& edge) {
  if (sample.occurrence_idx < sample.batch_count &&
      PushedEdgeId(edge.robot, ContentDigest(edge), sample.occurrence_idx) == edge.id)
    return {};
  return Refused(sample, "its id is not that of its content",
                 "Push it again with the `rigcal push-edges` of this server's version");
}

}  // namespace

Result<Owned<rigcal_wire_PairwiseResult>> ToPairwiseResult(const BatchItem& item) {
  auto memory = std::make_shared<EdgeMemory>();
  Owned<rigcal_wire_PairwiseResult> owned;
  rigcal_wire_PairwiseResult& sample = owned.sample;
  RIGCAL_TRY(PutNames(item, sample));
  RIGCAL_TRY(PutParts(item.edge.uncertainty, *memory));
  RIGCAL_ASSIGN(sample.occurrence_idx, OccurrenceOf(item));
  PutNumbers(item.edge, sample);
  sample.batch_idx = item.idx;
  sample.batch_count = item.count;
  const auto blocks = static_cast<std::uint32_t>(memory->blocks.size());
  const auto parts = static_cast<std::uint32_t>(memory->contributions.size());
  sample.blocks = {blocks, blocks, memory->blocks.data(), false};
  sample.contributions = {parts, parts, memory->contributions.data(), false};
  owned.memory = std::move(memory);
  return owned;
}

Result<BatchItem> FromPairwiseResult(const rigcal_wire_PairwiseResult& sample) {
  BatchItem item;
  RIGCAL_TRY(TakeNames(sample, item));
  RIGCAL_TRY(TakePose(sample, item.edge.T_a_b));
  RIGCAL_TRY(TakeUncertainty(sample, item.edge.uncertainty));
  if (sample.measured_ns != 0) item.edge.measured_at = Stamp{sample.measured_ns};
  item.edge.state = EdgeState::kGood;
  RIGCAL_TRY(Validate(item.edge));
  RIGCAL_TRY(CheckIdentity(sample, item.edge));
  return item;
}

}  // namespace rigcal::wire
