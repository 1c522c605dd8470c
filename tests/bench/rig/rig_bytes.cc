#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <ctime>

#include "client/sim/rig/random.h"
#include "server/base/digests/sha256.h"
#include "tests/bench/rig/rig_coverage.h"

namespace rigcal {
namespace {

constexpr std::size_t kRepeatedLidarCaptures = 4;

template <typename Matrix>
void Append(const Matrix& values, std::string& bytes) {
  const std::size_t at = bytes.size(), size = sizeof(double) * static_cast<std::size_t>(values.size());
  bytes.resize(at + size);
  std::memcpy(bytes.data() + at, values.data(), size);
}

// Every number of the edges and of the solved rig.
Digest DigestOf(const RigCase& rig) {
  std::string bytes;
  for (const Edge& edge : rig.edges) {
    bytes += ContentDigest(edge).str();
    for (const BlockVector& block : edge.uncertainty.blocks) bytes += block.block_id, Append(block.d, bytes);
    for (const Contribution& part : edge.uncertainty.contributions)
      for (const Vector6d& shift : part.shifts) bytes += part.name, Append(shift, bytes);
  }
  for (const SensorPose& pose : rig.solution.poses) {
    Append(pose.T_ref_sensor.p_m, bytes);
    Append(pose.T_ref_sensor.q.coeffs(), bytes);
    Append(pose.covariance, bytes);
  }
  return Sha256Of(bytes);
}

RigCase OnThreads(const FeatureSession& session, std::size_t threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  return Calibrated(session);
}

}  // namespace

void PrintSameBytes(int seeds) {
  int differ = 0, edges = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    sim::Options options;
    options.seed = static_cast<std::uint64_t>(seed);
    options.captures = 12;
    const FeatureSession session = RecordFeatures(MarsMapper(options), kRepeatedLidarCaptures);
    const RigCase one = OnThreads(session, 1), two = OnThreads(session, 2);
    differ += DigestOf(one) != DigestOf(two);
    edges += static_cast<int>(one.edges.size()) - CountFailed(one.edges);
  }
  std::printf("\"same_bytes\": {\"visits\": %d, \"good_edges\": %d, \"one_and_two_threads_differ\": %d}", seeds, edges,
              differ);
}

// All edges of a visit of full size, every capture and every firing, as a robot's visit has them: estimates, jackknives
// and given constants together, on two threads.
void PrintTime() {
  const sim::Experiment experiment = MarsMapper({});
  const FeatureSession session = RecordFeatures(experiment, experiment.captures.size(), 1);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 2);
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t processor_start = std::clock();
  const std::vector<Edge> edges = EdgesOf(session);
  const double processor_s = static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC;
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("\"time\": {\"edges\": %d, \"wall_s\": %.3f, \"processor_s\": %.3f}",
              static_cast<int>(edges.size()) - CountFailed(edges), wall_s, processor_s);
}

}  // namespace rigcal
