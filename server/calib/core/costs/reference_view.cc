#include "server/calib/core/costs/reference_view.h"

#include <ceres/cost_function.h>

#include "server/calib/camera/projection.h"
#include "server/calib/core/pose_block.h"

namespace rigcal::calib {
namespace {

class ReferenceViewCost final : public ceres::CostFunction {
 public:
  ReferenceViewCost(CameraModel model, const std::vector<Eigen::Vector3d>& corners_board, const SeenCorners& seen)
      : model_(model), count_(IntrinsicsCount(model)), corners_board_(corners_board), seen_(seen) {
    set_num_residuals(static_cast<int>(2 * seen.size()));
    *mutable_parameter_block_sizes() = {count_, kPoseSize};
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const IntrinsicsVector intrinsics = PaddedIntrinsics(model_, blocks[0]);
    const Se3 T_a_board = PoseOf(blocks[1]);
    const Eigen::Matrix3d R_a_board = T_a_board.R();
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const Projection projection =
          Project(model_, intrinsics, R_a_board * Corner(i) + T_a_board.p_m, jacobians != nullptr);
      if (!projection.in_front) return false;
      Eigen::Map<Eigen::Vector2d>(residuals + 2 * i) = projection.uv_px - seen_.uv_px[i];
      if (jacobians != nullptr) FillRows(projection, T_a_board, i, jacobians);
    }
    return true;
  }

 private:
  void FillRows(const Projection& projection, const Se3& T_a_board, std::size_t i, double** jacobians) const {
    if (jacobians[0] != nullptr)
      CopyColumns(projection.d_intrinsics, count_, jacobians[0] + static_cast<std::ptrdiff_t>(i) * 2 * count_);
    if (jacobians[1] == nullptr) return;
    Eigen::Map<Eigen::Matrix<double, 2, kPoseSize, Eigen::RowMajor>> d_pose(jacobians[1] + i * 2 * kPoseSize);
    d_pose.leftCols<3>() = projection.d_point;
    d_pose.rightCols<4>() = projection.d_point * RotatedByQuaternion(T_a_board.q, Corner(i));
  }

  const Eigen::Vector3d& Corner(std::size_t i) const { return corners_board_[static_cast<std::size_t>(seen_.idx[i])]; }

  CameraModel model_;
  int count_;
  const std::vector<Eigen::Vector3d>& corners_board_;
  const SeenCorners& seen_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> MakeReferenceViewCost(CameraModel model,
                                                           const std::vector<Eigen::Vector3d>& corners_board,
                                                           const SeenCorners& seen) {
  return std::make_unique<ReferenceViewCost>(model, corners_board, seen);
}

}  // namespace rigcal::calib
