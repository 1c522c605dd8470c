#include "server/calib/placement/rig_information.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "server/calib/camera/view_moments.h"

namespace rigcal::calib::placement {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Over a camera's own numbers: intrinsics, then the board's pose in it (right tangent).
using OwnMatrix = Eigen::Matrix<double, kIntrinsicsMax + 6, kIntrinsicsMax + 6>;

// Points with the information that each stands for.
struct WeighedPoints {
  std::vector<Eigen::Vector3d> points_m;
  double weight = 1.0;
};

// Three places along a side, equally heavy, have its points' mean and variance.
double ExtentOf(const std::vector<Eigen::Vector3d>& points, int axis, double mean) {
  double squares = 0;
  for (const Eigen::Vector3d& point : points) squares += (point[axis] - mean) * (point[axis] - mean);
  return std::sqrt(1.5 * squares / static_cast<double>(points.size()));
}

WeighedPoints NinePointsOf(const Target& board) {
  const std::vector<Eigen::Vector3d> all = TargetPoints(board);
  const Eigen::Vector3d middle =
      std::accumulate(all.begin(), all.end(), Eigen::Vector3d(0, 0, 0)) / static_cast<double>(all.size());
  const double x_m = ExtentOf(all, 0, middle.x()), y_m = ExtentOf(all, 1, middle.y());
  WeighedPoints nine;
  nine.weight = static_cast<double>(all.size()) / 9;
  for (const int row : {-1, 0, 1})
    for (const int column : {-1, 0, 1}) nine.points_m.push_back(middle + Eigen::Vector3d(column * x_m, row * y_m, 0));
  return nine;
}

WeighedPoints SeenPoints(const Target& board, const std::vector<int>& corner_idx) {
  const std::vector<Eigen::Vector3d> all = TargetPoints(board);
  WeighedPoints seen;
  for (const int idx : corner_idx) seen.points_m.push_back(all[static_cast<std::size_t>(idx)]);
  return seen;
}

std::optional<OwnMatrix> NormalOf(const PlannedCamera& camera, const Se3& T_camera_board, const WeighedPoints& seen) {
  SeenCorners corners;
  corners.idx.resize(seen.points_m.size());
  std::iota(corners.idx.begin(), corners.idx.end(), 0);
  corners.uv_px.assign(seen.points_m.size(), Eigen::Vector2d::Zero());  // no residual is asked for
  const auto moments = MomentsAt(camera.model, camera.intrinsics, seen.points_m, corners, T_camera_board);
  if (!moments) return std::nullopt;
  return moments->normal * (seen.weight / (camera.corner_sigma_px * camera.corner_sigma_px));
}

// A camera's own numbers by the unknowns of the rig that it has part in.
struct OwnColumns {
  std::vector<int> unknowns;
  Eigen::Matrix<double, kIntrinsicsMax + 6, Eigen::Dynamic> by;
};

// T_c_b Exp(.) follows the camera's pose by -Ad(T_b_c). Of a double sphere the unknown beside xi is the focal length on
// the axis, times 1 + xi: fx and xi by themselves are known far worse than what they are together.
OwnColumns ColumnsOf(const PlannedCamera& planned, const UnknownsOfRig& unknowns, std::size_t camera,
                     const Se3& T_camera_board) {
  OwnColumns own;
  const int pose = unknowns.pose[camera];
  for (int axis = 0; pose >= 0 && axis < 6; ++axis) own.unknowns.push_back(pose + axis);
  std::vector<int> refined;
  for (int i = 0; i < kIntrinsicsMax; ++i)
    if (unknowns.lens[camera][static_cast<std::size_t>(i)] >= 0) refined.push_back(i);
  for (const int i : refined) own.unknowns.push_back(unknowns.lens[camera][static_cast<std::size_t>(i)]);
  own.by.setZero(kIntrinsicsMax + 6, static_cast<Eigen::Index>(own.unknowns.size()));
  Eigen::Index column = 0;
  if (pose >= 0) own.by.block<6, 6>(kIntrinsicsMax, 0) = -Adjoint(T_camera_board.Inverse()), column = 6;
  constexpr int kXi = 4;
  for (const int i : refined) {
    if (planned.model == CameraModel::kDoubleSphere && i == kXi)
      own.by.col(column).head<2>() = planned.intrinsics.head<2>() / (1 + planned.intrinsics[kXi]);
    own.by(i, column++) = 1;
  }
  return own;
}

// One capture's normal equations: blocks of the cameras beside each other, and the board's pose.
class CaptureEquations {
 public:
  void Add(const OwnColumns& own, const OwnMatrix& normal) {
    const Eigen::Index old = H_.rows(), more = own.by.cols();
    H_.conservativeResizeLike(MatrixXd::Zero(old + more, old + more));
    H_board_.conservativeResizeLike(MatrixXd::Zero(old + more, 6));
    H_.block(old, old, more, more) = own.by.transpose() * normal * own.by;
    H_board_.bottomRows(more) = own.by.transpose() * normal.rightCols<6>();
    board_ += normal.bottomRightCorner<6, 6>();
    unknowns_.insert(unknowns_.end(), own.unknowns.begin(), own.unknowns.end());
  }
  [[nodiscard]] PartOfInformation WithoutBoard() const {
    if (unknowns_.empty()) return {};
    const Vector6d scale = board_.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<Matrix6d> axes(scale.asDiagonal() * board_ * scale.asDiagonal());
    Vector6d root = Vector6d::Zero();
    for (int i = 0; i < 6; ++i)
      if (axes.eigenvalues()[i] > 1e-12) root[i] = 1 / std::sqrt(axes.eigenvalues()[i]);
    const MatrixXd half = H_board_ * scale.asDiagonal() * axes.eigenvectors() * root.asDiagonal();
    return {unknowns_, H_ - half * half.transpose()};
  }

