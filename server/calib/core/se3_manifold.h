// SE(3) for Ceres: block [p, q_xyzw], tangent [translation, rotation], Plus(T, xi) = T * Exp(xi).
#pragma once

#include <memory>

namespace ceres {
class Manifold;
}

namespace rigcal::calib {

[[nodiscard]] std::unique_ptr<ceres::Manifold> MakeSe3Manifold();

}  // namespace rigcal::calib
