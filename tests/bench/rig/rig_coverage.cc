#include "tests/bench/rig/rig_coverage.h"

#include <algorithm>

#include "server/formats/json/json_writer.h"
#include "server/math/statistics.h"

namespace rigcal {
namespace {

constexpr std::size_t kLidarCaptures = 40;

// 95 % region of a covariance with so many degrees of freedom behind it; few: nothing lies outside.
double RegionLimit(double dof) {
  return dof > 0 ? HotellingLimit(static_cast<int>(dof + 1e-6) + 1) : ChiSquareQuantile(0.95, 6);
}

struct Coverage {
  int count = 0, covered = 0;
  double sum_t2 = 0, worst = 0;

  void Add(const Vector6d& error, const Matrix6d& covariance, double limit) {
    const double t2 = error.dot(covariance.ldlt().solve(error));
    ++count;
    covered += t2 <= limit;
    sum_t2 += t2;
    worst = std::max(worst, WorstAxis(error, covariance));
  }
};

void Print(const std::map<std::string, Coverage>& coverages) {
  const char* comma = "";
  for (const auto& [name, c] : coverages) {
    std::printf("%s\n  \"%s\": {\"count\": %d, \"covered_ratio\": %.4f, \"mean_t2\": %.3f, \"worst_sigmas\": %.3f}",
                comma, name.c_str(), c.count, static_cast<double>(c.covered) / c.count, c.sum_t2 / c.count, c.worst);
    comma = ",";
  }
}

void AddSensors(const RigCase& rig, std::map<std::string, Coverage>& sensors) {
  for (const SensorPose& pose : rig.solution.poses) {
    if (pose.sensor == rig.session.header.reference || !pose.known) continue;
    sensors[pose.sensor.str()].Add(PoseError(rig, pose), pose.covariance, RegionLimit(pose.dof));
  }
}

void AddEdges(const RigCase& rig, std::map<std::string, Coverage>& methods) {
  for (const Edge& edge : rig.edges) {
    if (edge.state != EdgeState::kGood || edge.uncertainty.rank < 6) continue;
    methods[edge.method].Add(EdgeError(rig, edge), edge.uncertainty.covariance, RegionLimit(edge.uncertainty.dof));
  }
}

// One sentence per edge that failed.
void AddFailures(int seed, const std::vector<Edge>& edges, std::vector<std::string>& failures) {
  for (const Edge& edge : edges)
    if (edge.state != EdgeState::kGood)
      failures.push_back("seed " + std::to_string(seed) + ": " +
                         (edge.diagnoses.empty() ? "no reason" : edge.diagnoses.front().what));
}

void Print(const std::vector<std::string>& sentences) {
  formats::JsonWriter out;
  out.List([&] {
    for (const std::string& sentence : sentences) out.Text(sentence);
  });
  std::printf("%s", out.Finish().c_str());
}

}  // namespace

void PrintCoverage(int seeds, int first) {
  std::map<std::string, Coverage> sensors, methods;
  std::vector<std::string> failures;
  for (int seed = first; seed < first + seeds; ++seed) {
    sim::Options options;
    options.seed = static_cast<std::uint64_t>(seed);
    const RigCase rig = Calibrated(RecordFeatures(MarsMapper(options), kLidarCaptures));
    AddFailures(seed, rig.edges, failures);
    AddSensors(rig, sensors);
    AddEdges(rig, methods);
  }
  std::printf("\"coverage\": {\"seeds\": %d, \"failed_edges\": %zu, \"failures\": ", seeds, failures.size());
  Print(failures);
  std::printf(", \"sensors\": {");
  Print(sensors);
  std::printf("},\n\"methods\": {");
  Print(methods);
  std::printf("}}");
}

}  // namespace rigcal
