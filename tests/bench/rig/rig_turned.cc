#include <algorithm>
#include <cmath>

#include "client/sim/rig/random.h"
#include "client/sim/rig/rig_yaml.h"
#include "tests/bench/rig/rig_coverage.h"

namespace rigcal {
namespace {

constexpr std::size_t kTurnedLidarCaptures = 1;
constexpr double kTurnedRatio = 0.3;
constexpr double kSmallSquare_m = 0.02;  // 12 px in a picture of 5 megapixels

// A board that looks alike when turned by 180 degrees; `small`: with small squares, and facing the robot.
sim::Experiment WithBoards(int seed, bool small) {
  sim::Options options;
  options.seed = static_cast<std::uint64_t>(seed);
  sim::Rig rig = MarsMapper(options).rig;
  for (sim::RigBoard& board : rig.boards) {
    board.target.cols -= 1 - board.target.cols % 2;
    board.target.rows -= 1 - board.target.rows % 2;
    if (!small) continue;
    board.target.square_m = kSmallSquare_m;
    const Eigen::Vector3d away = board.T_world_plate.p_m - rig.motion.T_world_body_start.p_m;
    const Eigen::Quaterniond facing = Eigen::Quaterniond::FromTwoVectors(board.T_world_plate.R().col(2), away);
    board.T_world_plate.q = (facing * board.T_world_plate.q).normalized();
  }
  return sim::Prepare(std::move(rig), options).value();
}

void TurnViews(FeatureSession& session) {
  for (auto& [camera, views] : session.seen.views)
    for (std::size_t k = 0; k < session.experiment.captures.size(); ++k) {
      const auto view = views.find(session.experiment.captures[k]);
      if (view == views.end()) continue;
      sim::Random random(sim::KeyOf(session.experiment.options.seed, "turned", camera.str(), k));
      if (random.Uniform() < kTurnedRatio) std::reverse(view->second.corners_px.begin(), view->second.corners_px.end());
    }
}

struct TurnedScore {
  double moved_m = 0, moved_rad = 0, worst = 0;
  int failed = 0;

  void Add(const RigCase& plain, const RigCase& turned) {
    failed += CountFailed(plain.edges) + CountFailed(turned.edges);
    for (std::size_t i = 0; i < std::min(plain.solution.poses.size(), turned.solution.poses.size()); ++i) {
      const SensorPose &x = plain.solution.poses[i], &y = turned.solution.poses[i];
      if (!x.known || !y.known) {
        ++failed;
        continue;
      }
      const Vector6d apart = (x.T_ref_sensor.Inverse() * y.T_ref_sensor).Log();
      moved_m = std::max(moved_m, apart.head<3>().norm());
      moved_rad = std::max(moved_rad, apart.tail<3>().norm());
      if (x.sensor != plain.session.header.reference)
        worst = std::max(worst, WorstAxis(PoseError(turned, y), y.covariance));
    }
  }
  void Print(const char* name, const char* comma) const {
    std::printf("%s\n  \"%s\": {\"moved_mm\": %.8f, \"moved_deg\": %.8f, \"worst_sigmas\": %.3f, \"failed\": %d}",
                comma, name, 1e3 * moved_m, 180 / M_PI * moved_rad, worst, failed);
  }
};

}  // namespace

void PrintTurned(int seeds) {
  std::printf("\"turned\": {");
  const char* comma = "";
  for (const bool small : {false, true}) {
    TurnedScore score;
    for (int seed = 1; seed <= seeds; ++seed) {
      FeatureSession session = RecordFeatures(WithBoards(seed, small), kTurnedLidarCaptures);
      const RigCase plain = Calibrated(session);
      TurnViews(session);
      score.Add(plain, Calibrated(std::move(session)));
    }
    score.Print(small ? "small_frontal_boards" : "boards", comma);
    comma = ",";
  }
  std::printf("}");
}

}  // namespace rigcal
