#include "server/calib/costs/reference_view.h"

#include <ceres/cost_function.h>

#include "server/calib/pose_block.h"
#include "server/calib/projection.h"

namespace rigcal::calib {
namespace {

class ReferenceViewCost final : public ceres::CostFunction {
 public:
  ReferenceViewCost(const std::vector<Eigen::Vector3d>& corners_board, const std::vector<Eigen::Vector2d>& corners_px)
      : corners_board_(corners_board), corners_px_(corners_px) {
    set_num_residuals(static_cast<int>(2 * corners_px.size()));
    *mutable_parameter_block_sizes() = {kIntrinsicsCount, kPoseSize};
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const Eigen::Map<const IntrinsicsVector> intrinsics(blocks[0]);
    const Se3 T_a_board = PoseOf(blocks[1]);
    const Eigen::Matrix3d R_a_board = T_a_board.R();
    for (std::size_t i = 0; i < corners_px_.size(); ++i) {
      const Projection projection = Project(intrinsics, R_a_board * corners_board_[i] + T_a_board.p_m);
      if (!projection.in_front) return false;
      Eigen::Map<Eigen::Vector2d>(residuals + 2 * i) = projection.uv_px - corners_px_[i];
      if (jacobians != nullptr) FillRows(projection, T_a_board, i, jacobians);
    }
    return true;
  }

 private:
  void FillRows(const Projection& projection, const Se3& T_a_board, std::size_t i, double** jacobians) const {
    if (jacobians[0] != nullptr)
      Eigen::Map<Eigen::Matrix<double, 2, kIntrinsicsCount, Eigen::RowMajor>>(jacobians[0] + i * 2 * kIntrinsicsCount) =
          projection.d_intrinsics;
    if (jacobians[1] == nullptr) return;
    Eigen::Map<Eigen::Matrix<double, 2, kPoseSize, Eigen::RowMajor>> d_pose(jacobians[1] + i * 2 * kPoseSize);
    d_pose.leftCols<3>() = projection.d_point;
    d_pose.rightCols<4>() = projection.d_point * RotatedByQuaternion(T_a_board.q, corners_board_[i]);
  }

  const std::vector<Eigen::Vector3d>& corners_board_;
  const std::vector<Eigen::Vector2d>& corners_px_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> MakeReferenceViewCost(const std::vector<Eigen::Vector3d>& corners_board,
                                                           const std::vector<Eigen::Vector2d>& corners_px) {
  return std::make_unique<ReferenceViewCost>(corners_board, corners_px);
}

}  // namespace rigcal::calib
