// An edge's members, in the groups of which the documents of edges are made.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"
#include "server/model/edges/edge.h"
#include "server/model/graph/graph.h"

namespace rigcal::formats {

// Of a row: ids, frames, state, pose, sigmas, figures, diagnoses.
void WriteEdgeSummary(JsonWriter& out, const Edge& edge);
// The same with `figures` in the place of the edge's own.
void WriteEdgeRow(JsonWriter& out, const Edge& edge, const std::map<std::string, double>& figures);
// The rest, without block vectors: robot, information, covariance, contributions, captures, evidence.
void WriteEdgeDetail(JsonWriter& out, const Edge& edge);
void WriteBlocks(JsonWriter& out, const std::vector<BlockVector>& blocks);
// {"e", "in_solution", "weighted", "jackknife": {"t_squared", "rank", "dof"} if there is one}, or null.
void WriteResidual(JsonWriter& out, const EdgeResidual* residual);
// Of `residuals`, sorted by edge id; null if the edge has none.
[[nodiscard]] const EdgeResidual* ResidualOf(const std::vector<EdgeResidual>& residuals, const EdgeId& edge);

// Both groups; not validated.
[[nodiscard]] Edge ReadEdgeFields(const JsonField& field);
// A row, without robot and uncertainty; not validated.
[[nodiscard]] Edge ReadEdgeRow(const JsonField& field);
[[nodiscard]] std::vector<BlockVector> ReadBlocks(const JsonField& field);
[[nodiscard]] std::vector<Contribution> ReadContributions(const JsonField& field);
[[nodiscard]] UncertaintySource ReadSource(const JsonField& field);
[[nodiscard]] double ReadRatio(const JsonField& field);  // between 0 and 1

}  // namespace rigcal::formats
