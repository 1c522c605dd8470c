// One view near a pose of its board, as a quadratic function of intrinsics and pose; and what all views of a camera say
// of its intrinsics.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "server/calib/camera/projection.h"
#include "server/calib/camera/seen_corners.h"
#include "server/math/se3.h"
#include "server/model/sessions/session.h"

namespace rigcal::calib {

// Normal matrix and gradient over [intrinsics, board pose (right tangent)], px^2.
struct ViewMoments {
  Se3 T_cam_board;
  Eigen::Matrix<double, kIntrinsicsMax + 6, kIntrinsicsMax + 6> normal;
  Eigen::Matrix<double, kIntrinsicsMax + 6, 1> gradient;
  double ssr_px2 = 0;
};
// Nothing where the board does not lie in front of the camera.
[[nodiscard]] std::optional<ViewMoments> MomentsAt(CameraModel model, const IntrinsicsVector& intrinsics,
                                                   const std::vector<Eigen::Vector3d>& corners_board,
                                                   const SeenCorners& seen, const Se3& T_cam_board);

// What the view says of the intrinsics when its pose follows them.
struct ViewOfIntrinsics {
  Eigen::Matrix<double, kIntrinsicsMax, kIntrinsicsMax> information;
  IntrinsicsVector gradient;
  Eigen::Matrix<double, 6, kIntrinsicsMax> d_board;  // T_cam_board * Exp(d_board * change of the intrinsics)
};
// Schur complement over the board's pose, whose block of the normal matrix has to be invertible.
[[nodiscard]] ViewOfIntrinsics Eliminated(const ViewMoments& view);

// What all views of a camera say of its intrinsics once every board's pose follows them, for reports, after the answer:
// normal equations over the intrinsics of a model, px^2; and over one motion that all boards share.
struct GatheredViews {
  struct View {
    Eigen::MatrixXd normal;
    Eigen::VectorXd gradient;
  };
  std::vector<View> views;
  Eigen::MatrixXd normal;
  Eigen::VectorXd gradient;
  double ssr_px2 = 0.0;
  std::size_t numbers = 0;  // two per corner
  Matrix6d motion_normal = Matrix6d::Zero();
  Eigen::MatrixXd motion_mixed;  // 6 rows, a column for each intrinsic

  // Of no views yet.
  explicit GatheredViews(CameraModel model);
  // A view with so many corners, its board's pose eliminated.
  void Add(const ViewMoments& moments, std::size_t corners);
};

// Covariances of the intrinsics, in the order of IntrinsicsVector; without rows where a direction is open or no corner
// is left to tell the noise. By leaving each view out (one Gauss-Newton step each); of least squares, s^2 H^-1.
[[nodiscard]] Eigen::MatrixXd CovarianceByJackknife(const GatheredViews& gathered);
[[nodiscard]] Eigen::MatrixXd CovarianceByModel(const GatheredViews& gathered);
// Of the views and of what was given with sigmas together (camera.intrinsics_sigma must be there); what was given alone
// where the views leave no scatter.
[[nodiscard]] Eigen::MatrixXd CovarianceWithGiven(const Sensor& camera, const GatheredViews& gathered);

// CameraFit::implied_motion: K of xi = K db, the one motion xi of all boards in the camera's frame that keeps every
// corner where it was, as far as one motion can, when the intrinsics change by db:
//   xi = argmin sum_k |J_k db + A_k xi|^2 over the corners k,  K = -(sum A_k^T A_k)^-1 sum A_k^T J_k,
// with J_k the derivative of the corner's pixel by the intrinsics and A_k that by xi, T_cam_board <- Exp(xi)
// T_cam_board. As A_k = (derivative by the right tangent at the board) Ad(T_cam_board^-1), both sums are those of the
// views' moments. It is the K of mrcal's "Projection uncertainty: cross-reprojection" (T_r+r, one camera; mrcal 3.0),
// without the term of the corners' own noise: that is independent of db and moves all points as one body, so it belongs
// to the camera's pose and not to its lens. Without columns where the views do not tell it.
[[nodiscard]] Eigen::MatrixXd ImpliedMotion(const GatheredViews& gathered);

}  // namespace rigcal::calib
