// The sentences of lidar_lidar*.cc.
#pragma once

#include "server/calib/lidar_lidar/lidar_lidar.h"
#include "server/calib/lidar_lidar/ndt_fit.h"

namespace rigcal::calib {

constexpr double kOverlapMin_ratio = 0.25;  // of the moving cloud; less: they do not see the same place
constexpr double kMatchMin_ratio = 0.4;     // of the flat voxels with a counterpart near; less: the wrong pose
constexpr std::size_t kPairsMin = 40;

[[nodiscard]] Diagnosis NoNominalPose(const LidarLidarProblem& problem);
[[nodiscard]] Diagnosis NoCommonClouds(const LidarLidarProblem& problem);
[[nodiscard]] Diagnosis LowOverlap(const LidarLidarProblem& problem, double overlap_ratio, std::size_t pairs);
[[nodiscard]] Diagnosis PoorFit(const LidarLidarProblem& problem, double match_ratio);
[[nodiscard]] Diagnosis StartsDisagree(const LidarLidarProblem& problem, double other_m, double other_rad);
[[nodiscard]] Diagnosis StartsScatter(const LidarLidarProblem& problem, double agreeing_ratio);
[[nodiscard]] Diagnosis NotConverged(const LidarLidarProblem& problem, double last_step);
[[nodiscard]] Diagnosis NoStructure(const LidarLidarProblem& problem);
[[nodiscard]] Diagnosis LidarLidarError(const LidarLidarProblem& problem, const Error& error);

// Notes on a good edge. `unknown`: orthonormal, right tangent at b.
[[nodiscard]] Diagnosis DirectionsUnknown(const LidarLidarProblem& problem, const Directions& unknown);
[[nodiscard]] Diagnosis SingleCapture(const LidarLidarProblem& problem);
[[nodiscard]] Diagnosis FewClouds(const LidarLidarProblem& problem, std::size_t used);
[[nodiscard]] Diagnosis CloudsLeftOut(const LidarLidarProblem& problem, const std::vector<CaptureId>& captures);
// `moved`: the logarithm of the polished pose in NDT's.
[[nodiscard]] Diagnosis PolishedPose(const LidarLidarProblem& problem, const Vector6d& moved);
[[nodiscard]] Diagnosis RangesTakenAsExact(const LidarLidarProblem& problem);

}  // namespace rigcal::calib
