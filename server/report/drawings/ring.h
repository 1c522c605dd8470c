// Geometry of the ring drawing: places of sensors, curves of edges, tags that do not cover each other.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "server/model/graph/graph.h"

namespace rigcal::report {

struct RingSize {
  double width_px, height_px, radius_x_px, radius_y_px;
};
// `name_length`: characters of the longest name beside the ring.
[[nodiscard]] RingSize RingSizeOf(std::size_t sensors, std::size_t name_length);
// Reference first (left for two sensors, else on top), the others clockwise in their order.
[[nodiscard]] std::map<SensorId, Eigen::Vector2d> RingPlaces(const std::vector<SensorPose>& poses,
                                                             const SensorId& reference, const RingSize& size);

// From a to b as a quadratic curve; several edges of one pair bend apart.
struct Curve {
  Eigen::Vector2d a, control, b;
};
// The nth of `count` between the two, counted from 0; the middle one of an odd number is straight.
[[nodiscard]] Curve CurveBetween(const Eigen::Vector2d& a, const Eigen::Vector2d& b, int nth, int count);
// `t` from 0 at a to 1 at b.
[[nodiscard]] Eigen::Vector2d At(const Curve& curve, double t);

// Finds a free place on the curve for a box of the given size; nothing if there is none.
class TagPlaces {
 public:
  // The box's middle, near the curve's if it can be; from then on the place is taken.
  [[nodiscard]] std::optional<Eigen::Vector2d> Take(const Curve& curve, const Eigen::Vector2d& box_px);
  // Keeps this place free of boxes.
  void Block(const Eigen::Vector2d& centre_px, const Eigen::Vector2d& box_px);

 private:
  [[nodiscard]] bool IsFree(const Eigen::Vector2d& centre_px, const Eigen::Vector2d& box_px) const;
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> taken_;
};

}  // namespace rigcal::report
