#include "server/report/drawings/ring.h"

#include <algorithm>
#include <cmath>

namespace rigcal::report {

RingSize RingSizeOf(std::size_t sensors, std::size_t name_length) {
  constexpr double kCharacter_px = 11.5, kGap_px = 24;
  const auto radius_x = [name_length](double width_px) {
    return std::max(120.0, width_px / 2 - kGap_px - kCharacter_px * static_cast<double>(name_length));
  };
  if (sensors <= 2) return {700, 200, radius_x(700), 60};
  if (sensors <= 12) return {700, 460, std::min(radius_x(700), 235.0), 180};
  if (sensors <= 60) return {760, 620, std::min(radius_x(760), 270.0), 260};
  return {620, 620, 295, 295};
}

std::map<SensorId, Eigen::Vector2d> RingPlaces(const std::vector<SensorPose>& poses, const SensorId& reference,
                                               const RingSize& size) {
  std::vector<SensorId> order;
  for (const SensorPose& pose : poses)
    if (pose.sensor == reference) order.push_back(pose.sensor);
  for (const SensorPose& pose : poses)
    if (pose.sensor != reference) order.push_back(pose.sensor);
  const Eigen::Vector2d centre(size.width_px / 2, size.height_px / 2);
  std::map<SensorId, Eigen::Vector2d> places;
  const double start = order.size() <= 2 ? M_PI : -M_PI / 2;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double angle = start + 2 * M_PI * static_cast<double>(i) / static_cast<double>(order.size());
    const Eigen::Vector2d spoke(size.radius_x_px * std::cos(angle), size.radius_y_px * std::sin(angle));
    places[order[i]] = order.size() == 1 ? centre : Eigen::Vector2d(centre + spoke);
  }
  return places;
}

Curve CurveBetween(const Eigen::Vector2d& a, const Eigen::Vector2d& b, int nth, int count) {
  const Eigen::Vector2d along = b - a;
  const Eigen::Vector2d across =
      along.norm() > 0 ? Eigen::Vector2d(-along.y(), along.x()).normalized() : Eigen::Vector2d(0, 1);
  const double spread_px = std::min(44.0, 240.0 / count);
  const double bend_px = spread_px * (nth - (count - 1) / 2.0);
  return {a, (a + b) / 2 + across * bend_px * 2.0, b};
}

Eigen::Vector2d At(const Curve& curve, double t) {
  return (1 - t) * (1 - t) * curve.a + 2 * t * (1 - t) * curve.control + t * t * curve.b;
}

std::optional<Eigen::Vector2d> TagPlaces::Take(const Curve& curve, const Eigen::Vector2d& box_px) {
  for (const double t : {0.5, 0.42, 0.58, 0.34, 0.66, 0.27, 0.73}) {
    const Eigen::Vector2d centre = At(curve, t);
    if (!IsFree(centre, box_px)) continue;
    Block(centre, box_px);
    return centre;
  }
  return std::nullopt;
}

void TagPlaces::Block(const Eigen::Vector2d& centre_px, const Eigen::Vector2d& box_px) {
  taken_.emplace_back(centre_px, box_px);
}

bool TagPlaces::IsFree(const Eigen::Vector2d& centre_px, const Eigen::Vector2d& box_px) const {
  return std::none_of(taken_.begin(), taken_.end(), [&](const auto& other) {
    const Eigen::Vector2d apart = (centre_px - other.first).cwiseAbs();
    const Eigen::Vector2d reach = (box_px + other.second) / 2;
    return apart.x() < reach.x() && apart.y() < reach.y();
  });
}

}  // namespace rigcal::report