 private:
  std::vector<int> unknowns_;
  MatrixXd H_ = MatrixXd(0, 0), H_board_ = MatrixXd(0, 6);
  Matrix6d board_ = Matrix6d::Zero();
};

template <typename PointsOf>
PartOfInformation InformationBy(const PlannedRig& rig, const UnknownsOfRig& unknowns, const PlannedCapture& capture,
                                const PointsOf& points_of) {
  CaptureEquations equations;
  for (const PlannedLook& look : capture.looks)
    if (const auto normal = NormalOf(rig.cameras[look.camera], look.T_camera_board, points_of(look)))
      equations.Add(ColumnsOf(rig.cameras[look.camera], unknowns, look.camera, look.T_camera_board), *normal);
  return equations.WithoutBoard();
}

VectorXd KnownBeforehand(const PlannedRig& rig, const UnknownsOfRig& unknowns) {
  VectorXd information = VectorXd::Zero(unknowns.size);
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    for (int axis = 0; unknowns.pose[c] >= 0 && axis < 6; ++axis) {
      const double sigma = axis < 3 ? kGuessSigma_m : kGuessSigma_rad;
      information[unknowns.pose[c] + axis] = 1 / (sigma * sigma);
    }
    for (int i = 0; i < kIntrinsicsMax; ++i)
      if (const int at = unknowns.lens[c][static_cast<std::size_t>(i)]; at >= 0)
        information[at] = 1 / (rig.cameras[c].lens_sigma[i] * rig.cameras[c].lens_sigma[i]);
  }
  return information;
}

}  // namespace

UnknownsOfRig::UnknownsOfRig(const PlannedRig& rig) {
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    pose.push_back(c == rig.reference ? -1 : size);
    if (c != rig.reference) size += 6;
  }
  for (const PlannedCamera& camera : rig.cameras) {
    std::vector<int>& of_camera = lens.emplace_back(kIntrinsicsMax, -1);
    for (int i = 0; i < IntrinsicsCount(camera.model); ++i)
      if (camera.lens_sigma[i] > 0) of_camera[static_cast<std::size_t>(i)] = size++;
  }
}

PartOfInformation InformationOf(const PlannedRig& rig, const UnknownsOfRig& unknowns, const PlannedCapture& capture) {
  return InformationBy(rig, unknowns, capture,
                       [&](const PlannedLook& look) { return SeenPoints(rig.boards[capture.board], look.corner_idx); });
}

PartOfInformation ExpectedInformation(const PlannedRig& rig, const UnknownsOfRig& unknowns,
                                      const PlannedCapture& capture) {
  const WeighedPoints nine = NinePointsOf(rig.boards[capture.board]);
  return InformationBy(rig, unknowns, capture, [&](const PlannedLook&) { return nine; });
}

MatrixXd CovarianceBy(const PlannedRig& rig, const UnknownsOfRig& unknowns, std::span<const PartOfInformation> parts) {
  MatrixXd H = KnownBeforehand(rig, unknowns).asDiagonal();
  for (const PartOfInformation& part : parts)
    for (std::size_t row = 0; row < part.unknowns.size(); ++row)
      for (std::size_t column = 0; column < part.unknowns.size(); ++column)
        H(part.unknowns[row], part.unknowns[column]) +=
            part.H(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
  // Pixels, ratios, metres: scaled to a unit diagonal.
  const VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd scaled = scale.asDiagonal() * H * scale.asDiagonal();
  return scale.asDiagonal() * scaled.ldlt().solve(MatrixXd(scale.asDiagonal()));
}

VectorXd VariancesWith(const MatrixXd& covariance, const PartOfInformation& part, int count) {
  VectorXd variances = covariance.diagonal().head(count);
  const auto size = static_cast<Eigen::Index>(part.unknowns.size());
  if (size == 0) return variances;
  MatrixXd C_J(covariance.rows(), size), C_JJ(size, size);
  for (Eigen::Index j = 0; j < size; ++j) C_J.col(j) = covariance.col(part.unknowns[static_cast<std::size_t>(j)]);
  for (Eigen::Index j = 0; j < size; ++j) C_JJ.row(j) = C_J.row(part.unknowns[static_cast<std::size_t>(j)]);
  const MatrixXd gain = (MatrixXd::Identity(size, size) + part.H * C_JJ).partialPivLu().solve(part.H);
  const MatrixXd told = C_J.topRows(count) * gain;
  const VectorXd less = told.cwiseProduct(C_J.topRows(count)).rowwise().sum();
  return (variances - less).cwiseMin(variances).cwiseMax(0.0);
}

}  // namespace rigcal::calib::placement
