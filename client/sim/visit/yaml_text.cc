#include "client/sim/visit/yaml_text.h"

#include <array>
#include <charconv>

namespace rigcal::sim {

std::string Text(double value) {
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string Text(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + Text(value);
  return "[" + text + "]";
}

std::string Text(const Eigen::Ref<const Eigen::VectorXd>& values) {
  return Text(std::vector<double>(values.data(), values.data() + values.size()));
}

std::string Text(const Se3& T) {
  const Eigen::Vector4d q_xyzw = T.q.coeffs();
  return "{p_m: " + Text(Eigen::VectorXd(T.p_m)) + ", q_xyzw: " + Text(Eigen::VectorXd(q_xyzw)) + "}";
}

std::string Text(const CameraIntrinsics& intrinsics, const std::vector<double>* sigma) {
  std::string text = "{model: " + NameOf(intrinsics.model) + ", fx_px: " + Text(intrinsics.fx_px) +
                     ", fy_px: " + Text(intrinsics.fy_px) + ", cx_px: " + Text(intrinsics.cx_px) +
                     ", cy_px: " + Text(intrinsics.cy_px) + ", distortion: " + Text(intrinsics.distortion);
  if (sigma != nullptr) text += ", sigma: " + Text(*sigma);
  return text + "}";
}

}  // namespace rigcal::sim
