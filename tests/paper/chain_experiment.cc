#include "tests/paper/chain_experiment.h"

#include <algorithm>
#include <cmath>

#include "tests/paper/paths.h"

namespace rigcal::paper {
namespace {

using Eigen::MatrixXd;

// Round the robot from neighbour to neighbour, or through a sensor that sees what both see.
const std::vector<std::vector<const char*>> kRoutes = {
    {"front_left", "left_front", "left_back", "back"},    {"left_front", "front_left", "front_right", "right_front"},
    {"up_left", "left_front", "left_back", "back"},       {"front_left", "left_front", "lidar_vertical"},
    {"lidar_vertical", "left_front", "lidar_horizontal"}, {"front_left", "right_front", "right_back", "body"},
};

// One visit, solved, with what is known of how its edges err.
struct SolvedVisit {
  const sim::Experiment& experiment;
  std::vector<Edge> edges;
  Graph graph;
  GraphSolution solution;
  MatrixXd columns, gain;

  explicit SolvedVisit(const Visit& visit)
      : experiment(visit.experiment),
        edges(GoodEdges(visit)),
        graph(graph::GraphOf(edges, visit.experiment.rig.reference)),
        solution(graph::Solve(graph)),
        columns(ErrorColumns(edges)) {
    std::vector<Se3> truth;
    for (const SensorId& sensor : graph.sensors) truth.push_back(experiment.T_ref_sensor(sensor));
    gain = LinearGraph(graph, truth).Gain(WeightsOf(graph));
  }

  [[nodiscard]] std::size_t IndexOf(const SensorId& sensor) const {
    return static_cast<std::size_t>(std::find(graph.sensors.begin(), graph.sensors.end(), sensor) -
                                    graph.sensors.begin());
  }

  [[nodiscard]] Se3 T_ref(const SensorId& sensor) const { return solution.poses[IndexOf(sensor)].T_ref_sensor; }

  // Errors of the sensor's pose, by those of the edges.
  [[nodiscard]] MatrixXd PoseErrors(const SensorId& sensor) const {
    if (sensor == graph.reference) return MatrixXd::Zero(6, gain.cols());
    const std::size_t index = IndexOf(sensor), before = index < IndexOf(graph.reference) ? index : index - 1;
    return gain.middleRows(6 * static_cast<Eigen::Index>(before), 6);
  }

  [[nodiscard]] MatrixXd RelativeErrors(const SensorId& a, const SensorId& b) const {
    return PoseErrors(b) - Adjoint(TruthOf(experiment, b, a)) * PoseErrors(a);
  }
};

// Errors of one visit: the pose that each way gives, and the columns that say what it errs by.
struct WayResult {
  Vector6d e;
  MatrixXd columns;
};

struct RouteResults {
  std::string direct_method;
  std::array<WayResult, kWays> ways;
};

std::optional<RouteResults> ResultsOf(const SolvedVisit& visit, const Route& route) {
  const SensorId &a = route.sensors.front(), &b = route.sensors.back();
  const auto chain = FindPath(visit.edges, route.sensors), direct = FindPath(visit.edges, {a, b});
  if (!chain || !direct) return std::nullopt;
  const auto error = [&](const Se3& T) { return Vector6d((TruthOf(visit.experiment, a, b).Inverse() * T).Log()); };
  return RouteResults{
      visit.edges[direct->front().edge].method,
      {{{error(Compose(visit.edges, *chain)), ErrorMap(visit.edges, *chain) * visit.columns},
        {error(Compose(visit.edges, *direct)), ErrorMap(visit.edges, *direct) * visit.columns},
        {error(visit.T_ref(a).Inverse() * visit.T_ref(b)), visit.RelativeErrors(a, b) * visit.columns}}}};
}

// Grows by one visit: what is predicted of the sum over the routes.
struct SumOfVisit {
  MatrixXd translation, rotation;  // columns below one another

  void Add(const MatrixXd& columns) {
    const Eigen::Index rows = translation.rows();
    translation.conservativeResize(rows + 3, columns.cols());
    rotation.conservativeResize(rows + 3, columns.cols());
    translation.bottomRows(3) = columns.topRows(3);
    rotation.bottomRows(3) = columns.bottomRows(3);
  }
};

void AddToSum(const MatrixXd& columns, double known_dof, double& predicted, double& variance) {
  const Spread spread = SpreadOf(columns);
  predicted += spread.mean;
  variance += spread.mean * spread.mean * 2 / spread.dof * (1 + 1 / known_dof);
}

// Sums of squares and their variances, over visits.
struct Totals {
  double error_m2 = 0, error_rad2 = 0, predicted_m2 = 0, predicted_rad2 = 0, variance_m4 = 0, variance_rad4 = 0;
  double count = 0;
};

void AddVisit(const SolvedVisit& visit, std::vector<Route>& routes, std::array<Totals, kWays>& totals) {
  std::array<SumOfVisit, kWays> sums;
  for (Route& route : routes) {
    const auto results = ResultsOf(visit, route);
    if (!results) continue;
    route.direct_method = results->direct_method;
    for (std::size_t way = 0; way < kWays; ++way) {
      const WayResult& result = results->ways[way];
      WayErrors& errors = route.ways[way];
      errors.error_m.push_back(result.e.head<3>().norm());
      errors.error_rad.push_back(result.e.tail<3>().norm());
      errors.predicted_m2 += result.columns.topRows(3).squaredNorm();
      errors.predicted_rad2 += result.columns.bottomRows(3).squaredNorm();
      totals[way].error_m2 += result.e.head<3>().squaredNorm();
      totals[way].error_rad2 += result.e.tail<3>().squaredNorm();
      totals[way].count += 1;
      sums[way].Add(result.columns);
    }
  }
  const double known_dof = static_cast<double>(visit.experiment.captures.size()) - 1;
  for (std::size_t way = 0; way < kWays; ++way) {
    if (sums[way].translation.rows() == 0) continue;
    AddToSum(sums[way].translation, known_dof, totals[way].predicted_m2, totals[way].variance_m4);
    AddToSum(sums[way].rotation, known_dof, totals[way].predicted_rad2, totals[way].variance_rad4);
  }
}

WaySum SumOf(const Totals& totals) {
  const double count = std::max(1.0, totals.count);
  return {std::sqrt(totals.error_m2 / count),
          std::sqrt(totals.error_rad2 / count),
          std::sqrt(totals.predicted_m2 / count),
          std::sqrt(totals.predicted_rad2 / count),
          totals.variance_m4 / (totals.predicted_m2 * totals.predicted_m2),
          totals.variance_rad4 / (totals.predicted_rad2 * totals.predicted_rad2)};
}

}  // namespace

ChainExperiment RunChainExperiment(const std::vector<Visit>& visits) {
  ChainExperiment experiment;
  experiment.visits = visits.size();
  for (const auto& names : kRoutes) {
    Route route;
    for (const char* name : names) route.sensors.emplace_back(name);
    experiment.routes.push_back(std::move(route));
  }
  std::array<Totals, kWays> totals;
  for (const Visit& visit : visits) AddVisit(SolvedVisit(visit), experiment.routes, totals);
  for (Route& route : experiment.routes)
    for (WayErrors& errors : route.ways) {
      const double count = std::max<double>(1, static_cast<double>(errors.error_m.size()));
      errors.predicted_m2 /= count;
      errors.predicted_rad2 /= count;
    }
  for (std::size_t way = 0; way < kWays; ++way) experiment.sums[way] = SumOf(totals[way]);
  return experiment;
}

double Rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

}  // namespace rigcal::paper
