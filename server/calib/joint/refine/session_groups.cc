#include "server/calib/joint/refine/session_groups.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <set>

namespace rigcal::calib::joint {
namespace {

// T of six rows against their covariance, each in its own unit.
double InSigmas(const Vector6d& influence, const Matrix6d& covariance) {
  const Vector6d scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Matrix6d> unit(scale.asDiagonal() * covariance * scale.asDiagonal());
  const Vector6d scaled = scale.cwiseProduct(influence);
  return std::sqrt(std::max(0.0, scaled.dot(unit.solve(scaled))));
}

void AddMostMoved(const PoseCovariance& covariance, const std::map<SensorId, int>& sensors, CaptureGroup& group,
                  Eigen::Index g) {
  for (const auto& [id, s] : sensors) {
    const int row = covariance.row_of_sensor[static_cast<std::size_t>(s)];
    if (row == kNone) continue;
    const double sigmas = InSigmas(covariance.influence.block<6, 1>(row, g), covariance.joint.block<6, 6>(row, row));
    if (sigmas > group.sigmas) group.sensor = id, group.sigmas = sigmas;
  }
}

}  // namespace

std::vector<CaptureGroup> GroupsTold(const SessionProblem& problem, const Refined& refined,
                                     const PoseCovariance& covariance, const std::map<SensorId, int>& sensors) {
  std::vector<CaptureGroup> groups(static_cast<std::size_t>(refined.groups.groups()));
  std::set<int> listed;  // a capture has a place for each board that is carried about
  for (std::size_t place = 0; place < problem.capture_of_place.size(); ++place)
    if (listed.insert(problem.capture_of_place[place]).second)
      groups[static_cast<std::size_t>(refined.groups.group_of_place[place])].captures.push_back(
          CaptureAt(problem, static_cast<int>(place)));
  for (std::size_t g = 0; g < groups.size(); ++g)
    AddMostMoved(covariance, sensors, groups[g], static_cast<Eigen::Index>(g));
  return groups;
}

std::vector<ResidualNoise> NoiseTold(const SessionProblem& problem, const Refined& refined,
                                     const std::map<SensorId, int>& sensors) {
  std::map<int, ResidualNoise> noise;
  for (const CornersSeen& seen : problem.corners) {
    const SensorNoise& own = refined.noise[static_cast<std::size_t>(seen.sensor)];
    noise[seen.sensor].corner_px = own.sigma;
    noise[seen.sensor].rotation_rad = own.sigma_rad;
  }
  for (const PlateSeen& seen : problem.plates)
    noise[seen.sensor].range_ratio = refined.noise[static_cast<std::size_t>(seen.sensor)].sigma;
  for (const PoseTold& told : problem.poses) {
    const SensorNoise& own = refined.noise[static_cast<std::size_t>(told.sensor)];
    noise[told.sensor].position_m = own.sigma;
    noise[told.sensor].rotation_rad = own.sigma_rad;
  }
  std::vector<ResidualNoise> told;
  for (const auto& [id, s] : sensors)
    if (const auto found = noise.find(s); found != noise.end()) {
      told.push_back(found->second);
      told.back().sensor = id;
    }
  return told;
}

}  // namespace rigcal::calib::joint
