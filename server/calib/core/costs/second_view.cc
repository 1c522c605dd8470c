#include "server/calib/core/costs/second_view.h"

#include <ceres/cost_function.h>

#include "server/calib/camera/projection.h"
#include "server/calib/core/pose_block.h"

namespace rigcal::calib {
namespace {

using PoseRows = Eigen::Map<Eigen::Matrix<double, 2, kPoseSize, Eigen::RowMajor>>;

class SecondViewCost final : public ceres::CostFunction {
 public:
  SecondViewCost(CameraModel model, const std::vector<Eigen::Vector3d>& corners_board, const SeenCorners& seen)
      : model_(model), count_(IntrinsicsCount(model)), corners_board_(corners_board), seen_(seen) {
    set_num_residuals(static_cast<int>(2 * seen.size()));
    *mutable_parameter_block_sizes() = {count_, kPoseSize, kPoseSize};
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const IntrinsicsVector intrinsics = PaddedIntrinsics(model_, blocks[0]);
    const Chain chain{PoseOf(blocks[1]), PoseOf(blocks[2])};
    const Eigen::Matrix3d R_a_board = chain.T_a_board.R(), R_b_a = chain.T_a_b.R().transpose();
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      // Seen from the origin of b, in the axes of a.
      const Eigen::Vector3d v_a = R_a_board * Corner(i) + chain.T_a_board.p_m - chain.T_a_b.p_m;
      const Projection projection = Project(model_, intrinsics, R_b_a * v_a, jacobians != nullptr);
      if (!projection.in_front) return false;
      Eigen::Map<Eigen::Vector2d>(residuals + 2 * i) = projection.uv_px - seen_.uv_px[i];
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
    if (jacobians[0] != nullptr)
      CopyColumns(projection.d_intrinsics, count_, jacobians[0] + static_cast<std::ptrdiff_t>(i) * 2 * count_);
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

  const Eigen::Vector3d& Corner(std::size_t i) const { return corners_board_[static_cast<std::size_t>(seen_.idx[i])]; }

  CameraModel model_;
  int count_;
  const std::vector<Eigen::Vector3d>& corners_board_;
  const SeenCorners& seen_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> MakeSecondViewCost(CameraModel model,
                                                        const std::vector<Eigen::Vector3d>& corners_board,
                                                        const SeenCorners& seen) {
  return std::make_unique<SecondViewCost>(model, corners_board, seen);
}

}  // namespace rigcal::calib
