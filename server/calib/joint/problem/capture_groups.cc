#include "server/calib/joint/problem/capture_groups.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace rigcal::calib::joint {
namespace {

// Poses of the rig nearer than this to where a burst or a view began belong to it: a slow drive is not one.
constexpr double kBurst_m = 0.01, kBurst_rad = 0.01;

std::vector<int> ViewsOf(const std::vector<Se3>& T_world_ref) {
  std::vector<std::size_t> first;
  std::vector<int> view;
  for (std::size_t p = 0; p < T_world_ref.size(); ++p) {
    const auto near = std::find_if(first.begin(), first.end(), [&](std::size_t f) {
      return AreNear(T_world_ref[f], T_world_ref[p], kBurst_m, kBurst_rad);
    });
    view.push_back(static_cast<int>(near - first.begin()));
    if (near == first.end()) first.push_back(p);
  }
  return view;
}

}  // namespace

CaptureGroups GroupsOf(const SessionProblem& problem, const SessionState& state, int groups_max) {
  const std::size_t places = problem.capture_of_place.size();
  std::vector<int> burst(places, 0);
  for (std::size_t p = 1, first = 0; p < places; ++p) {
    const bool same = problem.capture_of_place[p] == problem.capture_of_place[p - 1] ||
                      AreNear(state.T_world_ref[first], state.T_world_ref[p], kBurst_m, kBurst_rad);
    burst[p] = burst[p - 1] + (same ? 0 : 1);
    if (!same) first = p;
  }
  CaptureGroups groups{ViewsOf(state.T_world_ref), burst};
  const int bursts = groups.groups();
  groups.are_merged = bursts > groups_max;
  if (groups.are_merged)
    for (int& group : groups.group_of_place)
      group = static_cast<int>(static_cast<std::int64_t>(group) * groups_max / bursts);
  return groups;
}

std::vector<std::vector<std::size_t>> RepeatsOfCorners(const SessionProblem& problem, const CaptureGroups& groups) {
  std::map<std::tuple<int, int, int, int>, std::vector<std::size_t>> looks;
  for (std::size_t i = 0; i < problem.corners.size(); ++i) {
    const Where& look = problem.corners[i];
    looks[{look.sensor, groups.view_of_place[static_cast<std::size_t>(look.place)], look.board, look.target}].push_back(
        i);
  }
  std::vector<std::vector<std::size_t>> repeats;
  for (auto& [key, all] : looks)
    if (all.size() > 1) repeats.push_back(std::move(all));
  return repeats;
}

}  // namespace rigcal::calib::joint
