// The clouds of a lidar-lidar problem made ready, and the steps from a start to a pose, for lidar_lidar*.cc. Frames:
// the denser lidar makes the maps, the other one moves; of two alike, the one whose name comes first makes them. So the
// answer for (b, a) is the inverse of that for (a, b), bit for bit before it is inverted.
#pragma once

#include <vector>

#include "server/calib/lidar_lidar/lidar_clouds.h"
#include "server/calib/lidar_lidar/lidar_lidar.h"
#include "server/calib/lidar_lidar/ndt_fit.h"
#include "server/model/edges/method.h"

namespace rigcal::calib {

struct LidarLidarWork {
  bool a_is_map = true, polish = false;
  double voxel_m = 1;
  std::vector<std::size_t> used;    // indices of the problem's captures
  std::vector<LidarClouds> clouds;  // side by side with `used`
  Se3 nominal;                      // T_map_moving
};

// Ranges longer by so much.
struct RangeShift {
  double a_m = 0, b_m = 0;
};
constexpr std::size_t kCloudPointsMin = 500;
// Whether both clouds have kCloudPointsMin points.
[[nodiscard]] bool IsUsable(const LidarLidarCapture& capture);
// Without cells: nothing to polish with; FitFrom() then gives NDT's pose twice.
[[nodiscard]] LidarLidarWork WorkOf(const LidarLidarProblem& problem, const RangeShift& shift = {},
                                    bool with_cells = true);

struct LidarLidarPose {
  Se3 ndt, polished;     // T_map_moving
  Se3 T;                 // whichever of them is asked for
  double last_step = 0;  // of its last stage
  bool converged = false;
  double met_ratio = 0;  // part of the moving points with a voxel about them, at the finest level
};
// From a level of NDT down to the polish.
[[nodiscard]] LidarLidarPose FitFrom(const LidarLidarWork& work, const Se3& start, std::size_t first_level,
                                     const Directions& locked);

// Where one start ends, after all levels of NDT, on a few captures. Higher scores are better.
struct StartEnd {
  Se3 T;
  double score = 0, met_ratio = 0;  // as LidarLidarPose's
};
// On the captures of StartCaptures(); from a level of NDT on.
[[nodiscard]] StartEnd EndFrom(const LidarLidarWork& work, const Se3& start, std::size_t first_level);
// The nominal pose first, then it turned and shifted to all sides; from a level of NDT on.
[[nodiscard]] std::vector<StartEnd> TryStarts(const LidarLidarWork& work, std::size_t first_level);
// Which of `work.clouds` these few captures are.
[[nodiscard]] std::vector<std::size_t> StartCaptures(const LidarLidarWork& work);

// One Gauss-Newton step against each gradient (a column), but along `locked`.
[[nodiscard]] Directions StepsTo(const Matrix6d& H, const Directions& gradients, const Directions& locked);

// The pose without each block: the captures, or with one capture either half of its points. One Gauss-Newton step of
// the last stage from the common pose, whose pairs it keeps.
struct LidarLidarBlocks {
  std::vector<Vector6d> d;          // Log(T^-1 T_(i))
  std::vector<SurfacePairs> pairs;  // of the block left out, by the pose without it
};
// `T`: the common pose T_map_moving; `locked`: directions in which no block may move it.
[[nodiscard]] LidarLidarBlocks LeaveBlocksOut(const LidarLidarWork& work, const Se3& T, const Directions& locked);

// lidar_lidar_uncertainty.cc: how sure the pose is.
constexpr std::size_t kCloudsForJackknife = 5;  // captures; fewer: the model's
// Fewer: a note says that sigma is rough.
constexpr std::size_t kCloudsEnough = RowOf(Method::kLidarLidar).captures.enough;

// Of T_a_b. `d`: block vectors of T_map_moving from LeaveBlocksOut(). The jackknife over captures shrunk towards the
// model; with few captures the model: the information of the surfaces with the scatter between blocks of voxels. What
// NDT and its polish disagree by, and ranges that are all off together, are contributions. No information along
// `unknown`.
[[nodiscard]] Result<Uncertainty> LidarLidarUncertainty(const LidarLidarProblem& problem, const LidarLidarWork& work,
                                                        const LidarLidarPose& pose, const Directions& unknown,
                                                        const std::vector<SurfacePairs>& pairs,
                                                        const std::vector<Vector6d>& d);

constexpr double kOverlapMin_ratio = 0.25;  // of the moving cloud; less: they do not see the same place
constexpr double kMatchMin_ratio = 0.4;     // of the flat voxels with a counterpart near; less: the wrong pose
constexpr std::size_t kPairsMin = 40;

// lidar_lidar_diagnoses.cc: the sentences. Each names the sensors and captures it is about, and what to do.
//
// Why there is no answer.
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
