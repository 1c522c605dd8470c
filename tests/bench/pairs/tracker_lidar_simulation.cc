// Measures tracker-lidar calibration against known truth: tracker_lidar_simulation SEEDS prints one JSON object. Plates
// in an empty room against the Cramer-Rao bound, motion that tells little, and the virtual MARS Mapper's two lidars.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "client/sim/bound.h"
#include "client/sim/rig/rig_yaml.h"
#include "server/math/statistics.h"
#include "tests/bench/rig/rig_edges.h"
#include "tests/unit/calib/virtual_planes.h"

namespace rigcal::calib {
namespace {

constexpr double kDegree = M_PI / 180;
constexpr PoseNoise kTracker{0.0002, 0.05 * kDegree};

VirtualPlates Noisy() {
  VirtualPlates plates = FourPlates();
  plates.range_sigma_m = 0.02;
  plates.tracker = kTracker;
  return plates;
}

struct Statistics {
  int count = 0, failed = 0, covered = 0;
  double sum_m2 = 0, sum_rad2 = 0, bound_m2 = 0, bound_rad2 = 0, squares = 0, model_squares = 0, worst = 0;

  // `error` Log(T^-1 T_true).
  void Add(const Vector6d& error, const Uncertainty& uncertainty) {
    ++count;
    sum_m2 += error.head<3>().squaredNorm();
    sum_rad2 += error.tail<3>().squaredNorm();
    const double square = error.dot(uncertainty.Omega * error);
    squares += square;
    covered += square <= HotellingLimit(uncertainty.dof + 1) ? 1 : 0;
    for (int i = 0; i < 6; ++i) worst = std::max(worst, std::abs(error[i]) / std::sqrt(uncertainty.covariance(i, i)));
  }
  void AddBound(const Matrix6d& bound) {
    bound_m2 += bound.topLeftCorner<3, 3>().trace();
    bound_rad2 += bound.bottomRightCorner<3, 3>().trace();
  }
  void Print(const char* name) const {
    const double good = std::max(1, count);
    std::printf(
        "\"%s\": {\"count\": %d, \"failed\": %d, \"rms_mm\": %.4f, \"rms_deg\": %.5f, \"bound_mm\": %.4f, "
        "\"bound_deg\": "
        "%.5f, \"mean_square\": %.3f, \"model_mean_square\": %.3f, \"covered_ratio\": %.3f, \"worst_sigmas\": %.2f}, ",
        name, count, failed, 1e3 * std::sqrt(sum_m2 / good), std::sqrt(sum_rad2 / good) / kDegree,
        1e3 * std::sqrt(bound_m2 / good), std::sqrt(bound_rad2 / good) / kDegree, squares / (6 * good),
        model_squares / (6 * good), covered / good, worst);
  }
};

void General(int seeds) {
  Statistics statistics;
  double exact_m = 0, seconds = 0;
  for (int i = 0; i < seeds; ++i) {
    const auto seed = static_cast<unsigned>(i);
    const VirtualBody body = Driven(Drive::kFree, 40, 0.3, seed);
    const auto exact = EstimateTrackerLidar(Scanned(body, FourPlates(), seed));
    if (exact) exact_m = std::max(exact_m, (body.X.Inverse() * exact->estimate.T_body_lidar).Log().norm());
    const TrackerLidarProblem problem = Scanned(body, Noisy(), seed + 100);
    const auto start = std::chrono::steady_clock::now();
    const auto result = EstimateTrackerLidar(problem);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!exact || !result || result->uncertainty.rank < 6) {
      ++statistics.failed;
      continue;
    }
    const Vector6d error = (result->estimate.T_body_lidar.Inverse() * body.X).Log();
    statistics.Add(error, result->uncertainty);
    statistics.model_squares += error.dot(result->estimate.information * error);
    statistics.AddBound(BoundOf(body, Noisy()));
  }
  statistics.Print("general");
  std::printf("\"exact_error\": %.3g, \"pair_ms\": %.1f, ", exact_m, 1e3 * seconds / seeds);
}

// Little tilt: what is claimed must hold, and the axis be named.
void WeakMotion(const char* name, Drive drive, int seeds) {
  std::printf("\"%s\": [", name);
  const char* comma = "";
  for (const double ratio : {0.0, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0}) {
    double worst = 0, worst_axis = 0, axis_deg = 0;
    int ranks[7] = {0, 0, 0, 0, 0, 0, 0}, failed = 0;
    for (int seed = 0; seed < seeds; ++seed) {
      const VirtualBody body = Driven(drive, 40, ratio * kTracker.rotation_rad, 100 + static_cast<unsigned>(seed));
      const auto result = EstimateTrackerLidar(Scanned(body, Noisy(), 900 + static_cast<unsigned>(seed)));
      if (!result) {
        ++failed;
        continue;
      }
      ++ranks[result->uncertainty.rank];
      worst = std::max(worst, WorstSigmas(body.X, result->estimate.T_body_lidar, result->uncertainty));
      const Vector6d error = (result->estimate.T_body_lidar.Inverse() * body.X).Log();
      for (int axis = 0; axis < 6; ++axis)
        if (const AxisSigma sigma = SigmaOf(result->uncertainty, axis); sigma.known)
          worst_axis = std::max(worst_axis, std::abs(error[axis]) / sigma.value);
      for (const Eigen::Vector3d& axis : AxesOf(result->estimate.reach, result->estimate.T_body_lidar).positions)
        axis_deg = std::max(axis_deg, std::acos(std::min(1.0, std::abs(axis.z()))) / kDegree);
    }
    std::printf(
        "%s{\"ratio\": %.1f, \"worst_sigmas\": %.3f, \"worst_axis_sigmas\": %.3f, \"axis_deg\": %.3f, \"rank4\": %d, "
        "\"rank5\": %d, \"rank6\": %d, "
        "\"failed\": %d}",
        comma, ratio, worst, worst_axis, axis_deg, ranks[4], ranks[5], ranks[6], failed);
    comma = ", ";
  }
  std::printf("], ");
}

// Without a drawing, people and trolleys among the boards.
void AllRound(int seeds) {
  int good = 0;
  double worst = 0, seconds = 0;
  for (int i = 0; i < seeds; ++i) {
    const auto seed = static_cast<unsigned>(i);
    VirtualPlates plates = Noisy();
    plates.nominal = false;
    plates.decoys = true;
    const VirtualBody body = Driven(Drive::kFree, 40, 0.3, seed + 40);
    const TrackerLidarProblem problem = Scanned(body, plates, seed + 300);
    const auto start = std::chrono::steady_clock::now();
    const auto result = EstimateTrackerLidar(problem);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!result) continue;
    ++good;
    worst = std::max(worst, WorstSigmas(body.X, result->estimate.T_body_lidar, result->uncertainty));
  }
  std::printf("\"without_nominal\": {\"count\": %d, \"good\": %d, \"worst_sigmas\": %.3f, \"pair_ms\": %.1f}, ", seeds,
              good, worst, 1e3 * seconds / seeds);
}

}  // namespace

