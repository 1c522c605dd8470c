#include "server/calib/joint/misfit/pose_clock.h"

#include <algorithm>
#include <cmath>

namespace rigcal::calib::joint {
namespace {

// What is slower makes no 0.3 mm and 0.3 mrad of 50 ms: it stands still, for people and for us.
constexpr double kStill_m_per_s = 0.005, kStill_rad_per_s = 0.005;
constexpr double kSurelyMoves =
    50.0;  // squared sigmas of a twist of six numbers: chance makes as many once in 10^8 times
constexpr double kNoiseMin_m = 1e-9, kNoiseMin_rad = 1e-9;
constexpr int kRoundsOfPaths = 3;

struct PathOfPose {
  std::size_t pose = 0;  // of the problem's
  LocalPathFit fit;
};

std::vector<PathOfPose> PathsOf(const SessionProblem& problem, const SensorId& tracker, const PoseTable& path) {
  std::vector<PathOfPose> paths;
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    const PoseTold& told = problem.poses[i];
    if (problem.sensors[static_cast<std::size_t>(told.sensor)] != tracker) continue;
    if (auto fit = FitLocalPath(path, told.stamp, told.T_world_body)) paths.push_back({i, std::move(*fit)});
  }
  return paths;
}

// Of one row of the path, m and rad, by what all fits together leave.
Eigen::Vector2d NoiseOf(const std::vector<PathOfPose>& paths) {
  Eigen::Vector2d squares = Eigen::Vector2d::Zero();
  double redundancy = 0.0;
  for (const PathOfPose& one : paths) {
    squares += one.fit.squares;
    redundancy += one.fit.redundancy;
  }
  const Eigen::Vector2d noise = (squares / std::max(1.0, redundancy)).cwiseSqrt();
  return noise.cwiseMax(Eigen::Vector2d(kNoiseMin_m, kNoiseMin_rad));
}

bool Moves(const LocalPathFit& fit, const Eigen::Vector2d& noise) {
  const Vector6d twist = fit.path.TwistAt(0.0);
  const double speed_m_per_s = twist.head<3>().norm(), speed_rad_per_s = twist.tail<3>().norm();
  if (speed_m_per_s < kStill_m_per_s && speed_rad_per_s < kStill_rad_per_s) return false;
  const Eigen::Vector2d sigmas = Eigen::Vector2d(speed_m_per_s, speed_rad_per_s).cwiseQuotient(noise);
  return sigmas.squaredNorm() / fit.velocity_gain_per_s2 >= kSurelyMoves;
}

constexpr double kNearEnough_s = 0.5 * kLocalPathHalf_s;
constexpr double kPulled_sigmas = 2.0;

// Whether paths were fitted where the clock is, and what was known of it (sigma_0, none by mean) pulled it by no more
// than two of its own sigmas: from late / (1 - s^2 / sigma_0^2), so by late s^2 / sigma_0^2 at least.
bool IsSettled(const SessionProblem& problem, int clock, double late_s, double sigma_s) {
  const double given_s = problem.clocks[static_cast<std::size_t>(clock)].sigma_s;
  if (std::abs(late_s) * sigma_s > kPulled_sigmas * given_s * given_s) return false;
  return std::none_of(problem.poses.begin(), problem.poses.end(), [&](const PoseTold& told) {
    return told.clock == clock && std::abs(late_s - told.path.about_s) >= kNearEnough_s;
  });
}

// False where every path was fitted near enough to where its clock is.
bool FitAgain(const SessionState& state, SessionProblem& problem) {
  bool any = false;
  for (PoseTold& told : problem.poses) {
    if (told.clock == kNone) continue;
    const auto clock = static_cast<std::size_t>(told.clock);
    const double late_s = state.clock_late_s[clock];
    if (std::abs(late_s - told.path.about_s) < kNearEnough_s) continue;
    const auto fit = FitLocalPath(*problem.clocks[clock].path, told.stamp, told.T_world_body, late_s);
    if (!fit) continue;  // the path ends before
    told.path = fit->path;
    any = true;
  }
  return any;
}

}  // namespace

void AddClock(const Sensor& tracker, const PoseTable& path, SessionProblem& problem, SessionState& state) {
  const double sigma_s = tracker.clock_sigma_s.value_or(kClockSigma_s);
  if (path.empty() || sigma_s <= 0) return;
  const int clock = static_cast<int>(problem.clocks.size());
  problem.clocks.push_back({tracker.id, sigma_s, std::make_shared<const PoseTable>(path)});
  state.clock_late_s.push_back(0.0);
  const std::vector<PathOfPose> paths = PathsOf(problem, tracker.id, path);
  const Eigen::Vector2d noise = NoiseOf(paths);
  for (const PathOfPose& one : paths) {
    if (!Moves(one.fit, noise)) continue;
    problem.poses[one.pose].clock = clock;
    problem.poses[one.pose].path = one.fit.path;
  }
}

Explained WithClocksSettled(Explained now) {
  for (int round = 0; round < kRoundsOfPaths; ++round) {
    SessionStart start = now.start;
    if (!FitAgain(now.refined.state, start.problem)) break;
    start.state = now.refined.state;
    start.noise = now.refined.noise;
    auto next = Explain(std::move(start), now.refined.groups);
    if (!next) break;
    now = std::move(*next);
  }
  return now;
}

std::vector<TrackerClock> ClocksTold(const SessionProblem& problem, const Refined& refined, double spread_ratio,
                                     const Eigen::MatrixXd& beside) {
  std::vector<TrackerClock> told;
  for (std::size_t c = 0; c < problem.clocks.size(); ++c) {
    const PoseClock& clock = problem.clocks[c];
    TrackerClock one{clock.tracker, refined.state.clock_late_s[c], clock.sigma_s, clock.sigma_s, 0};
    one.captures =
        static_cast<int>(std::count_if(problem.poses.begin(), problem.poses.end(),
                                       [&](const PoseTold& pose) { return pose.clock == static_cast<int>(c); }));
    if (const int at = refined.layout.clock[c]; at != kNone) {
      // Groups of captures that scatter more than the model expects know the clock less well, but no worse than before.
      const double lenses_s2 = beside.size() > 0 ? beside(at, at) : 0.0;
      one.sigma_s =
          std::min(clock.sigma_s, std::sqrt(std::max(1.0, spread_ratio) * refined.covariance(at, at) + lenses_s2));
      if (!IsSettled(problem, static_cast<int>(c), one.late_s, one.sigma_s))
        one.sigma_s = std::max(one.sigma_s, std::max(std::abs(one.late_s), clock.sigma_s));
    }
    told.push_back(one);
  }
  return told;
}

Eigen::MatrixXd CovarianceByClocks(const Refined& refined, const std::vector<TrackerClock>& told) {
  Eigen::MatrixXd covariance;
  for (std::size_t c = 0; c < told.size(); ++c) {
    const int at = refined.layout.clock[c];
    if (at == kNone || told[c].IsKnown()) continue;
    const double variance_s2 = refined.covariance(at, at);
    const Eigen::VectorXd moved = refined.covariance.col(at) / variance_s2;
    if (covariance.size() == 0) covariance = Eigen::MatrixXd::Zero(moved.size(), moved.size());
    covariance += std::max(0.0, told[c].sigma_s * told[c].sigma_s - variance_s2) * moved * moved.transpose();
  }
  return covariance;
}

}  // namespace rigcal::calib::joint
