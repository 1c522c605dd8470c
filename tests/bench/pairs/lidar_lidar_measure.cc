// Measures the registration of two lidars on one pair of clouds:
//   lidar_lidar_measure CLOUD_A CLOUD_B ROLL_DEG PITCH_DEG YAW_DEG X_M Y_M Z_M [REPEATS]
// The six numbers are the nominal T_a_b. Prints one JSON object. Names of the sensors are "a" and "b".
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "server/calib/lidar_lidar/lidar_lidar.h"
#include "server/calib/lidar_lidar/lidar_lidar_work.h"
#include "server/formats/clouds/cloud.h"
#include "server/formats/sessions/payload_path.h"

namespace rigcal {
namespace {

using calib::LidarLidarProblem;

std::vector<Eigen::Vector3f> PointsIn(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  auto cloud = formats::ReadCloud(std::as_bytes(std::span(bytes)), formats::SuffixOf(path), path);
  if (cloud) return std::move(cloud->points_m);
  std::fprintf(stderr, "%s\n", Sentence(cloud.error()).c_str());
  std::exit(1);
}

Se3 PoseOf(char** numbers) {
  constexpr double kRad = M_PI / 180;
  Se3 T;
  T.q = Eigen::AngleAxisd(std::atof(numbers[2]) * kRad, Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(std::atof(numbers[1]) * kRad, Eigen::Vector3d::UnitY()) *
        Eigen::AngleAxisd(std::atof(numbers[0]) * kRad, Eigen::Vector3d::UnitX());
  T.p_m = {std::atof(numbers[3]), std::atof(numbers[4]), std::atof(numbers[5])};
  return T;
}

void Print(const char* name, const Se3& T) {
  std::printf("\"%s\": {\"t_m\": [%.6f, %.6f, %.6f], \"q_xyzw\": [%.9f, %.9f, %.9f, %.9f]}, ", name, T.p_m.x(),
              T.p_m.y(), T.p_m.z(), T.q.x(), T.q.y(), T.q.z(), T.q.w());
}

// NDT alone, from points in memory to the converged pose, on so many threads.
double NdtMedian_ms(const LidarLidarProblem& problem, std::size_t threads, int repeats, Se3& T_a_b, double& last_step) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  std::vector<double> times_ms;
  for (int i = 0; i < repeats; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const calib::LidarLidarWork work = calib::WorkOf(problem, {}, false);
    const calib::LidarLidarPose pose = calib::FitFrom(work, work.nominal, 0, calib::Directions(6, 0));
    const Se3& T = pose.ndt;
    times_ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    last_step = pose.last_step;
    T_a_b = work.a_is_map ? T : T.Inverse().Normalized();
  }
  std::sort(times_ms.begin(), times_ms.end());
  return times_ms[times_ms.size() / 2];
}

int Measure(char** argv, int repeats) {
  LidarLidarProblem problem;
  problem.lidar_a.id = SensorId("a");
  problem.lidar_b.id = SensorId("b");
  problem.captures.push_back({CaptureId("1"), PointsIn(argv[1]), PointsIn(argv[2]), {}});
  problem.T_a_b_nominal = PoseOf(argv + 3);
  Se3 one_thread, two_threads;
  double last_step = 0;
  const double one_ms = NdtMedian_ms(problem, 1, repeats, one_thread, last_step);
  const double two_ms = NdtMedian_ms(problem, 2, repeats, two_threads, last_step);
  const auto start = std::chrono::steady_clock::now();
  const Edge edge = calib::EstimateLidarLidarEdge(problem);
  const double edge_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  std::printf("{");
  Print("T_ndt_from_nominal", two_threads);
  Print("T_ndt", edge.T_a_b);
  problem.polish = true;
  const Edge polished = calib::EstimateLidarLidarEdge(problem);
  Print("T_polished", polished.T_a_b);
  std::printf("\"ndt_good\": %s, \"polished_good\": %s, ", edge.state == EdgeState::kGood ? "true" : "false",
              polished.state == EdgeState::kGood ? "true" : "false");
  for (const auto& [name, value] : edge.figures) std::printf("\"%s\": %.9g, ", name.c_str(), value);
  std::printf("\"sigma\": [");
  for (int axis = 0; axis < 6; ++axis)
    std::printf("%s%.6g", axis == 0 ? "" : ", ", std::sqrt(edge.uncertainty.covariance(axis, axis)));
  const bool same = one_thread.p_m == two_threads.p_m && one_thread.q.coeffs() == two_threads.q.coeffs();
  std::printf("], \"rank\": %d, \"why\": \"%s\", \"same_bits\": %s, ", edge.uncertainty.rank,
              edge.diagnoses.empty() ? "" : edge.diagnoses.front().code.c_str(), same ? "true" : "false");
  std::printf("\"ndt_last_step\": %.3e, \"ndt_ms\": %.2f, \"ndt_one_thread_ms\": %.2f, \"edge_ms\": %.1f}\n", last_step,
              two_ms, one_ms, edge_ms);
  return edge.state == EdgeState::kGood ? 0 : 1;
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  if (argc != 9 && argc != 10) {
    std::fprintf(stderr,
                 "usage: lidar_lidar_measure CLOUD_A CLOUD_B ROLL_DEG PITCH_DEG YAW_DEG X_M Y_M Z_M [REPEATS]\n");
    return 2;
  }
  return rigcal::Measure(argv, argc == 10 ? std::max(1, std::atoi(argv[9])) : 9);
}
