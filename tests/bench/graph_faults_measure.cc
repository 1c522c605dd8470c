// Who is blamed where edges of a 12/59 graph are wrong, against known faults; prints one JSON object.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "server/graph/suspects.h"
#include "tests/unit/graph_random.h"

namespace rigcal::graph {
namespace {

constexpr double kRadiansPerDegree = 1.0 / 57.29577951308232;
constexpr double kSigma_m = 0.005, kSigma_rad = 0.3 * kRadiansPerDegree;
constexpr double kGross_m = 0.1, kGross_rad = 10.0 * kRadiansPerDegree;
constexpr std::size_t kSensors = 12, kEdges = 59;

// 59 of the 66 pairs of 12 sensors within 1.5 m.
RandomRig MakeGraph(std::mt19937& random) {
  RandomRig rig = MakeRig(kSensors, 0, static_cast<unsigned>(random()));
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t a = 0; a < kSensors; ++a)
    for (std::size_t b = a + 1; b < kSensors; ++b) pairs.emplace_back(a, b);
  for (std::size_t k = pairs.size() - 1; k > 0; --k) std::swap(pairs[k], pairs[random() % (k + 1)]);
  Matrix6d Omega = Matrix6d::Zero();
  Omega.diagonal() << Eigen::Vector3d::Constant(1 / (kSigma_m * kSigma_m)),
      Eigen::Vector3d::Constant(1 / (kSigma_rad * kSigma_rad));
  for (std::size_t k = 0; k < kEdges; ++k) {
    const auto [a, b] = pairs[k];
    const Se3 T = rig.truth[a].Inverse() * rig.truth[b] * Se3::Exp(DrawError(random, Omega));
    rig.graph.edges.push_back(MakeEdge(k, a, b, T.Normalized(), Omega));
  }
  return rig;
}

// 10 cm and 10 degrees, in any direction.
Vector6d GrossError(std::mt19937& random) {
  Vector6d error = RandomVector(random, 1.0, 1.0);
  error.head<3>() *= kGross_m / error.head<3>().norm();
  error.tail<3>() *= kGross_rad / error.tail<3>().norm();
  return error;
}

// Edges that are blamed: suspects, and the smaller group where a sensor has two poses.
std::set<EdgeId> Blamed(const Suspects& suspects) {
  std::set<EdgeId> blamed;
  for (const SuspectEdge& suspect : suspects.edges) blamed.insert(suspect.edge);
  for (const TwoPoses& two : suspects.two_poses)
    if (two.group_b.size() < two.group_a.size()) blamed.insert(two.group_b.begin(), two.group_b.end());
  return blamed;
}

double SquaredErrorWithout(const RandomRig& rig, const std::set<EdgeId>& out) {
  Graph graph = rig.graph;
  graph.edges.erase(
      std::remove_if(graph.edges.begin(), graph.edges.end(), [&](const GraphEdge& e) { return out.contains(e.id); }),
      graph.edges.end());
  SolveOptions options;
  options.marginals = false;
  const GraphSolution solution = Solve(graph, options);
  double sum = 0.0;
  for (std::size_t v = 1; v < kSensors; ++v)
    sum += (rig.truth[v].Inverse() * solution.poses[v].T_ref_sensor).Log().squaredNorm();
  return sum;
}

struct Faults {
  int bad = 0, found = 0, good = 0, false_alarms = 0;
  double squared = 0.0, squared_oracle = 0.0;

