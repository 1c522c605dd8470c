#include "client/moments/pose_curve.h"

#include <algorithm>

namespace rigcal::moments {
namespace {

template <typename Timed>
std::size_t FirstAfter(const std::vector<Timed>& track, double t_s) {
  const auto after =
      std::upper_bound(track.begin(), track.end(), t_s, [](double at_s, const Timed& one) { return at_s < one.t_s; });
  return static_cast<std::size_t>(after - track.begin());
}

}  // namespace

std::optional<Se3> PoseAt(const std::vector<TimedPose>& track, double t_s) {
  const std::size_t after = FirstAfter(track, t_s);
  if (after < 2 || after + 1 >= track.size()) return std::nullopt;
  double at_s[4];
  Vector6d xi[4];
  const TimedPose& before = track[after - 1];
  for (std::size_t i = 0; i < 4; ++i) {
    const TimedPose& one = track[after - 2 + i];
    at_s[i] = one.t_s;
    xi[i] = (before.T_cam_board.Inverse() * one.T_cam_board).Log();
    if (i > 0 && !(at_s[i] - at_s[i - 1] <= kTrackGap_s && at_s[i] > at_s[i - 1])) return std::nullopt;
  }
  const double step_s = at_s[2] - at_s[1], part = (t_s - at_s[1]) / step_s;
  const Vector6d slope_1 = (xi[2] - xi[0]) / (at_s[2] - at_s[0]) * step_s;
  const Vector6d slope_2 = (xi[3] - xi[1]) / (at_s[3] - at_s[1]) * step_s;
  const double p2 = part * part, p3 = p2 * part;
  return before.T_cam_board *
         Se3::Exp((p3 - 2 * p2 + part) * slope_1 + (3 * p2 - 2 * p3) * xi[2] + (p3 - p2) * slope_2);
}

std::vector<TimedSpeed> SpeedsOf(const std::vector<TimedPose>& track, const Eigen::Vector3d& point_board_m) {
  std::vector<TimedSpeed> speeds;
  for (std::size_t i = 1; i < track.size(); ++i) {
    const double step_s = track[i].t_s - track[i - 1].t_s;
    if (!(step_s > 0 && step_s <= kTrackGap_s)) continue;
    const Se3 &now = track[i].T_cam_board, &before = track[i - 1].T_cam_board;
    speeds.push_back({(track[i].t_s + track[i - 1].t_s) / 2,
                      (now * point_board_m - before * point_board_m).norm() / step_s,
                      now.q.angularDistance(before.q) / step_s});
  }
  return speeds;
}

std::optional<TimedSpeed> SpeedAt(const std::vector<TimedSpeed>& speeds, double t_s) {
  const std::size_t after = FirstAfter(speeds, t_s);
  if (after == 0 || after == speeds.size()) return std::nullopt;
  const TimedSpeed &a = speeds[after - 1], &b = speeds[after];
  if (b.t_s - a.t_s > kTrackGap_s) return std::nullopt;
  const double part = (t_s - a.t_s) / (b.t_s - a.t_s);
  return TimedSpeed{t_s, a.m_s + part * (b.m_s - a.m_s), a.rad_s + part * (b.rad_s - a.rad_s)};
}

}  // namespace rigcal::moments
