#include "server/calib/core/costs.h"

#include <ceres/cost_function.h>

#include <algorithm>

#include "server/calib/core/pose_block.h"

namespace rigcal::calib {
namespace {

using PoseRows = Eigen::Map<Eigen::Matrix<double, 2, kPoseSize, Eigen::RowMajor>>;

// What both views of a board share: the first block is the camera's intrinsics, the others are poses.
class ViewCost : public ceres::CostFunction {
 protected:
  ViewCost(CameraModel model, const std::vector<Eigen::Vector3d>& corners_board, const SeenCorners& seen, int poses)
      : model_(model), count_(IntrinsicsCount(model)), corners_board_(corners_board), seen_(seen) {
    set_num_residuals(static_cast<int>(2 * seen.size()));
    mutable_parameter_block_sizes()->assign(1, count_);
    mutable_parameter_block_sizes()->resize(1 + static_cast<std::size_t>(poses), kPoseSize);
  }
  void FillResidual(const Projection& projection, std::size_t i, double* residuals) const {
    Eigen::Map<Eigen::Vector2d>(residuals + 2 * i) = projection.uv_px - seen_.uv_px[i];
  }
  void FillIntrinsicsRows(const Projection& projection, std::size_t i, double** jacobians) const {
    if (jacobians[0] != nullptr)
      CopyColumns(projection.d_intrinsics, count_, jacobians[0] + static_cast<std::ptrdiff_t>(i) * 2 * count_);
  }
  const Eigen::Vector3d& Corner(std::size_t i) const { return corners_board_[static_cast<std::size_t>(seen_.idx[i])]; }

  CameraModel model_;
  int count_;
  const std::vector<Eigen::Vector3d>& corners_board_;
  const SeenCorners& seen_;
};

class ReferenceViewCost final : public ViewCost {
 public:
  ReferenceViewCost(CameraModel model, const std::vector<Eigen::Vector3d>& corners_board, const SeenCorners& seen)
      : ViewCost(model, corners_board, seen, 1) {}

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const IntrinsicsVector intrinsics = PaddedIntrinsics(model_, blocks[0]);
    const Se3 T_a_board = PoseOf(blocks[1]);
    const Eigen::Matrix3d R_a_board = T_a_board.R();
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const Projection projection =
          Project(model_, intrinsics, R_a_board * Corner(i) + T_a_board.p_m, jacobians != nullptr);
      if (!projection.in_front) return false;
      FillResidual(projection, i, residuals);
      if (jacobians != nullptr) FillRows(projection, T_a_board, i, jacobians);
    }
    return true;
  }

 private:
  void FillRows(const Projection& projection, const Se3& T_a_board, std::size_t i, double** jacobians) const {
    FillIntrinsicsRows(projection, i, jacobians);
    if (jacobians[1] == nullptr) return;
    PoseRows d_pose(jacobians[1] + i * 2 * kPoseSize);
    d_pose.leftCols<3>() = projection.d_point;
    d_pose.rightCols<4>() = projection.d_point * RotatedByQuaternion(T_a_board.q, Corner(i));
  }
};

class SecondViewCost final : public ViewCost {
 public:
  SecondViewCost(CameraModel model, const std::vector<Eigen::Vector3d>& corners_board, const SeenCorners& seen)
      : ViewCost(model, corners_board, seen, 2) {}

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const IntrinsicsVector intrinsics = PaddedIntrinsics(model_, blocks[0]);
    const Chain chain{PoseOf(blocks[1]), PoseOf(blocks[2])};
    const Eigen::Matrix3d R_a_board = chain.T_a_board.R(), R_b_a = chain.T_a_b.R().transpose();
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      // Seen from the origin of b, in the axes of a.
      const Eigen::Vector3d v_a = R_a_board * Corner(i) + chain.T_a_board.p_m - chain.T_a_b.p_m;
      const Projection projection = Project(model_, intrinsics, R_b_a * v_a, jacobians != nullptr);
      if (!projection.in_front) return false;
      FillResidual(projection, i, residuals);
      if (jacobians != nullptr) FillRows(projection, chain, R_b_a, v_a, i, jacobians);
    }
    return true;
  }

 private:
  struct Chain {
    Se3 T_a_b, T_a_board;
  };

  void FillRows(const Projection& projection, const Chain& chain, const Eigen::Matrix3d& R_b_a,
                const Eigen::Vector3d& v_a, std::size_t i, double** jacobians) const {
    FillIntrinsicsRows(projection, i, jacobians);
    const PointJacobian d_v_a = projection.d_point * R_b_a;
    if (jacobians[1] != nullptr) {
      PoseRows d_T_a_b(jacobians[1] + i * 2 * kPoseSize);
      d_T_a_b.leftCols<3>() = -d_v_a;
      d_T_a_b.rightCols<4>() = projection.d_point * UnrotatedByQuaternion(chain.T_a_b.q, v_a);
    }
    if (jacobians[2] != nullptr) {
      PoseRows d_T_a_board(jacobians[2] + i * 2 * kPoseSize);
      d_T_a_board.leftCols<3>() = d_v_a;
      d_T_a_board.rightCols<4>() = d_v_a * RotatedByQuaternion(chain.T_a_board.q, Corner(i));
    }
  }
};

class GivenIntrinsicsCost final : public ceres::CostFunction {
 public:
  GivenIntrinsicsCost(CameraModel model, const IntrinsicsPull& pull) : count_(IntrinsicsCount(model)), pull_(pull) {
    set_num_residuals(count_);
    *mutable_parameter_block_sizes() = {count_};
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    for (int i = 0; i < count_; ++i) residuals[i] = pull_.Weight(i) * (blocks[0][i] - pull_.given[i]);
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    std::fill_n(jacobians[0], count_ * count_, 0.0);
    for (int i = 0; i < count_; ++i) jacobians[0][i * count_ + i] = pull_.Weight(i);
    return true;
  }

 private:
  int count_;
  IntrinsicsPull pull_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> MakeReferenceViewCost(CameraModel model,
                                                           const std::vector<Eigen::Vector3d>& corners_board,
                                                           const SeenCorners& seen) {
  return std::make_unique<ReferenceViewCost>(model, corners_board, seen);
}

std::unique_ptr<ceres::CostFunction> MakeSecondViewCost(CameraModel model,
                                                        const std::vector<Eigen::Vector3d>& corners_board,
                                                        const SeenCorners& seen) {
  return std::make_unique<SecondViewCost>(model, corners_board, seen);
}

std::unique_ptr<ceres::CostFunction> MakeGivenIntrinsicsCost(CameraModel model, const IntrinsicsPull& pull) {
  return std::make_unique<GivenIntrinsicsCost>(model, pull);
}

}  // namespace rigcal::calib
