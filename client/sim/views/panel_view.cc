#include "client/sim/views/panel_view.h"

#include <algorithm>

namespace rigcal::sim {

std::vector<PanelView> PanelViews(const Scene& scene, const Se3& T_world_cam) {
  std::vector<PanelView> views;
  const Eigen::Matrix3d R_cam_world = T_world_cam.R().transpose();
  for (const Panel& panel : scene.panels) {
    const Eigen::Vector3d offset = panel.middle_m - T_world_cam.p_m;
    const double plane_m = panel.outward.dot(offset);  // negative: seen from its front
    if (plane_m >= -1e-6 && (panel.board_idx < 0 || plane_m <= 1e-6)) continue;
    const double sign = plane_m < 0 ? -1 : 1;
    const Eigen::Vector3d n = sign * panel.outward;
    const auto numerator = [&](const Eigen::Vector3d& axis) {
      return Eigen::Vector3f((R_cam_world * (-axis.dot(offset) * n + std::abs(plane_m) * axis)).cast<float>());
    };
    const double farthest_m = offset.norm() + panel.half_m.norm();
    views.push_back({&panel, numerator(panel.u), numerator(panel.v), (R_cam_world * n).cast<float>(),
                     static_cast<float>(std::abs(plane_m)), static_cast<float>(0.5 * std::abs(plane_m) / farthest_m),
                     plane_m > 0, Eigen::Vector3d(-panel.u.dot(offset), -panel.v.dot(offset), -plane_m).cast<float>()});
  }
  return views;
}

Cover CoverOf(const PanelView& view, const Eigen::Vector3f (&rays)[9], float pitch_px, float soft_px) {
  Eigen::Array2f low = Eigen::Array2f::Constant(1e30f), high = -low;
  int before = 0;
  for (const Eigen::Vector3f& ray : rays) {
    const float d = view.D.dot(ray);
    if (!(d > view.least)) continue;
    ++before;
    const Eigen::Array2f ab(view.Na.dot(ray) / d, view.Nb.dot(ray) / d);
    low = low.min(ab), high = high.max(ab);
  }
  if (before == 0) return Cover::kNone;
  if (before < 9) return Cover::kPart;
  // The lens bends what is straight between the rays; what a pixel spans is taken from the whole bundle.
  const Eigen::Array2f half = view.panel->half_m.cast<float>().array(), span = high - low;
  const Eigen::Array2f soft = span * (0.05f + soft_px / pitch_px);
  if ((low - soft > half).any() || (high + soft < -half).any()) return Cover::kNone;
  return (low - soft > -half).all() && (high + soft < half).all() ? Cover::kWhole : Cover::kPart;
}

}  // namespace rigcal::sim
