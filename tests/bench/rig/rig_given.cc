#include <algorithm>
#include <cmath>

#include "tests/bench/rig/rig_coverage.h"

namespace rigcal {
namespace {

constexpr std::size_t kGivenLidarCaptures = 4, kGivenLidarPairCaptures = 40;
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

// Squared error of the two lidars' own edge over what it claims, mean over its directions: as it is, and as it would be
// without the constants of single beams.
struct BeamScore {
  double squares = 0, squares_without = 0, worst = 0, worst_without = 0;
  int failed = 0, edges = 0;

  void Add(const FeatureSession& session, const Edge& edge) {
    if (edge.state != EdgeState::kGood) {
      ++failed;
      return;
    }
    const sim::Experiment& truth = session.experiment;
    const Se3 T_a_b = truth.T_ref_sensor(edge.frame_a).Inverse() * truth.T_ref_sensor(edge.frame_b);
    const Vector6d error = (edge.T_a_b.Inverse() * T_a_b).Log();
    Matrix6d without = edge.uncertainty.covariance;
    for (const Contribution& part : edge.uncertainty.contributions)
      if (part.name.find("single beams") != std::string::npos) without -= part.covariance;
    squares += error.dot(edge.uncertainty.Omega * error) / edge.uncertainty.rank;
    const double square_without = error.dot(without.ldlt().solve(error)) / edge.uncertainty.rank;
    squares_without += square_without;
    worst_without = std::max(worst_without, std::sqrt(square_without));
    worst = std::max(worst, ClaimedSigmas(error, edge.uncertainty).maxCoeff());
    ++edges;
  }
};

}  // namespace

void PrintGiven(int seeds) {
  GivenScore boards, beams, both;
  for (int seed = 1; seed <= seeds; ++seed) {
    sim::Options options;
    options.seed = static_cast<std::uint64_t>(seed);
    options.board_scale_ratio = seed % 2 == 0 ? kBoardRatio : 2 - kBoardRatio;
    boards.Add(Calibrated(RecordFeatures(MarsMapper(options), kGivenLidarCaptures)));
    options.lidar_bias_sigma_m = kBias_m;
    both.Add(Calibrated(RecordFeatures(MarsMapper(options), kGivenLidarCaptures)));
    options.board_scale_ratio = 1;
    beams.Add(Calibrated(RecordFeatures(MarsMapper(options), kGivenLidarCaptures)));
  }
  std::printf("\"given\": {");
  boards.Print("boards_0.1_percent_off", "");
  beams.Print("beams_5_mm_off", ",");
  both.Print("both", ",");
  std::printf("}");
}

void PrintLidarBeams(int seeds) {
  BeamScore score;
  for (int seed = 1; seed <= seeds; ++seed) {
    sim::Options options;
    options.seed = static_cast<std::uint64_t>(seed);
    options.lidar_bias_sigma_m = kBias_m;
    const FeatureSession session = RecordFeatures(MarsMapper(options), kGivenLidarPairCaptures);
    for (const SensorPair& pair : PairsOf(session))
      if (pair.a.str().starts_with("lidar") && pair.b.str().starts_with("lidar"))
        score.Add(session, EdgeOf(session, pair));
  }
  std::printf(
      "\"lidar_beams\": {\"edges\": %d, \"failed\": %d, \"worst_sigmas\": %.3f, \"mean_square\": %.3f, "
      "\"mean_square_without_beams\": %.3f, \"largest_rms_without_beams\": %.3f}",
      score.edges, score.failed, score.worst, score.squares / score.edges, score.squares_without / score.edges,
      score.worst_without);
}

}  // namespace rigcal
