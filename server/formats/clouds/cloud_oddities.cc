#include "server/formats/clouds/cloud_oddities.h"

#include <algorithm>
#include <vector>

#include "server/formats/clouds/cloud_table.h"

namespace rigcal::formats {
namespace {

constexpr float kBall_m = 0.001f;
constexpr std::size_t kPointsToJudge = 100;  // of fewer nothing is said, nor of fewer outside of a ball expected

// If most of the points are in one small ball, so is the median of each coordinate.
Eigen::Vector3f MedianOf(const std::vector<Eigen::Vector3f>& points_m) {
  Eigen::Vector3f median_m;
  std::vector<float> values(points_m.size());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = points_m[i][axis];
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    median_m[axis] = *middle;
  }
  return median_m;
}

struct Ball {
  std::size_t points = 0;
  bool at_zero = false;
};

// Nine tenths or more of the points; else none.
Ball BallOf(const std::vector<Eigen::Vector3f>& points_m) {
  if (points_m.size() < kPointsToJudge) return {};
  const Eigen::Vector3f middle_m = MedianOf(points_m);
  const auto inside = static_cast<std::size_t>(std::count_if(
      points_m.begin(), points_m.end(), [&](const Eigen::Vector3f& p) { return (p - middle_m).norm() <= kBall_m; }));
  if (10 * inside < 9 * points_m.size()) return {};
  return {inside, middle_m == Eigen::Vector3f::Zero()};
}

std::string Of(std::size_t count, std::size_t all) {
  return std::to_string(count) + " of " + std::to_string(all) + " points";
}

}  // namespace

std::string OdditiesOf(const Cloud& cloud) {
  const std::size_t all = cloud.points_m.size() + cloud.dropped, without_return = cloud.dropped - cloud.beyond_1km;
  std::string text;
  const auto add = [&](const std::string& sentence) { text += (text.empty() ? "" : "; ") + sentence; };
  if (cloud.beyond_1km > 0)
    add(Of(cloud.beyond_1km, all) + " lie beyond 1 km and are left out: the unit is not metres, or the layout another");
  if (all >= kPointsToJudge && (2 * without_return >= all || cloud.beyond_1km > 0) && without_return > 0)
    add(Of(without_return, all) + " have no finite coordinates: beams without a return, or another layout");
  const Ball ball = BallOf(cloud.points_m);
  if (ball.points > 0 && ball.at_zero) add(Of(ball.points, all) + " are at 0, 0, 0: beams without a return");
  if (ball.points > 0 && !ball.at_zero)
    add(Of(ball.points, all) + " lie within 1 mm of one place: the unit is not metres, or the layout another");
  return text;
}

Status CheckUseful(const Cloud& cloud, const std::string& name) {
  const Ball ball = BallOf(cloud.points_m);
  if (ball.points == 0 || cloud.points_m.size() - ball.points >= kPointsToJudge) return {};
  return RefuseCloud(name, OdditiesOf(cloud),
                     ball.at_zero
                         ? "Record the capture again with something in the lidar's view."
                         : "Save the cloud in metres; of a .bin, check fields and point_type in session.yaml.");
}

}  // namespace rigcal::formats
