// What speaks against a revision, one finding per kind: sentences without a final stop.
#pragma once

#include <optional>
#include <string>

#include "server/fleet/assess.h"

namespace rigcal::fleet {

struct Finding {
  std::string why;
  std::string what_to_do;
};

// The edge that contradicts the others most.
[[nodiscard]] std::optional<Finding> FindContradiction(const std::vector<Edge>& edges, const GraphSolution& solution,
                                                       const Policy& policy);
[[nodiscard]] std::optional<Finding> FindNoEdges(const std::vector<Edge>& edges);
[[nodiscard]] std::optional<Finding> FindUnsettled(const GraphSolution& solution);
[[nodiscard]] std::optional<Finding> FindUnknownSensors(const std::vector<Edge>& edges, const GraphSolution& solution);
[[nodiscard]] std::optional<Finding> FindFailedEdges(const std::vector<Edge>& edges);
[[nodiscard]] std::optional<Finding> FindUncertainSensors(const GraphSolution& solution, const Policy& policy);
[[nodiscard]] std::optional<Finding> FindUncheckedResult(const GraphSolution& solution);

}  // namespace rigcal::fleet
