#include <climits>
#include <cmath>
#include <sstream>

#include "server/base/limits.h"
#include "server/formats/documents.h"
#include "server/formats/edges/edge_fields.h"
#include "server/formats/edges/first_three.h"
#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kEdgeFileBytesMax = 256u << 20;
constexpr double kHandWrittenTolerance = 1e-3;  // of a quaternion with few digits: it is normalised
constexpr double kExactTolerance = 1e-12;       // nearer ones stay as they are, bit by bit

std::string NumberText(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

Se3 ReadMeasuredPose(const JsonField& field) {
  const Se3 T = ReadPose(field, kHandWrittenTolerance);
  return std::abs(T.q.norm() - 1.0) <= kExactTolerance && T.q.w() >= 0.0 ? T : T.Normalized();
}

// A matrix with an asymmetric entry is named by it; a person finds that faster than "not symmetric".
void RefuseAsymmetry(const JsonField& field, const Matrix6d& matrix) {
  const double scale = matrix.cwiseAbs().maxCoeff();
  for (int row = 0; row < 6; ++row)
    for (int col = row + 1; col < 6; ++col)
      if (!(std::abs(matrix(row, col) - matrix(col, row)) <= 1e-9 * scale))
        return field.Refuse("is not symmetric: [" + std::to_string(row) + "][" + std::to_string(col) + "] is " +
                            NumberText(matrix(row, col)) + ", [" + std::to_string(col) + "][" + std::to_string(row) +
                            "] is " + NumberText(matrix(col, row)));
}

Matrix6d ReadSymmetric(const JsonField& field) {
  const Matrix6d matrix = ReadMatrix(field);
  RefuseAsymmetry(field, matrix);
  return Symmetrized(matrix);
}

Uncertainty ReadInformation(const JsonField& field, UncertaintySource source, int dof, bool& indefinite) {
  const Matrix6d Omega = ReadSymmetric(field);
  indefinite = !IsPositiveSemidefinite(Omega);
  if (indefinite) return {};
  if (Omega.isZero(0.0)) field.Refuse("is zero: it says nothing");
  return FromInformation(Omega, source, dof);
}

Uncertainty ReadCovariance(const JsonField& field, UncertaintySource source, int dof) {
  Result<Uncertainty> uncertainty = FromCovariance(ReadSymmetric(field), source, dof);
  if (uncertainty) return *std::move(uncertainty);
  field.Refuse("is not positive definite; give `information` if a direction is not observed");
  return {};
}

Uncertainty ReadGivenUncertainty(const JsonField& edge, bool& indefinite) {
  const auto information = edge.Find("information");
  const auto covariance = edge.Find("covariance");
  if (information.has_value() == covariance.has_value()) {
    edge.Refuse(information ? "has both \"information\" and \"covariance\": give one"
                            : "\"information\" or \"covariance\" is missing");
    return {};
  }
  const auto source_field = edge.Find("source");
  const UncertaintySource source = source_field ? ReadSource(*source_field) : UncertaintySource::kGiven;
  const auto blocks_field = edge.Find("blocks");
  std::vector<BlockVector> blocks = blocks_field ? ReadBlocks(*blocks_field) : std::vector<BlockVector>();
  const auto dof_field = edge.Find("dof");
  const int dof = dof_field        ? static_cast<int>(dof_field->Integer(0, INT_MAX))
                  : blocks.empty() ? 0
                                   : static_cast<int>(blocks.size()) - 1;
  Uncertainty uncertainty =
      information ? ReadInformation(*information, source, dof, indefinite) : ReadCovariance(*covariance, source, dof);
  uncertainty.blocks = std::move(blocks);
  if (const auto ratio = edge.Find("jackknife_ratio")) uncertainty.jackknife_ratio = ReadRatio(*ratio);
  if (const auto contributions = edge.Find("contributions"))
    uncertainty.contributions = ReadContributions(*contributions);
  return uncertainty;
}

std::string ReadMethod(const JsonField& field) {
  std::string method = field.Text();
  if (const Status name = CheckName("method", method); !name) field.Refuse(name.error().what);
  return method;
}

std::optional<Stamp> ReadMeasuredAt(const JsonField& parent) {
  const auto field = parent.Find("measured_at");
  return field ? std::optional(ReadStamp(*field)) : std::nullopt;
}

// `indefinite`: its information matrix has a negative eigenvalue; the caller says so, of all edges at once.
Edge ReadMeasuredEdge(const JsonField& field, const RobotId& robot, bool& indefinite) {
  field.AllowOnly({"frame_a", "frame_b", "T_a_b", "information", "covariance", "method", "dof", "source", "blocks",
                   "contributions", "jackknife_ratio", "measured_at"});
  Edge edge;
  edge.robot = robot;
  edge.frame_a = ReadId<SensorId>(field.At("frame_a"));
  edge.frame_b = ReadId<SensorId>(field.At("frame_b"));
  edge.T_a_b = ReadMeasuredPose(field.At("T_a_b"));
  edge.uncertainty = ReadGivenUncertainty(field, indefinite);
  const auto method = field.Find("method");
  edge.method = method ? ReadMethod(*method) : "given";
  edge.measured_at = ReadMeasuredAt(field);
  edge.state = EdgeState::kGood;
  return edge;
}

// One is named by its field; of many, how many and the first three.
void RefuseIndefinite(const JsonField& root, const std::vector<JsonField>& items,
                      const std::vector<std::size_t>& indefinite) {
  if (indefinite.empty()) return;
  if (indefinite.size() == 1) return items[indefinite.front()].At("information").Refuse("has a negative eigenvalue");
  root.At("edges").Refuse(
      std::to_string(indefinite.size()) + " of " + std::to_string(items.size()) +
      " information matrices have a negative eigenvalue: " +
      FirstThree(indefinite.size(), [&](std::size_t i) { return "[" + std::to_string(indefinite[i]) + "]"; }));
}

}  // namespace

Result<std::vector<Edge>> ReadEdgeFile(std::string_view text, const RobotId& robot) {
  const JsonKind kind = {"edge file", "Mend the file as docs/edges-format.md describes it.", kEdgeFileBytesMax};
  RIGCAL_ASSIGN(JsonDocument document, JsonDocument::Parse(text, kind));
  const JsonField root = document.Root();
  (void)root.At("format").Integer(1, 1);
  root.AllowOnly({"format", "edges", "measured_at"});
  const std::optional<Stamp> measured_at = ReadMeasuredAt(root);
  const std::vector<JsonField> items = root.At("edges").Items(limits::kEdgesPerBatchMax);
  if (items.empty()) root.Refuse("\"edges\" is empty: there is nothing to push");
  std::vector<Edge> edges;
  std::vector<std::size_t> indefinite;
  for (const JsonField& item : items) {
    bool has_negative = false;
    edges.push_back(ReadMeasuredEdge(item, robot, has_negative));
    if (!edges.back().measured_at) edges.back().measured_at = measured_at;
    RIGCAL_TRY(document.status());
    if (has_negative) {
      indefinite.push_back(edges.size() - 1);
      continue;
    }
    if (const Status valid = Validate(edges.back()); !valid) item.Refuse(valid.error().what);
  }
  RefuseIndefinite(root, items, indefinite);
  RIGCAL_TRY(document.status());
  AssignPushedIds(edges);
  return edges;
}

}  // namespace rigcal::formats
