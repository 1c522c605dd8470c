// Figures of whole simulated rigs against their truth; each prints one member of a JSON object.
#pragma once

#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "tests/bench/rig/feature_session.h"

namespace rigcal {

struct RigCase {
  FeatureSession session;
  std::vector<Edge> edges;
  GraphSolution solution;
};
[[nodiscard]] sim::Experiment MarsMapper(const sim::Options& options);
[[nodiscard]] RigCase Calibrated(FeatureSession session);

// Log(estimate^-1 truth), right tangent.
[[nodiscard]] Vector6d EdgeError(const RigCase& rig, const Edge& edge);
[[nodiscard]] Vector6d PoseError(const RigCase& rig, const SensorPose& pose);
// Largest error over sigma along and about the axes that are known.
[[nodiscard]] double WorstAxis(const Vector6d& error, const Matrix6d& covariance);
// Largest error over sigma along and about those axes whose sigma the edge tells; 0 if it tells none.
[[nodiscard]] double WorstKnownAxis(const Vector6d& error, const Uncertainty& uncertainty);
// Error over sigma in each principal direction of what the edge claims to know. These directions come from the
// estimate, which found its errors smallest there: harder than any direction chosen beforehand.
[[nodiscard]] Eigen::VectorXd ClaimedSigmas(const Vector6d& error, const Uncertainty& uncertainty);
[[nodiscard]] int CountFailed(const std::vector<Edge>& edges);

void PrintCoverage(int seeds, int first);
void PrintMotions(int seeds, int first);
void PrintGiven(int seeds);
void PrintLidarBeams(int seeds);
void PrintTurned(int seeds);
void PrintSameBytes(int seeds);
void PrintTime();

}  // namespace rigcal
