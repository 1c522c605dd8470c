// Values as YAML, on one line each; numbers in their shortest form that reads back as the same.
#pragma once

#include <string>
#include <vector>

#include "server/math/se3.h"
#include "server/model/sensors/camera.h"

namespace rigcal::sim {

// The shortest digits that read back as the same number.
[[nodiscard]] std::string Text(double value);
[[nodiscard]] std::string Text(const std::vector<double>& values);                // [1, 2]
[[nodiscard]] std::string Text(const Eigen::Ref<const Eigen::VectorXd>& values);  // as that list
[[nodiscard]] std::string Text(const Se3& T);                                     // {p_m: [...], q_xyzw: [...]}
// fx_px ... distortion, as in session.yaml; `sigma` may be null.
[[nodiscard]] std::string Text(const CameraIntrinsics& intrinsics, const std::vector<double>* sigma);

}  // namespace rigcal::sim
