// Poses composed along edges, and how the errors of those edges add up in them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "server/model/edges/edge.h"

namespace rigcal::paper {

struct Step {
  std::size_t edge = 0;  // index into the edges
  bool reversed = false;
};
using Path = std::vector<Step>;

// From the first sensor to the last through each of the others, an edge apiece; of `methods`, if given, one name per
// step. Nothing where a good edge is missing.
[[nodiscard]] std::optional<Path> FindPath(const std::vector<Edge>& edges, const std::vector<SensorId>& sensors,
                                           const std::vector<std::string>& methods = {});
[[nodiscard]] Se3 Compose(const std::vector<Edge>& edges, const Path& path);
// 6 x 6 edges: the right tangent of the composed pose by those of the edges, to first order.
[[nodiscard]] Eigen::MatrixXd ErrorMap(const std::vector<Edge>& edges, const Path& path);

}  // namespace rigcal::paper
