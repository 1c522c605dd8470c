#include "server/calib/joint/problem/session_problem.h"

#include <algorithm>
#include <map>

namespace rigcal::calib::joint {
namespace {

int Take(int count, Layout& layout) {
  layout.size += count;
  return layout.size - count;
}

Se3 MovedPose(const Se3& T, int at, const Eigen::VectorXd& step) {
  return at == kNone || at >= step.size() ? T : (T * Se3::Exp(step.segment<6>(at))).Normalized();
}

bool Matters(const SessionProblem& problem, int clock) {
  return std::any_of(problem.poses.begin(), problem.poses.end(),
                     [&](const PoseTold& told) { return told.clock == clock; });
}

}  // namespace

const CaptureId& CaptureAt(const SessionProblem& problem, int place) {
  return problem.captures[static_cast<std::size_t>(problem.capture_of_place[static_cast<std::size_t>(place)])];
}

std::map<SensorId, int> LastOfEach(const SessionProblem& problem) {
  std::vector<int> place(problem.sensors.size(), kNone);
  ForEachLook(problem, [&](const Where& look) {
    int& last = place[static_cast<std::size_t>(look.sensor)];
    last = std::max(last, look.place);
  });
  std::map<SensorId, int> last;
  for (int s = 0; s < static_cast<int>(problem.sensors.size()); ++s) {
    const auto [known, is_new] = last.try_emplace(problem.sensors[static_cast<std::size_t>(s)], s);
    if (!is_new && place[static_cast<std::size_t>(s)] > place[static_cast<std::size_t>(known->second)])
      known->second = s;
  }
  return last;
}

Layout LayoutOf(const SessionProblem& problem) {
  Layout layout;
  for (int s = 0; s < static_cast<int>(problem.sensors.size()); ++s)
    layout.pose.push_back(s == problem.reference ? kNone : Take(6, layout));
  for (const Lens& camera : problem.cameras)
    layout.lens.push_back(camera.refined.empty() ? kNone : Take(static_cast<int>(camera.refined.size()), layout));
  for (int b = 0; b < static_cast<int>(problem.boards.size()); ++b)
    layout.board.push_back(b == problem.held_board ? kNone : Take(6, layout));
  for (const Target& target : problem.targets)
    layout.scale.push_back(target.square_sigma_m > 0 ? Take(1, layout) : kNone);
  for (const double sigma_m : problem.range_bias_sigma_m) layout.bias.push_back(sigma_m > 0 ? Take(1, layout) : kNone);
  for (int c = 0; c < static_cast<int>(problem.clocks.size()); ++c)
    layout.clock.push_back(Matters(problem, c) ? Take(1, layout) : kNone);
  for (const double sigma_m : problem.slant_bias_sigma_m) layout.slant.push_back(sigma_m > 0 ? Take(1, layout) : kNone);
  for (const Lens& camera : problem.cameras) layout.pupil.push_back(camera.pupil_sigma_m > 0 ? Take(1, layout) : kNone);
  for (const double sigma_m : problem.bend_sigma_m) layout.bend.push_back(sigma_m > 0 ? Take(3, layout) : kNone);
  for (const double sigma : problem.strain_sigma_ratio) layout.strain.push_back(sigma > 0 ? Take(3, layout) : kNone);
  layout.pose[static_cast<std::size_t>(problem.reference)] = layout.size;
  layout.columns = layout.size + 6;
  if (problem.held_board != kNone) {
    layout.board[static_cast<std::size_t>(problem.held_board)] = layout.columns;
    layout.columns += 6;
  }
  return layout;
}

SessionState Moved(const SessionProblem& problem, const Layout& layout, const SessionState& state,
                   const Eigen::VectorXd& step, const std::vector<Vector6d>& place_steps) {
  SessionState moved = state;
  for (std::size_t s = 0; s < layout.pose.size(); ++s)
    moved.T_ref_sensor[s] = MovedPose(state.T_ref_sensor[s], layout.pose[s], step);
  for (std::size_t c = 0; c < layout.lens.size(); ++c)
    for (std::size_t i = 0; i < problem.cameras[c].refined.size(); ++i)
      moved.intrinsics[c][problem.cameras[c].refined[i]] += step[layout.lens[c] + static_cast<int>(i)];
  for (std::size_t b = 0; b < layout.board.size(); ++b)
    moved.T_world_board[b] = MovedPose(state.T_world_board[b], layout.board[b], step);
  const auto move = [&](const std::vector<int>& at, std::vector<double>& numbers) {
    for (std::size_t i = 0; i < at.size(); ++i)
      if (at[i] != kNone) numbers[i] += step[at[i]];
  };
  move(layout.scale, moved.board_scale_ratio);
  move(layout.bias, moved.range_bias_m);
  move(layout.clock, moved.clock_late_s);
  move(layout.slant, moved.slant_bias_m);
  move(layout.pupil, moved.pupil_shift_m);
  const auto move_three = [&](const std::vector<int>& at, std::vector<Eigen::Vector3d>& numbers) {
    for (std::size_t t = 0; t < at.size(); ++t)
      if (at[t] != kNone) numbers[t] += step.segment<3>(at[t]);
  };
  move_three(layout.bend, moved.board_bend_m);
  move_three(layout.strain, moved.print_strain_ratio);
  for (std::size_t p = 0; p < place_steps.size(); ++p)
    moved.T_world_ref[p] = (state.T_world_ref[p] * Se3::Exp(place_steps[p])).Normalized();
  return moved;
}

}  // namespace rigcal::calib::joint