void Plates(int seeds) {
  General(seeds);
  WeakMotion("planar", Drive::kFloor, seeds);
  WeakMotion("on_the_spot", Drive::kOnTheSpot, seeds);
  AllRound(std::max(1, seeds / 4));
}

}  // namespace rigcal::calib

namespace rigcal::sim {
namespace {

// The MARS Mapper with one lidar and the body alone, without the pairs that it leaves out.
Rig WithOnly(Rig rig, const SensorId& lidar) {
  std::erase_if(rig.sensors,
                [&](const RigSensor& sensor) { return sensor.id != lidar && sensor.kind != SensorKind::kTracker; });
  rig.reference = lidar;
  rig.skip_pairs.clear();
  return rig;
}

void Visits(const Rig& whole, const SensorId& lidar, int seeds) {
  calib::Statistics statistics;
  const Rig rig = WithOnly(whole, lidar);
  for (int i = 0; i < seeds; ++i) {
    Options options;
    options.seed = static_cast<std::uint64_t>(i + 1);
    const auto experiment = Prepare(rig, options);
    if (!experiment) continue;
    const Edge edge = RigEdges(*experiment, Observe(*experiment)).front();
    const auto bound = CramerRaoCovariance(*experiment, edge.frame_b);
    if (edge.state != EdgeState::kGood || edge.uncertainty.rank < 6 || !bound) {
      ++statistics.failed;
      continue;
    }
    statistics.Add(EdgeError(*experiment, edge), edge.uncertainty);
    statistics.AddBound(*bound);
  }
  statistics.Print(lidar.str().c_str());
}

void MarsMapper(int seeds) {
  const auto rig = LoadRig("mars-mapper");
  if (!rig) return;
  for (const RigSensor& sensor : rig->sensors)
    if (sensor.kind == SensorKind::kLidar) Visits(*rig, sensor.id, seeds);
}

}  // namespace
}  // namespace rigcal::sim

int main(int argc, char** argv) {
  const bool only_visits = argc == 3 && std::string(argv[1]) == "--visits";
  const int seeds = argc == 2 || only_visits ? std::atoi(argv[argc - 1]) : 0;
  if (seeds < 1) {
    std::fprintf(stderr, "usage: tracker_lidar_simulation [--visits] SEEDS\n");
    return 2;
  }
  const auto start = std::chrono::steady_clock::now();
  std::printf("{");
  if (!only_visits) rigcal::calib::Plates(seeds);
  rigcal::sim::MarsMapper(seeds);
  std::printf("\"seconds\": %.1f}\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return 0;
}
