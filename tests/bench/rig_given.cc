#include <algorithm>
#include <cmath>

#include "tests/bench/rig_coverage.h"

namespace rigcal {
namespace {

constexpr std::size_t kLidarCaptures = 4;
constexpr double kBoardRatio = 1.001, kBias_m = 0.005;

// Squared errors and variances of all sensors, all axes of one unit together.
struct GivenScore {
  double error_m2 = 0, sigma_m2 = 0, error_rad2 = 0, sigma_rad2 = 0, worst = 0;
  int failed = 0, unknown = 0;

  void Add(const RigCase& rig) {
    failed += CountFailed(rig.edges);
    for (const SensorPose& pose : rig.solution.poses) {
      if (pose.sensor == rig.session.header.reference) continue;
      if (!pose.known) {
        ++unknown;
        continue;
      }
      const Vector6d error = PoseError(rig, pose);
      error_m2 += error.head<3>().squaredNorm(), error_rad2 += error.tail<3>().squaredNorm();
      sigma_m2 += pose.covariance.topLeftCorner(3, 3).trace();
      sigma_rad2 += pose.covariance.bottomRightCorner(3, 3).trace();
      worst = std::max(worst, WorstAxis(error, pose.covariance));
    }
  }
  void Print(const char* name, const char* comma) const {
    std::printf(
        "%s\n  \"%s\": {\"worst_sigmas\": %.3f, \"sigma_over_error\": %.3f, \"sigma_over_error_turned\": %.3f, "
        "\"failed_edges\": %d, \"unknown\": %d}",
        comma, name, worst, std::sqrt(sigma_m2 / error_m2), std::sqrt(sigma_rad2 / error_rad2), failed, unknown);
    std::fflush(stdout);
  }
};

}  // namespace

void PrintGiven(int seeds) {
  GivenScore boards, beams, both;
  for (int seed = 1; seed <= seeds; ++seed) {
    sim::Options options;
    options.seed = static_cast<std::uint64_t>(seed);
    options.board_scale_ratio = seed % 2 == 0 ? kBoardRatio : 2 - kBoardRatio;
    boards.Add(Calibrated(RecordFeatures(MarsMapper(options), kLidarCaptures)));
    options.lidar_bias_sigma_m = kBias_m;
    both.Add(Calibrated(RecordFeatures(MarsMapper(options), kLidarCaptures)));
    options.board_scale_ratio = 1;
    beams.Add(Calibrated(RecordFeatures(MarsMapper(options), kLidarCaptures)));
  }
  std::printf("\"given\": {");
  boards.Print("boards_0.1_percent_off", "");
  beams.Print("beams_5_mm_off", ",");
  both.Print("both", ",");
  std::printf("}");
}

}  // namespace rigcal
