// How a body moved about one instant, by the path that its tracker told around it.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "server/math/se3.h"
#include "server/model/sensors/pose_table.h"

namespace rigcal::calib {

constexpr double kLocalPathHalf_s = 0.15;  // on either side

// T(t) = T(0) Exp(xi(t)), t in seconds after the instant by the tracker's clock. xi is a polynomial of t - about_s;
// beyond kLocalPathHalf_s from there it goes on straight. By default the body stands still.
struct LocalPath {
  double about_s = 0.0;
  Eigen::Matrix<double, 6, 4> by_power = Eigen::Matrix<double, 6, 4>::Zero();  // column i: m and rad per s^i

  [[nodiscard]] Se3 StepTo(double t_s) const;        // T(0)^-1 T(t)
  [[nodiscard]] Vector6d TwistAt(double t_s) const;  // per second, right tangent: T(t + h) ~ T(t) Exp(h twist)
};

struct LocalPathFit {
  LocalPath path;
  Eigen::Vector2d squares = Eigen::Vector2d::Zero();  // sums over the residuals of rows: m^2, rad^2
  double redundancy = 0.0;                            // numbers more than coefficients, in each of both
  double velocity_gain_per_s2 = 0.0;                  // variance of a coordinate of the velocity over that of a row
};
// Least squares over the rows of `path`, sorted by stamp, within kLocalPathHalf_s of `about_s` after `instant`, of
// third degree where there are eight rows or more, else of a lower one. The curve goes through `T_told`, the pose that
// is told for the instant, at the instant. Nothing where there are fewer than four rows, none on one side, or a gap of
// half the span.
[[nodiscard]] std::optional<LocalPathFit> FitLocalPath(const PoseTable& path, Stamp instant, const Se3& T_told,
                                                       double about_s = 0.0);

}  // namespace rigcal::calib
