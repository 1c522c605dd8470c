// graph_bench --g2o FILE | --synthetic VERTICES EDGES [--mode batch|marginals|incremental] [--order file|shuffled]
//             [--seed S] [--repeat N] [--reference ceres]; --mode remove|honest|insight too
// One JSON object: how long the graph engine takes, what it finds, in g2o's own cost too, and a digest of the poses.
// Marginals are timed at the solution, updates one by one; so are removals, each edge being put back before the next.
#include <sys/resource.h>
#include <time.h>  // NOLINT(modernize-deprecated-headers): clock_gettime is POSIX

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstring>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>

#include "server/base/digests/sha256.h"
#include "server/base/files/durable_file.h"
#include "server/base/limits.h"
#include "server/formats/edges/g2o.h"
#include "server/graph/insight/insight.h"
#include "server/graph/live/live_solver.h"
#include "server/graph/solve/solve.h"
#include "tests/bench/graph/graph_reference.h"

namespace {

using namespace rigcal;  // NOLINT(google-build-using-namespace): a program of one file

struct Arguments {
  std::string g2o, mode = "batch", order = "file", reference;
  std::vector<std::size_t> synthetic;  // vertices, edges
  unsigned seed = 1;
  int repeat = 0;
};

double Now_us() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double, std::micro>(now).count();
}

// g2o's error is (t, vec(q)) of Z^-1 X_i^-1 X_j, q with w >= 0, under the information matrix as in the file.
double CostOfG2o(const Graph& graph, const GraphSolution& solution) {
  std::map<SensorId, Se3> T_ref;
  for (const SensorPose& pose : solution.poses)
    if (pose.known) T_ref.emplace(pose.sensor, pose.T_ref_sensor);
  double cost = 0.0;
  for (const GraphEdge& edge : graph.edges) {
    if (!T_ref.contains(edge.frame_a) || !T_ref.contains(edge.frame_b)) continue;
    const Se3 error = (edge.T_a_b.Inverse() * T_ref[edge.frame_a].Inverse() * T_ref[edge.frame_b]).Normalized();
    Vector6d e;
    e << error.p_m, error.q.vec();
    cost += e.dot(formats::InformationToG2o(edge.Omega) * e);
  }
  return cost;
}

std::string DigestOf(const GraphSolution& solution) {
  std::string bytes;
  for (const SensorPose& pose : solution.poses) {
    const std::array<double, 7> numbers = {
        pose.T_ref_sensor.p_m.x(), pose.T_ref_sensor.p_m.y(), pose.T_ref_sensor.p_m.z(), pose.T_ref_sensor.q.x(),
        pose.T_ref_sensor.q.y(),   pose.T_ref_sensor.q.z(),   pose.T_ref_sensor.q.w()};
    bytes.append(pose.sensor.str());
    bytes.append(std::string_view(reinterpret_cast<const char*>(numbers.data()), sizeof numbers));
  }
  return Sha256Of(std::string_view(bytes)).str();
}

// Of this thread: what a run costs however busy the machine is.
double Cpu_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

struct Run {
  std::vector<double> times_us, cpu_times_us;
  GraphSolution solution;
  int batches = 0;  // updates that were solved from the ground up
  int steps = 0;    // of all updates
  double products = 0.0, rest_ratio_max = 0.0;
  double settle_us = 0.0, cost_before_settling = 0.0;  // of large graphs, after the last update

  template <typename Body>
  void Time(const Body& body) {
    const double begin_us = Now_us(), cpu_begin_us = Cpu_us();
    body();
    times_us.push_back(Now_us() - begin_us);
    cpu_times_us.push_back(Cpu_us() - cpu_begin_us);
  }
  template <typename Update>
  void TimeUpdate(const Update& update) {
    graph::UpdateWork work;
    Time([&] { work = update(); });
    batches += work.batch ? 1 : 0;
    steps += work.iterations;
    products += work.products;
    rest_ratio_max = std::max(rest_ratio_max, work.rest_ratio);
  }
};

