// How the edges of one visit err together, and what a graph makes of it to first order.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/graph/uncertainty/graph_jackknife.h"

namespace rigcal::paper {

// Independent causes of error, one column each; rows 6 k to 6 k + 5: the right tangent of edges[k]. Columns times their
// transpose is the joint covariance of all edges: blocks that edges share, given constants that they share, and what is
// an edge's own. All edges good.
[[nodiscard]] Eigen::MatrixXd ErrorColumns(const std::vector<Edge>& edges);
// The same as if no two edges shared anything: what each edge says of itself.
[[nodiscard]] Eigen::MatrixXd IndependentColumns(const Graph& graph);

// A graph at the truth, where every residual is zero: e = J x - d for errors x of the poses and d of the edges.
struct LinearGraph {
  Eigen::MatrixXd J;  // 6 edges x 6 (sensors - 1): every sensor but the reference, in the graph's order

  LinearGraph(const Graph& graph, const std::vector<Se3>& truth);  // truth: T_ref_sensor in the order of graph.sensors
  // x = K d of the weighted optimum; weights by edge, zero leaves an edge out.
  [[nodiscard]] Eigen::MatrixXd Gain(const std::vector<Matrix6d>& weights) const;
  // e = R d.
  [[nodiscard]] Eigen::MatrixXd ResidualMap(const std::vector<Matrix6d>& weights) const;
};
[[nodiscard]] std::vector<Matrix6d> WeightsOf(const Graph& graph);
// The graph's weights on the edges of its spanning tree, zero on the others: the optimum is the start that E_global
// "before" is measured at.
[[nodiscard]] std::vector<Matrix6d> TreeWeights(const Graph& graph);

// Of a sum of squares of normal errors: its mean, and the degrees of freedom of the chi-square that it is most like
// (Satterthwaite).
struct Spread {
  double mean = 0.0, dof = 1.0;
};
[[nodiscard]] Spread SpreadOf(const Eigen::MatrixXd& columns);
// Where a chi-square over its degrees of freedom lies but for odds of 1e-6.
struct Interval {
  double low = 0.0, high = 0.0;
};
[[nodiscard]] Interval IntervalOf(double dof);

}  // namespace rigcal::paper
