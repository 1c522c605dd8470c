#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "server/calib/camera/intrinsics.h"

namespace rigcal::calib {
namespace {

using Information = Eigen::Matrix<double, kIntrinsicsMax, kIntrinsicsMax>;

Information OfViews(const CameraEstimate& estimate) {
  Information information = Information::Zero();
  for (const auto& [capture, view] : estimate.of_intrinsics) information += view.information;
  return information;
}

// Of all views and what pulls; unit where an intrinsic is held, which no gradient moves.
Information InformationOf(const CameraEstimate& estimate) {
  Information information = OfViews(estimate);
  for (int i = 0; i < kIntrinsicsMax; ++i) information(i, i) += std::pow(estimate.pull.Weight(i), 2);
  return information;
}

// Where nothing pulls, the views estimate all that the model has.
bool IsFree(const CameraEstimate& estimate, int idx) {
  return estimate.pull.Pulls() ? estimate.pull.sigma[idx] > 0 : idx < IntrinsicsCount(estimate.intrinsics.model);
}

IntrinsicsVector Solved(const CameraEstimate& estimate, Information information, IntrinsicsVector gradient) {
  for (int i = 0; i < kIntrinsicsMax; ++i) {
    if (IsFree(estimate, i)) continue;
    information.row(i).setZero();
    information.col(i).setZero();
    information(i, i) = 1;
    gradient[i] = 0;
  }
  return information.ldlt().solve(gradient);
}

}  // namespace

CameraEstimate WithIntrinsicsMoved(CameraEstimate estimate, const IntrinsicsVector& change) {
  const CameraModel model = estimate.intrinsics.model;
  estimate.intrinsics = IntrinsicsOf(model, VectorOf(estimate.intrinsics) + change);
  for (auto& [capture, T_cam_board] : estimate.T_cam_board)
    if (const auto view = estimate.of_intrinsics.find(capture); view != estimate.of_intrinsics.end())
      T_cam_board = (T_cam_board * Se3::Exp(view->second.d_board * change)).Normalized();
  return estimate;
}

CameraEstimate WithoutViews(const CameraEstimate& estimate, const std::set<CaptureId>& captures) {
  CameraEstimate without = estimate;
  Information information = InformationOf(estimate);
  IntrinsicsVector gradient = IntrinsicsVector::Zero();
  bool is_told = false;
  for (const CaptureId& capture : captures) {
    without.T_cam_board.erase(capture);
    without.information.erase(capture);
    without.alternatives.erase(capture);
    without.rms_by_capture_px.erase(capture);
    without.of_intrinsics.erase(capture);
    const auto view = estimate.of_intrinsics.find(capture);
    if (view == estimate.of_intrinsics.end()) continue;
    information -= view->second.information;
    gradient += view->second.gradient;
    is_told = true;
  }
  return is_told ? WithIntrinsicsMoved(std::move(without), Solved(estimate, information, gradient)) : without;
}

std::vector<IntrinsicsVector> ChangesByCorners(const CameraEstimate& estimate) {
  const Information of_views = OfViews(estimate);
  // Pixels and ratios side by side: decomposed with a unit diagonal.
  const IntrinsicsVector scale = of_views.diagonal().cwiseSqrt();
  const auto safe = scale.unaryExpr([](double one) { return one > 0 ? 1 / one : 0.0; });
  const Information scaled = safe.asDiagonal() * of_views * safe.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Information> views(scaled);
  const double variance_px2 = std::max(estimate.variance_px2, std::pow(estimate.pull.corner_sigma_px, 2));
  std::vector<IntrinsicsVector> changes;
  for (int i = 0; i < kIntrinsicsMax; ++i) {
    const double strength = std::sqrt(std::max(0.0, views.eigenvalues()[i]) * variance_px2);
    const IntrinsicsVector gradient = strength * scale.cwiseProduct(views.eigenvectors().col(i));
    if (strength > 0) changes.push_back(Solved(estimate, InformationOf(estimate), gradient));
  }
  return changes;
}

CameraEstimate WithGiven(const CameraEstimate& estimate, int idx, double sigmas) {
  IntrinsicsVector gradient = IntrinsicsVector::Zero();
  gradient[idx] = std::pow(estimate.pull.Weight(idx), 2) * estimate.pull.sigma[idx] * sigmas;
  return WithIntrinsicsMoved(estimate, Solved(estimate, InformationOf(estimate), gradient));
}

}  // namespace rigcal::calib
