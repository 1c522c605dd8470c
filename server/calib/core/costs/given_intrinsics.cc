#include "server/calib/core/costs/given_intrinsics.h"

#include <ceres/cost_function.h>

#include <algorithm>

namespace rigcal::calib {
namespace {

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

std::unique_ptr<ceres::CostFunction> MakeGivenIntrinsicsCost(CameraModel model, const IntrinsicsPull& pull) {
  return std::make_unique<GivenIntrinsicsCost>(model, pull);
}

}  // namespace rigcal::calib
