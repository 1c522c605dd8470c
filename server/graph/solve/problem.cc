#include "server/graph/solve/problem.h"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <tuple>

#include "server/graph/large/lane_kernels.h"
#include "server/graph/solve/solve.h"
#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

auto PoseKey(const GraphEdge& edge) {
  const Se3& T = edge.T_a_b;
  return std::make_tuple(T.p_m.x(), T.p_m.y(), T.p_m.z(), T.q.x(), T.q.y(), T.q.z(), T.q.w());
}

// Ids are unique in a store; the rest of the key only makes the order total for graphs made by hand.
bool EdgeBefore(const GraphEdge& a, const GraphEdge& b) {
  if (a.id != b.id) return a.id < b.id;
  if (a.frame_a != b.frame_a) return a.frame_a < b.frame_a;
  if (a.frame_b != b.frame_b) return a.frame_b < b.frame_b;
  if (PoseKey(a) != PoseKey(b)) return PoseKey(a) < PoseKey(b);
  return std::lexicographical_compare(a.Omega.data(), a.Omega.data() + 36, b.Omega.data(), b.Omega.data() + 36);
}

// The first characters of an id as a number that sorts as they do: compares most ids without looking at them.
std::uint64_t PrefixOf(std::string_view id) {
  std::uint64_t prefix = 0;
  for (std::size_t k = 0; k < sizeof prefix; ++k)
    prefix = prefix << 8 | (k < id.size() ? static_cast<unsigned char>(id[k]) : 0U);
  return prefix;
}

std::vector<std::size_t> SortedById(const std::vector<GraphEdge>& edges) {
  std::vector<std::pair<std::uint64_t, std::size_t>> keys(edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) keys[e] = {PrefixOf(edges[e].id.str()), e};
  std::sort(keys.begin(), keys.end(), [&edges](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : EdgeBefore(edges[a.second], edges[b.second]);
  });
  std::vector<std::size_t> order(edges.size());
  for (std::size_t k = 0; k < keys.size(); ++k) order[k] = keys[k].second;
  return order;
}

std::string NameOfEdge(const GraphEdge& edge) {
  return "edge " + edge.frame_a.str() + " - " + edge.frame_b.str() + " (" + edge.id.str().substr(0, 12) + ")";
}

// Far beyond any rig, and such that no sum over a graph overflows.
constexpr double kTranslationMax_m = 1e9;
constexpr double kInformationMin = 1e-30, kInformationMax = 1e30;

// Empty: usable. Else why not.
std::string WhyUnusable(const GraphEdge& edge) {
  if (edge.frame_a == edge.frame_b) return "joins a sensor with itself";
  if (!edge.T_a_b.p_m.allFinite() || !edge.T_a_b.q.coeffs().allFinite()) return "has a pose that is not finite";
  if (edge.T_a_b.q.norm() < 0.5) return "has a quaternion of length zero";
  if (edge.T_a_b.p_m.cwiseAbs().maxCoeff() > kTranslationMax_m) return "has a translation beyond a million kilometres";
  return {};
}

// What four edges' information is like. An edge that is missing is stood in for by the first.
InformationLanes Judge(const std::array<const GraphEdge*, kLanes>& edges) {
  const double* entries[kLanes];
  for (std::size_t lane = 0; lane < kLanes; ++lane)
    entries[lane] = (edges[lane] != nullptr ? edges[lane] : edges[0])->Omega.data();
  InformationLanes lanes;
  Kernels().Information(entries, lanes);
  return lanes;
}

// Log det Omega and rank, cheaply where Omega is clearly positive definite; false if it is indefinite, asymmetric or
// zero.
bool JudgeInformation(const GraphEdge& edge, const InformationLanes& lanes, std::size_t lane, Constraint& constraint) {
  const double asymmetry = lanes.asymmetry[lane];
  const bool clear = lanes.is_clear[lane] != 0.0 && std::isnormal(lanes.pivot_product[lane]);
  // Of a positive definite matrix no entry is larger than the largest of the diagonal.
  const double scale = clear ? lanes.largest_of_diagonal[lane] : edge.Omega.cwiseAbs().maxCoeff();
  if (!(scale >= kInformationMin && scale <= kInformationMax) || (!clear && !edge.Omega.allFinite())) return false;
  if (!(asymmetry <= 1e-9 * scale)) return false;
  constraint.Omega = edge.Omega;
  if (asymmetry > 0.0) constraint.Omega = 0.5 * edge.Omega + 0.5 * edge.Omega.transpose();
  if (edge.rank == 6 && clear) {
    constraint.rank = 6;
    constraint.log_det_Omega = std::log(lanes.pivot_product[lane]);
    return true;
  }
  if (!IsPositiveSemidefinite(constraint.Omega)) return false;
  constraint.rank = Observable(constraint.Omega).rank;
  constraint.log_det_Omega =
      constraint.rank == 6 ? constraint.Omega.ldlt().vectorD().cwiseAbs().array().log().sum() : 0.0;
  return constraint.rank > 0;
}