  void Count(const RandomRig& rig, const std::set<EdgeId>& wrong) {
    const std::set<EdgeId> blamed = Blamed(FindSuspects(rig.graph, Solve(rig.graph)));
    for (const GraphEdge& edge : rig.graph.edges) {
      const bool is_bad = wrong.contains(edge.id), is_blamed = blamed.contains(edge.id);
      (is_bad ? bad : good) += 1;
      if (is_blamed) (is_bad ? found : false_alarms) += 1;
    }
    squared += SquaredErrorWithout(rig, blamed);
    squared_oracle += SquaredErrorWithout(rig, wrong);
  }
};

Faults MeasureIndependent(int count, int seeds) {
  Faults faults;
  for (int seed = 0; seed < seeds; ++seed) {
    std::mt19937 random(static_cast<unsigned>(1000 * count + seed));
    RandomRig rig = MakeGraph(random);
    std::set<EdgeId> wrong;
    while (wrong.size() < static_cast<std::size_t>(count)) {
      GraphEdge& edge = rig.graph.edges[random() % kEdges];
      if (wrong.insert(edge.id).second) edge.T_a_b = edge.T_a_b * Se3::Exp(GrossError(random));
    }
    faults.Count(rig, wrong);
  }
  return faults;
}

// `count` edges of one sensor saw it elsewhere; fewer where that leaves fewer than two others.
std::set<EdgeId> MoveSensor(RandomRig& rig, std::size_t sensor, std::size_t count, std::mt19937& random) {
  const Se3 T_moved = Se3::Exp(GrossError(random));
  std::set<EdgeId> wrong;
  for (GraphEdge& edge : rig.graph.edges) {
    if (wrong.size() == count) break;
    if (edge.frame_a != Name(sensor) && edge.frame_b != Name(sensor)) continue;
    edge.T_a_b = edge.frame_b == Name(sensor) ? edge.T_a_b * T_moved : T_moved.Inverse() * edge.T_a_b;
    wrong.insert(edge.id);
  }
  return wrong;
}

std::size_t DegreeOf(const RandomRig& rig, std::size_t sensor) {
  std::size_t degree = 0;
  for (const GraphEdge& edge : rig.graph.edges)
    degree += edge.frame_a == Name(sensor) || edge.frame_b == Name(sensor) ? 1 : 0;
  return degree;
}

Faults MeasureConsistent(std::size_t count, int seeds) {
  Faults faults;
  for (int seed = 0; seed < seeds; ++seed) {
    std::mt19937 random(static_cast<unsigned>(50000 * count) + static_cast<unsigned>(seed));
    RandomRig rig = MakeGraph(random);
    const std::set<EdgeId> wrong = MoveSensor(rig, random() % kSensors, count, random);
    faults.Count(rig, wrong);
  }
  return faults;
}

// Share of graphs where the sensor that half or more of its edges (up to all but two) saw elsewhere, and it alone, gets
// the verdict, with both groups right.
double MeasureTwoPoses(int seeds) {
  int right = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    std::mt19937 random(900000 + static_cast<unsigned>(seed));
    RandomRig rig = MakeGraph(random);
    const std::size_t sensor = random() % kSensors, degree = DegreeOf(rig, sensor), half = (degree + 1) / 2;
    const std::set<EdgeId> wrong = MoveSensor(rig, sensor, half + random() % (degree - 1 - half), random);
    const Suspects suspects = FindSuspects(rig.graph, Solve(rig.graph));
    if (suspects.two_poses.size() != 1 || suspects.two_poses[0].sensor != Name(sensor)) continue;
    const auto is_wrong = [&](const std::vector<EdgeId>& group) {
      return std::set<EdgeId>(group.begin(), group.end()) == wrong;
    };
    right += is_wrong(suspects.two_poses[0].group_a) || is_wrong(suspects.two_poses[0].group_b) ? 1 : 0;
  }
  return static_cast<double>(right) / seeds;
}

void Add(Faults& sum, const Faults& part) {
  sum.bad += part.bad, sum.found += part.found, sum.good += part.good, sum.false_alarms += part.false_alarms;
  sum.squared += part.squared, sum.squared_oracle += part.squared_oracle;
}

void Run() {
  constexpr int kSeeds = 300;
  Faults independent, consistent, none;
  double worst_rms_ratio = 0.0;
  for (int count = 1; count <= 10; ++count) {
    const Faults part = MeasureIndependent(count, kSeeds);
    worst_rms_ratio = std::max(worst_rms_ratio, std::sqrt(part.squared / part.squared_oracle));
    Add(independent, part);
  }
  for (std::size_t count = 1; count <= 3; ++count) Add(consistent, MeasureConsistent(count, kSeeds));
  Add(none, MeasureIndependent(0, kSeeds));
  std::printf(
      "{\"graphs\": %d, \"recall\": %.6f, \"false_alarms\": %.6f, \"rms_ratio\": %.6f, \"rms_ratio_worst\": %.6f, "
      "\"false_alarms_without_faults\": %.6f, \"consistent_recall\": %.6f, \"consistent_false_alarms\": %.6f, "
      "\"two_poses\": %.6f}\n",
      10 * kSeeds, static_cast<double>(independent.found) / independent.bad,
      static_cast<double>(independent.false_alarms) / independent.good,
      std::sqrt(independent.squared / independent.squared_oracle), worst_rms_ratio,
      static_cast<double>(none.false_alarms) / none.good, static_cast<double>(consistent.found) / consistent.bad,
      static_cast<double>(consistent.false_alarms) / consistent.good, MeasureTwoPoses(kSeeds));
}

}  // namespace
}  // namespace rigcal::graph

int main() {
  rigcal::graph::Run();
  return 0;
}
