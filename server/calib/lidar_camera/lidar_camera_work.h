// The numbers of a lidar-camera problem as they shrink and improve, for lidar_camera*.cc.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/calib/core/capture_blocks.h"
#include "server/calib/lidar_camera/lidar_camera.h"
#include "server/calib/lidar_camera/plane_problem.h"

namespace rigcal::calib {

// Which end of the edge the camera is: "_a" or "_b", as its figures have it.
[[nodiscard]] inline const char* SideOfCamera(const LidarCameraProblem& problem) {
  return problem.camera_is_a ? "_a" : "_b";
}

struct UsedPatch {
  std::size_t capture_idx = 0, patch_idx = 0;
};

struct LidarCameraWork {
  std::vector<UsedPatch> used;
  std::map<std::size_t, std::string> unused;  // capture index: why
  CameraEstimate camera;
  Se3 T_cam_lidar;
  double range_bias_m = 0.0;         // the problem's
  std::vector<PlaneCapture> planes;  // side by side with `used`
  double range_sigma_m = 0.0, capture_sigma_m = 0.0;
  std::optional<HeldDirection> held;
  PlaneSolution solution;

  [[nodiscard]] PlaneState StateOf() const;  // boards where the pictures put them
  // `position`: in `used`. The capture becomes an unused one, for this reason.
  void Drop(std::size_t position, const std::string& why);
};

// Empty: picture and cloud both offer a board.
[[nodiscard]] std::string WhyUseless(const LidarCameraProblem& problem, const CameraEstimate& camera,
                                     std::size_t capture_idx);
// Noise and moments of the chosen patches.
void FillPlanes(const LidarCameraProblem& problem, LidarCameraWork& work);
// The same choices and weights as an estimate's.
[[nodiscard]] LidarCameraWork WorkOf(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate);
[[nodiscard]] LidarCameraCheck CheckOf(const LidarCameraProblem& problem, const LidarCameraWork& work,
                                       std::size_t position);

// Weights of the captures from how far their clouds are from their pictures.
void Reweigh(const LidarCameraProblem& problem, LidarCameraWork& work);

struct NormalSpread {
  double cone_deg = 0.0;      // largest angle between two normals
  double sigma_m = 0.0;       // of the worst direction of the translation if each plane is known to 10 mm
  double next_sigma_m = 0.0;  // of the worst direction across that one
  Eigen::Vector3d axis_cam = Eigen::Vector3d::UnitZ();  // that direction
};
// Of the boards' normals in the camera; sigma is infinite along what none of them tells.
[[nodiscard]] NormalSpread SpreadOf(const std::vector<PlaneCapture>& planes);

// The problem with one thing changed, solved again from an estimate of the whole.
//
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
[[nodiscard]] Result<LidarCameraEstimate> SolvedWithCamera(const LidarCameraProblem& problem,
                                                           const LidarCameraEstimate& estimate, CameraEstimate camera);
// What the corners' errors do to intrinsics: independent changes of one sigma each; none where they are held.
[[nodiscard]] std::vector<IntrinsicsVector> ChangesOfIntrinsics(const LidarCameraProblem& problem,
                                                                const LidarCameraEstimate& estimate);

// Of the groups of beams (leave_one_out.h): which took a point of a board; all of one with longer ranges.
[[nodiscard]] std::vector<char> BeamsSeen(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate);
[[nodiscard]] Result<LidarCameraEstimate> SolvedWithBeamsMoved(const LidarCameraProblem& problem,
                                                               const LidarCameraEstimate& estimate, std::size_t group,
                                                               double longer_m);

// systematics.cc: what the captures say about errors that all of them share, a bias of the lidar's ranges and a board
// of another size.
//
// Fills range_bias_*, board_scale_* and scale_fits_better. Each is fitted beside the pose with weights of its own, so
// that the misfit of the other explanation does not hide it.
void EstimateSystematics(const LidarCameraProblem& problem, const LidarCameraWork& work, LidarCameraEstimate& estimate);
// Widens their sigmas, which so far are those of the points alone, by what the corners do to them by way of the
// intrinsics, by leaving captures out (if there are enough) and by the given intrinsics' own sigmas; forgets both where
// one of those cannot be told: poses of the boards err alike in all captures, and small tilts turn a tenth of a
// millimetre of that into centimetres of bias.
[[nodiscard]] Status WidenSystematics(const LidarCameraProblem& problem, LidarCameraEstimate& estimate);

}  // namespace rigcal::calib
