// Who is blamed where edges of a 12/59 graph are wrong, against known faults; prints one JSON object.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "server/fleet/assess.h"
#include "server/graph/insight/insight.h"
#include "tests/bench/graph/fault_graphs.h"

namespace rigcal::graph {
namespace {

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
  for (std::size_t v = 1; v < kFaultSensors; ++v)
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

Faults MeasureIndependent(int count, int seeds, const Information& information = {}) {
  Faults faults;
  for (int seed = 0; seed < seeds; ++seed) {
    std::mt19937 random(static_cast<unsigned>(1000 * count + seed));
    RandomRig rig = MakeFaultGraph(random, information).rig;
    const std::set<EdgeId> wrong = SpoilEdges(rig, static_cast<std::size_t>(count), random);
    faults.Count(rig, wrong);
  }
  return faults;
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
    RandomRig rig = MakeFaultGraph(random, {}).rig;
    const std::set<EdgeId> wrong = MoveSensor(rig, random() % kFaultSensors, count, random);
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
    RandomRig rig = MakeFaultGraph(random, {}).rig;
    const std::size_t sensor = random() % kFaultSensors, degree = DegreeOf(rig, sensor), half = (degree + 1) / 2;
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

double Share(int part, int whole) { return static_cast<double>(part) / std::max(whole, 1); }

// The values behind a verdict, as a store would hold them.
std::vector<Edge> EdgesOf(const Graph& graph) {
  std::vector<Edge> edges;
  for (const GraphEdge& from : graph.edges) {
    Edge edge;
    edge.id = from.id, edge.session = from.session;
    edge.frame_a = from.frame_a, edge.frame_b = from.frame_b;
    edge.T_a_b = from.T_a_b;
    edge.state = EdgeState::kGood;
    edge.uncertainty = FromInformation(from.Omega, UncertaintySource::kJackknife, from.dof);
    edges.push_back(edge);
  }
  return edges;
}

struct Judgement {
  bool fails = false, loop_fails = false;
};

Judgement Judge(const FaultGraph& made) {
  GraphSolution solution = Solve(made.rig.graph);
  ApplyJackknifeCovariance(made.rig.graph, JackknifeGraph(made.rig.graph, solution, made.blocks), solution);
  solution.suspects = FindSuspects(made.rig.graph, solution);
  solution.cycles = JudgeCycles(made.rig.graph, made.blocks);
  return {fleet::Assess(EdgesOf(made.rig.graph), solution).level == VerdictLevel::kFail, solution.cycles.failing > 0};
}

struct Verdicts {
  double fails = 0.0, loops_fail = 0.0;  // shares of graphs
};

Verdicts MeasureVerdicts(int count, int seeds, const Information& information) {
  int fails = 0, loops_fail = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    std::mt19937 random(static_cast<unsigned>(700000 + 1000 * count + seed));
    FaultGraph made = MakeFaultGraph(random, information);
    (void)SpoilEdges(made.rig, static_cast<std::size_t>(count), random);
    const Judgement judgement = Judge(made);
    fails += judgement.fails ? 1 : 0;
    loops_fail += judgement.loop_fails ? 1 : 0;
  }
  return {Share(fails, seeds), Share(loops_fail, seeds)};
}

constexpr int kSeeds = 300;

void PrintEstimated(const std::string& name, const Information& information) {
  Faults faults;
  for (const int count : {1, 4, 7, 10}) Add(faults, MeasureIndependent(count, kSeeds, information));
  const Faults none = MeasureIndependent(0, kSeeds, information);
  const auto print = [&](const char* figure, double value) {
    std::printf(", \"%s_%d_%s\": %.6f", name.c_str(), information.blocks, figure, value);
  };
  print("recall", Share(faults.found, faults.bad));
  print("false_alarms", Share(faults.false_alarms, faults.good));
  print("false_alarms_without_faults", Share(none.false_alarms, none.good));
  print("rms_ratio", std::sqrt(faults.squared / faults.squared_oracle));
  const Verdicts one = MeasureVerdicts(1, kSeeds, information), zero = MeasureVerdicts(0, kSeeds, information);
  print("verdict_of_one", one.fails);
  print("loops_of_one", one.loops_fail);
  print("verdict_of_none", zero.fails);
  print("loops_of_none", zero.loops_fail);
}

void Run() {
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
      "\"two_poses\": %.6f",
      10 * kSeeds, static_cast<double>(independent.found) / independent.bad,
      static_cast<double>(independent.false_alarms) / independent.good,
      std::sqrt(independent.squared / independent.squared_oracle), worst_rms_ratio,
      static_cast<double>(none.false_alarms) / none.good, static_cast<double>(consistent.found) / consistent.bad,
      static_cast<double>(consistent.false_alarms) / consistent.good, MeasureTwoPoses(kSeeds));
  for (const int blocks : {13, 20, 40}) {
    PrintEstimated("sessions", {Source::kSessions, blocks});
    PrintEstimated("scatter", {Source::kScatter, blocks});
    PrintEstimated("rig", {Source::kRig, blocks});
  }
  std::printf("}\n");
}

}  // namespace
}  // namespace rigcal::graph

int main() {
  rigcal::graph::Run();
  return 0;
}