Run RunBatch(const Graph& graph, const Arguments& arguments) {
  graph::SolveOptions options;
  options.marginals = false;
  Run run;
  const double start_us = Now_us();
  const auto enough = [&] {
    if (arguments.repeat > 0) return static_cast<int>(run.times_us.size()) >= arguments.repeat;
    return run.times_us.size() >= 3 && (run.times_us.size() >= 1000 || Now_us() - start_us > 2e6);
  };
  while (!enough()) {
    run.Time([&] { run.solution = graph::Solve(graph, options); });
  }
  return run;
}

void Finish(graph::LiveSolver& live, Run& run) {
  run.cost_before_settling = live.Snapshot().cost;
  const double begin_us = Now_us();
  if (!live.settled()) live.Settle();
  run.settle_us = Now_us() - begin_us;
  graph::SolveOptions options;
  options.marginals = false;
  run.solution = graph::Solve(live.graph(), options);
  run.solution.cost = live.Snapshot().cost;  // of the live poses as they are, not of the solution made from them
  for (SensorPose& pose : run.solution.poses)
    if (const std::optional<Se3> T = live.PoseOf(pose.sensor)) pose.T_ref_sensor = *T;
}

// Every edge by itself, each update from the state before it; sensors appear with their first edge.
Run RunIncremental(const Graph& graph) {
  Run run;
  graph::LiveSolver live(graph.reference);
  for (const GraphEdge& edge : graph.edges) run.TimeUpdate([&] { return live.Add(edge); });
  Finish(live, run);
  return run;
}

// Up to 300 edges of the whole graph, spread over it: out, and in again.
Run RunRemovals(const Graph& graph) {
  Run run;
  graph::LiveSolver live(graph);
  const std::size_t stride = std::max<std::size_t>(graph.edges.size() / 300, 1);
  for (std::size_t k = 0; k < graph.edges.size(); k += stride) {
    run.TimeUpdate([&] { return live.Remove(graph.edges[k].id); });
    live.Add(graph.edges[k]);
  }
  Finish(live, run);
  return run;
}

// All marginals at the solution, which is there already.
Run RunMarginals(const Graph& graph, const Arguments& arguments) {
  Run run;
  graph::LiveSolver live(graph);
  run.solution = graph::Solve(graph);
  const double start_us = Now_us();
  const auto enough = [&] {
    if (arguments.repeat > 0) return static_cast<int>(run.times_us.size()) >= arguments.repeat;
    return run.times_us.size() >= 3 && (run.times_us.size() >= 1000 || Now_us() - start_us > 2e6);
  };
  std::size_t count = 0;
  while (!enough()) run.Time([&] { count = live.Marginals().size(); });
  if (count == 0) run.solution.converged = false;
  return run;
}

// What a revision takes beside its solution: who is suspect (without insight), and what else it rests on (with it).
Run RunBeside(const Graph& graph, const Arguments& arguments, bool insight) {
  Run run;
  run.solution = graph::Solve(graph);
  const double start_us = Now_us();
  const auto enough = [&] {
    if (arguments.repeat > 0) return static_cast<int>(run.times_us.size()) >= arguments.repeat;
    return run.times_us.size() >= 3 && (run.times_us.size() >= 1000 || Now_us() - start_us > 2e6);
  };
  while (!enough())
    run.Time([&] {
      if (!insight) {
        run.solution.suspects = graph::FindSuspects(graph, graph::Solve(graph));
        return;
      }
      run.solution.influences = graph::InfluenceOfEdges(graph, run.solution);
      run.solution.cycles = graph::JudgeCycles(graph, {});
    });
  return run;
}

double PeakRss_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

