#include "tests/bench/stream/waved_board.h"

#include <algorithm>
#include <cmath>

#include "client/sim/rig/random.h"

namespace rigcal {
namespace {

constexpr double kPeakOverMean = 1.875;  // of the speed of a stretch of least jerk
constexpr double kMoveMin_s = 0.4;
constexpr double kSway_m = 0.001, kSway_Hz = 0.5, kTremor_m = 0.0001, kTremor_Hz = 8;
constexpr double kSway_rad = 0.001, kTremor_rad = 0.0002;

// From 0 to 1 with least jerk: still at both ends.
double LeastJerk(double part) { return part * part * part * (10 + part * (6 * part - 15)); }

Se3 Between(const Se3& from, const Se3& to, double part) { return from * Se3::Exp(part * (from.Inverse() * to).Log()); }

double MoveSeconds(const Se3& from, const Se3& to, const WavedBoardOptions& options) {
  const Vector6d way = (from.Inverse() * to).Log();
  return std::max({kMoveMin_s, kPeakOverMean * way.head<3>().norm() / options.peak_m_s,
                   kPeakOverMean * way.tail<3>().norm() / options.peak_rad_s});
}

}  // namespace

WavedBoard::WavedBoard(const std::vector<Se3>& places, const WavedBoardOptions& options)
    : options_(options), middle_(places.front()) {
  for (std::size_t i = 0; i < places.size(); ++i) {
    stretches_.push_back({duration_s_, duration_s_ + options.pause_s, places[i], places[i]});
    duration_s_ += options.pause_s;
    if (i + 1 == places.size()) break;
    const double move_s = MoveSeconds(places[i], places[i + 1], options);
    stretches_.push_back({duration_s_, duration_s_ + move_s, places[i], places[i + 1]});
    duration_s_ += move_s;
  }
  Vector6d sum = Vector6d::Zero();
  for (const Se3& place : places) sum += (places.front().Inverse() * place).Log();
  middle_ = places.front() * Se3::Exp(sum / static_cast<double>(places.size()));
  for (const Se3& place : places) reach_ = reach_.cwiseMax((middle_.Inverse() * place).Log().cwiseAbs());
}

Se3 WavedBoard::T_world_body(double t_s) const {
  if (!options_.pauses) return Wandering(t_s) * HandAt(t_s);
  const auto stretch =
      std::find_if(stretches_.begin(), stretches_.end() - 1, [&](const Stretch& one) { return t_s < one.end_s; });
  const double part = std::clamp((t_s - stretch->begin_s) / (stretch->end_s - stretch->begin_s), 0.0, 1.0);
  return Between(stretch->from, stretch->to, LeastJerk(part)) * HandAt(t_s);
}

double WavedBoard::Speed_m_s(double t_s) const {
  constexpr double kStep_s = 1e-3;
  return (T_world_body(t_s + kStep_s).p_m - T_world_body(t_s).p_m).norm() / kStep_s;
}

// Every axis swings with a period of its own, so that the board never stands still.
Se3 WavedBoard::Wandering(double t_s) const {
  sim::Random random(sim::KeyOf(options_.seed, "wandering"));
  Vector6d xi;
  for (int i = 0; i < 6; ++i) {
    const double reach = i < 3 ? std::min(reach_[i], 0.16) : std::min(reach_[i], 0.35);
    const double peak = (i < 3 ? options_.peak_m_s : options_.peak_rad_s) / std::sqrt(3.0);
    const double rate_rad_s = peak / std::max(reach, 1e-3) * random.Uniform(0.85, 1.0);
    xi[i] = reach * std::sin(rate_rad_s * t_s + random.Uniform(0, 2 * M_PI));
  }
  return middle_ * Se3::Exp(xi);
}

Se3 WavedBoard::HandAt(double t_s) const {
  sim::Random random(sim::KeyOf(options_.seed, "hand"));
  Vector6d xi;
  for (int i = 0; i < 6; ++i) {
    const double sway_Hz = kSway_Hz * random.Uniform(0.7, 1.3), tremor_Hz = kTremor_Hz * random.Uniform(0.8, 1.2);
    xi[i] = (i < 3 ? kSway_m : kSway_rad) * std::sin(2 * M_PI * sway_Hz * t_s + random.Uniform(0, 2 * M_PI)) +
            (i < 3 ? kTremor_m : kTremor_rad) * std::sin(2 * M_PI * tremor_Hz * t_s + random.Uniform(0, 2 * M_PI));
  }
  return Se3::Exp(xi);
}

}  // namespace rigcal
