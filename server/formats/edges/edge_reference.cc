#include "server/formats/edges/edge_reference.h"

#include <algorithm>
#include <array>
#include <climits>
#include <limits>

#include "server/formats/edges/edge_fields.h"
#include "server/formats/json/json_values.h"
#include "server/model/edges/merged_edge.h"
#include "server/model/edges/weak_edge.h"

namespace rigcal::formats {
namespace {

constexpr std::array<const char*, 5> kKindFigures = {kMergedEdges, kMergedSessions, kMergedPart, kMergedWeak,
                                                     "polished_ratio"};

std::map<std::string, double> KindFiguresOf(const Edge& edge) {
  std::map<std::string, double> figures;
  for (const char* name : kKindFigures)
    if (const auto found = edge.figures.find(name); found != edge.figures.end()) figures.insert(*found);
  return figures;
}

// Of three axes from `first` on; those that are null are `open`.
void ReadVariances(const JsonField& sigmas, int first, Matrix6d& covariance, std::vector<int>& open) {
  const std::vector<JsonField> values = sigmas.Items(3);
  if (values.size() != 3) return sigmas.Refuse("must be 3 numbers");
  for (int i = 0; i < 3; ++i) {
    const JsonField& value = values[static_cast<std::size_t>(i)];
    if (value.IsNull()) {
      open.push_back(first + i);
      continue;
    }
    const double sigma = value.Number();
    if (!(sigma >= 0.0)) return value.Refuse("must not be negative");
    covariance(first + i, first + i) = std::min(sigma * sigma, std::numeric_limits<double>::max());
  }
}

Uncertainty ReadToldUncertainty(const JsonField& edge) {
  Uncertainty uncertainty;
  uncertainty.rank = static_cast<int>(edge.At("rank").Integer(0, 6));
  uncertainty.dof = static_cast<int>(edge.At("dof").Integer(0, INT_MAX));
  uncertainty.source = ReadSource(edge.At("source"));
  std::vector<int> open;
  ReadVariances(edge.At("sigma_m"), tangent::kTranslation, uncertainty.covariance, open);
  ReadVariances(edge.At("sigma_rad"), tangent::kRotation, uncertainty.covariance, open);
  uncertainty.unobservable_basis.setZero(6, static_cast<Eigen::Index>(open.size()));
  for (std::size_t i = 0; i < open.size(); ++i)
    uncertainty.unobservable_basis(open[i], static_cast<Eigen::Index>(i)) = 1.0;
  return uncertainty;
}

}  // namespace

void WriteEdgeReference(JsonWriter& out, const Edge& edge) { WriteEdgeRow(out, edge, KindFiguresOf(edge)); }

Edge ReadEdgeReference(const JsonField& field, const RobotId& robot) {
  Edge edge = ReadEdgeRow(field);
  edge.robot = robot;
  if (edge.state == EdgeState::kGood) edge.uncertainty = ReadToldUncertainty(field);
  return edge;
}

}  // namespace rigcal::formats