nlohmann::json Summary(const Graph& graph, Run run) {
  const double total_us = std::accumulate(run.times_us.begin(), run.times_us.end(), run.settle_us);
  std::sort(run.times_us.begin(), run.times_us.end());
  std::sort(run.cpu_times_us.begin(), run.cpu_times_us.end());
  const auto last = run.times_us.size() - 1;
  return {{"median_us", run.times_us[last / 2]},
          {"p99_us", run.times_us[last * 99 / 100]},
          {"max_us", run.times_us[last]},
          {"min_us", run.times_us[0]},
          {"batches", run.batches},
          {"steps", run.steps},
          {"products", run.products},
          {"rest_ratio_max", run.rest_ratio_max},
          {"cpu_median_us", run.cpu_times_us[last / 2]},
          {"total_ms", total_us / 1e3},
          {"settle_ms", run.settle_us / 1e3},
          {"cost_before_settling", run.cost_before_settling},
          {"runs", run.times_us.size()},
          {"iterations", run.solution.iterations},
          {"converged", run.solution.converged},
          {"cost", run.solution.cost},
          {"cost_g2o", CostOfG2o(graph, run.solution)},
          {"dof", run.solution.dof},
          {"peak_rss_mb", PeakRss_mb()},
          {"vertices", graph.sensors.size()},
          {"edges", graph.edges.size()},
          {"digest", DigestOf(run.solution)}};
}

Run RunOf(const Graph& graph, const Arguments& arguments) {
  if (arguments.mode == "incremental") return RunIncremental(graph);
  if (arguments.mode == "remove") return RunRemovals(graph);
  if (arguments.mode == "honest" || arguments.mode == "insight")
    return RunBeside(graph, arguments, arguments.mode == "insight");
  return arguments.mode == "marginals" ? RunMarginals(graph, arguments) : RunBatch(graph, arguments);
}

Result<std::vector<Edge>> EdgesOf(const Arguments& arguments, SensorId& fixed) {
  if (!arguments.synthetic.empty())
    return bench::RandomEdges(arguments.synthetic[0], arguments.synthetic[1], arguments.seed);
  RIGCAL_ASSIGN(const std::string text, ReadFile(arguments.g2o, limits::kG2oFileBytesMax));
  RIGCAL_ASSIGN(formats::G2oFile file, formats::ReadG2o(text, RobotId("bench")));
  fixed = file.fixed;
  return std::move(file.edges);
}

int Measure(const Arguments& arguments) {
  SensorId fixed;
  const double begin_us = Now_us();
  Result<std::vector<Edge>> edges = EdgesOf(arguments, fixed);
  const double read_ms = (Now_us() - begin_us) / 1e3;
  if (!edges) return std::cerr << Sentence(edges.error()) << '\n', 4;
  if (arguments.order == "shuffled") {
    std::mt19937 random(arguments.seed);
    std::shuffle(edges->begin(), edges->end(), random);
  }
  const Graph graph = graph::GraphOf(*edges, fixed);
  nlohmann::json summary = Summary(graph, RunOf(graph, arguments));
  summary["read_ms"] = read_ms;
  if (arguments.reference == "ceres") summary["ceres"] = bench::SolveWithCeres(graph);
  std::cout << summary.dump() << '\n';
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Times the graph engine on a .g2o file");
  app.add_option("--g2o", arguments.g2o, "The file");
  app.add_option("--mode", arguments.mode)
      ->check(CLI::IsMember({"batch", "marginals", "incremental", "remove", "honest", "insight"}));
  app.add_option("--order", arguments.order)->check(CLI::IsMember({"file", "shuffled"}));
  app.add_option("--synthetic", arguments.synthetic, "VERTICES EDGES: a random graph instead (5 mm, 0.3 deg)")
      ->expected(2);
  app.add_option("--reference", arguments.reference, "Solve it with Ceres too, in the same run")
      ->check(CLI::IsMember({"ceres"}));
  app.add_option("--seed", arguments.seed, "Of the shuffling and the random graph");
  app.add_option("--repeat", arguments.repeat, "Solves to time (default: two seconds' worth, 3 to 1000)");
  CLI11_PARSE(app, argc, argv);
  const bool sensible = arguments.synthetic.empty() ||
                        (arguments.synthetic[0] >= 2 && arguments.synthetic[0] <= 100000 &&
                         arguments.synthetic[1] + 1 >= arguments.synthetic[0] && arguments.synthetic[1] <= 1000000);
  if (arguments.g2o.empty() == arguments.synthetic.empty() || !sensible)
    return std::cerr
               << "graph_bench: give --g2o FILE, or --synthetic VERTICES EDGES with at least VERTICES - 1 edges\n",
           2;
  return Measure(arguments);
}
