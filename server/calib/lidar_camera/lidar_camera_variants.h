// A lidar-camera problem with one thing changed, solved again from an estimate of the whole.
#pragma once

#include <vector>

#include "server/calib/core/beam_groups.h"
#include "server/calib/core/capture_blocks.h"
#include "server/calib/lidar_camera/lidar_camera.h"

namespace rigcal::calib {

// Of the captures that carry the answer: those of both, and every picture unless intrinsics are held.
[[nodiscard]] std::vector<CaptureBlock> BlocksOf(const LidarCameraProblem& problem,
                                                 const LidarCameraEstimate& estimate);
// Those of them with a capture of both.
[[nodiscard]] std::size_t CarryingBlocks(const std::vector<CaptureBlock>& blocks, const LidarCameraEstimate& estimate);
[[nodiscard]] Result<LidarCameraEstimate> SolvedAgain(const LidarCameraProblem& problem,
                                                      const LidarCameraEstimate& start);
// Everything estimated anew, intrinsics too unless they are held.
[[nodiscard]] Result<LidarCameraEstimate> SolvedWithout(const LidarCameraProblem& problem,
                                                        const LidarCameraEstimate& estimate,
                                                        const std::set<CaptureId>& captures);
// Of given intrinsics with sigmas: fx fy cx cy and the distortion, the idx-th given larger by so many of its sigmas.
[[nodiscard]] Result<LidarCameraEstimate> SolvedWithIntrinsic(const LidarCameraProblem& problem,
                                                              const LidarCameraEstimate& estimate, std::size_t idx,
                                                              double sigmas);
// What the corners' errors do to intrinsics: independent changes of one sigma each; none where they are held.
[[nodiscard]] std::vector<IntrinsicsVector> ChangesOfIntrinsics(const LidarCameraProblem& problem,
                                                                const LidarCameraEstimate& estimate);
[[nodiscard]] Result<LidarCameraEstimate> SolvedWithChange(const LidarCameraProblem& problem,
                                                           const LidarCameraEstimate& estimate,
                                                           const IntrinsicsVector& change);
// Indices of those whose sigma is above zero; none if the intrinsics are not given or exact.
[[nodiscard]] std::vector<std::size_t> UncertainIntrinsics(const LidarCameraProblem& problem);

// Of the groups of beams (beam_groups.h): which took a point of a board; all of one with longer ranges.
[[nodiscard]] std::vector<char> BeamsSeen(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate);
[[nodiscard]] Result<LidarCameraEstimate> SolvedWithBeamsMoved(const LidarCameraProblem& problem,
                                                               const LidarCameraEstimate& estimate, std::size_t group,
                                                               double longer_m);

}  // namespace rigcal::calib