// Everything of a constraint but its vertices and slot; otherwise why it cannot be used.
std::string Fill(const GraphEdge& edge, const InformationLanes& lanes, std::size_t lane, Constraint& constraint) {
  if (std::string why = WhyUnusable(edge); !why.empty()) return why;
  if (!JudgeInformation(edge, lanes, lane, constraint))
    return "has an information matrix that is zero, out of range, not symmetric or not positive semi-definite";
  constraint.T_i_j = edge.T_a_b.Normalized();
  constraint.T_j_i = constraint.T_i_j.Inverse();
  return {};
}

// The graph with sensors replaced by their rank in canonical order.
struct Ranked {
  std::vector<std::size_t> sensor_of_rank;
  struct Name {
    std::uint64_t prefix = 0;
    std::string_view text;
    int rank = -1;
    friend auto operator<=>(const Name&, const Name&) = default;
  };
  std::vector<Name> names;  // sorted
  int reference = -1;
};

std::vector<std::size_t> CanonicalSensors(const Graph& graph) {
  std::vector<std::size_t> order(graph.sensors.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (std::is_sorted(graph.sensors.begin(), graph.sensors.end(), SensorBefore)) return order;
  std::sort(order.begin(), order.end(),
            [&graph](std::size_t a, std::size_t b) { return SensorBefore(graph.sensors[a], graph.sensors[b]); });
  return order;
}

Ranked RankSensors(const Graph& graph) {
  Ranked ranked;
  ranked.sensor_of_rank = CanonicalSensors(graph);
  ranked.names.reserve(graph.sensors.size());
  for (std::size_t r = 0; r < ranked.sensor_of_rank.size(); ++r) {
    const SensorId& sensor = graph.sensors[ranked.sensor_of_rank[r]];
    ranked.names.push_back({PrefixOf(sensor.str()), sensor.str(), static_cast<int>(r)});
    if (sensor == graph.reference) ranked.reference = static_cast<int>(r);
  }
  std::sort(ranked.names.begin(), ranked.names.end());
  return ranked;
}

int FindRank(const Ranked& ranked, const SensorId& sensor) {
  const Ranked::Name wanted{PrefixOf(sensor.str()), sensor.str(), -1};
  const auto found = std::lower_bound(ranked.names.begin(), ranked.names.end(), wanted);
  return found != ranked.names.end() && found->text == wanted.text ? found->rank : -1;
}

// Edges `first` on, by id.
std::array<const GraphEdge*, kLanes> FourEdges(const Graph& graph, const Problem& problem, std::size_t first) {
  std::array<const GraphEdge*, kLanes> edges{};
  for (std::size_t lane = 0; lane < kLanes && first + lane < graph.edges.size(); ++lane)
    edges[lane] = &graph.edges[problem.edges_by_id[first + lane]];
  return edges;
}

// Usable edges as constraints between ranks of sensors, a diagnosis for every other.
void CollectConstraints(const Graph& graph, const Ranked& ranked, Problem& problem) {
  problem.constraints.reserve(graph.edges.size());
  for (std::size_t first = 0; first < graph.edges.size(); first += kLanes) {
    const auto edges = FourEdges(graph, problem, first);
    const InformationLanes information = Judge(edges);
    for (std::size_t lane = 0; lane < kLanes && edges[lane] != nullptr; ++lane) {
      const GraphEdge& edge = *edges[lane];
      Constraint& constraint = problem.constraints.emplace_back();
      constraint.i = FindRank(ranked, edge.frame_a);
      constraint.j = FindRank(ranked, edge.frame_b);
      constraint.edge = first + lane;
      const std::string why = constraint.i < 0 || constraint.j < 0 ? "names a sensor that is not in the graph"
                                                                   : Fill(edge, information, lane, constraint);
      if (why.empty()) continue;
      problem.constraints.pop_back();
      problem.diagnoses.push_back({"edge_not_usable", NameOfEdge(edge) + " " + why + " and takes no part",
                                   "Mend this edge where it was made and push it again."});
    }
  }
}

Diagnosis NotConnected(const Graph& graph, const SensorId& sensor, bool has_edge) {
  const std::string reference = graph.reference.str();
  const std::string why =
      has_edge ? "its edges lead only to sensors that are not connected either" : "it has no good edge";
  return {"not_connected", "sensor " + sensor.str() + " is not connected to reference " + reference + ": " + why,
          "Capture a session that shows " + sensor.str() + " together with a sensor connected to " + reference +
              ", or push an edge between them."};
}

// Ranks of the reference's component in canonical order, the reference first; a diagnosis for every other sensor.
std::vector<int> ReferenceComponent(const Graph& graph, const Ranked& ranked, Problem& problem) {
  UnionFind sets(ranked.sensor_of_rank.size());
  std::vector<bool> has_edge(ranked.sensor_of_rank.size(), false);
  for (const Constraint& c : problem.constraints) {
    sets.Join(c.i, c.j);
    has_edge[static_cast<std::size_t>(c.i)] = has_edge[static_cast<std::size_t>(c.j)] = true;
  }
  std::vector<int> component;
  if (ranked.reference >= 0) component.push_back(ranked.reference);
  for (std::size_t r = 0; r < ranked.sensor_of_rank.size(); ++r) {
    const int rank = static_cast<int>(r);
    if (rank == ranked.reference) continue;
    if (ranked.reference >= 0 && sets.Find(rank) == sets.Find(ranked.reference)) {
      component.push_back(rank);
    } else {
      problem.diagnoses.push_back(NotConnected(graph, graph.sensors[ranked.sensor_of_rank[r]], has_edge[r]));
    }
  }
  return component;
}

// Vertex of every rank (-1: not in the component): the reference 0, the others in elimination order.
std::vector<int> NumberVertices(const Ranked& ranked, const std::vector<int>& component, Problem& problem) {
  std::vector<int> member(ranked.sensor_of_rank.size(), -1);
  for (std::size_t k = 0; k < component.size(); ++k)
    member[static_cast<std::size_t>(component[k])] = static_cast<int>(k);
  BlockPattern links{static_cast<int>(component.size()) - 1, {}};
  links.off_diagonal.reserve(problem.constraints.size());
  for (const Constraint& c : problem.constraints) {
    const int a = member[static_cast<std::size_t>(c.i)], b = member[static_cast<std::size_t>(c.j)];
    if (a > 0 && b > 0) links.off_diagonal.push_back({std::max(a, b) - 1, std::min(a, b) - 1});
  }
  const Elimination elimination = EliminationOrder(links);
  const std::vector<int>& order = elimination.order;
  problem.elimination_cost = elimination.cost;
  std::vector<int> vertex_of_rank(ranked.sensor_of_rank.size(), -1);
  vertex_of_rank[static_cast<std::size_t>(component[0])] = 0;
  for (std::size_t p = 0; p < order.size(); ++p)
    vertex_of_rank[static_cast<std::size_t>(component[static_cast<std::size_t>(order[p]) + 1])] =
        static_cast<int>(p) + 1;
  return vertex_of_rank;
}

void AssignSlots(Problem& problem) {
  std::vector<BlockPosition>& blocks = problem.pattern.off_diagonal;
  const auto position = [](const Constraint& c) {
    return BlockPosition{std::max(c.i, c.j) - 1, std::min(c.i, c.j) - 1};
  };
  for (const Constraint& c : problem.constraints)
    if (c.i > 0 && c.j > 0) blocks.push_back(position(c));
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  for (Constraint& c : problem.constraints) {
    if (c.i == 0 || c.j == 0) continue;
    c.slot = static_cast<int>(std::lower_bound(blocks.begin(), blocks.end(), position(c)) - blocks.begin());
  }
}

void FillVertices(const Ranked& ranked, const std::vector<int>& vertex_of_rank, Problem& problem) {
  for (std::size_t r = 0; r < vertex_of_rank.size(); ++r) {
    if (vertex_of_rank[r] < 0) continue;
    problem.vertex_of_sensor[ranked.sensor_of_rank[r]] = vertex_of_rank[r];
    problem.sensor_of_vertex[static_cast<std::size_t>(vertex_of_rank[r])] = ranked.sensor_of_rank[r];
  }
}

// Constraints between vertices instead of ranks; those outside the component go.
void FillConstraints(const std::vector<int>& vertex_of_rank, Problem& problem) {
  std::erase_if(problem.constraints,
                [&](const Constraint& c) { return vertex_of_rank[static_cast<std::size_t>(c.i)] < 0; });
  for (Constraint& c : problem.constraints) {
    c.i = vertex_of_rank[static_cast<std::size_t>(c.i)];
    c.j = vertex_of_rank[static_cast<std::size_t>(c.j)];
  }
}

}  // namespace

std::string FillConstraint(const GraphEdge& edge, std::size_t edge_idx, Constraint& constraint) {
  constraint.edge = edge_idx;
  return Fill(edge, Judge({&edge}), 0, constraint);
}

Problem MakeProblem(const Graph& graph) {
  Problem problem;
  problem.edges_by_id = SortedById(graph.edges);
  problem.vertex_of_sensor.assign(graph.sensors.size(), -1);
  const Ranked ranked = RankSensors(graph);
  CollectConstraints(graph, ranked, problem);
  const std::vector<int> component = ReferenceComponent(graph, ranked, problem);
  if (component.empty()) {
    problem.constraints.clear();
    return problem;
  }
  problem.vertex_count = static_cast<int>(component.size());
  problem.sensor_of_vertex.resize(component.size());
  const std::vector<int> vertex_of_rank = NumberVertices(ranked, component, problem);
  FillVertices(ranked, vertex_of_rank, problem);
  FillConstraints(vertex_of_rank, problem);
  problem.pattern.block_count = problem.free_count();
  AssignSlots(problem);
  return problem;
}

}  // namespace rigcal::graph
