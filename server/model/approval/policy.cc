#include "server/model/approval/policy.h"

#include <algorithm>
#include <cmath>

namespace rigcal {
namespace {

template <typename T>
void Overlay(const std::optional<T>& narrow, std::optional<T>& wide) {
  if (narrow) wide = narrow;
}

void OverlayWords(const LimitWords& narrow, LimitWords& wide) {
  for (const LimitName& one : kLimitNames) Overlay(narrow.*one.value, wide.*one.value);
  Overlay(narrow.not_needed, wide.not_needed);
}

void Apply(const LimitWords& words, PoseLimits& limits) {
  limits.tolerance = {words.tolerance_m.value_or(limits.tolerance.m),
                      words.tolerance_rad.value_or(limits.tolerance.rad)};
  limits.moved_min = {words.moved_min_m.value_or(limits.moved_min.m),
                      words.moved_min_rad.value_or(limits.moved_min.rad)};
  limits.unseen_move = {words.unseen_move_m.value_or(limits.unseen_move.m),
                        words.unseen_move_rad.value_or(limits.unseen_move.rad)};
}

PoseLimit Wider(const PoseLimit& a, const PoseLimit& b) { return {std::max(a.m, b.m), std::max(a.rad, b.rad)}; }

PoseLimits Wider(const PoseLimits& a, const PoseLimits& b) {
  return {Wider(a.tolerance, b.tolerance), Wider(a.moved_min, b.moved_min), Wider(a.unseen_move, b.unseen_move)};
}

}  // namespace

std::string NameOf(ApprovalBy by) { return by == ApprovalBy::kPerson ? "person" : "automatic"; }

ApprovalBy ApprovalByOf(const std::string& name) {
  return name == NameOf(ApprovalBy::kPerson) ? ApprovalBy::kPerson : ApprovalBy::kAutomatic;
}

bool IsBeyond(const Vector6d& off, const PoseLimit& limit) {
  return off.head<3>().norm() > limit.m || off.tail<3>().norm() > limit.rad;
}

double TimesLimit(const Vector6d& off, const PoseLimit& limit) {
  return std::max(off.head<3>().norm() / limit.m, off.tail<3>().norm() / limit.rad);
}

Policy Overlaid(const Policy& wide, const Policy& narrow) {
  Policy sum = wide;
  OverlayWords(narrow.all, sum.all);
  for (const auto& [sensor, words] : narrow.sensors) OverlayWords(words, sum.sensors[sensor]);
  for (const auto& [pair, words] : narrow.pairs) OverlayWords(words, sum.pairs[pair]);
  Overlay(narrow.residual_max_m, sum.residual_max_m);
  Overlay(narrow.residual_max_rad, sum.residual_max_rad);
  Overlay(narrow.max_age_ns, sum.max_age_ns);
  Overlay(narrow.captures_min, sum.captures_min);
  Overlay(narrow.approval, sum.approval);
  Overlay(narrow.approve_warnings, sum.approve_warnings);
  Overlay(narrow.approve_drift, sum.approve_drift);
  Overlay(narrow.drift_false_alarm_ratio, sum.drift_false_alarm_ratio);
  Overlay(narrow.visits_in_full, sum.visits_in_full);
  return sum;
}

std::string FrameResultOf(const std::string& name, const SensorId& sensor) { return name + " of " + sensor.str(); }

PoseLimits LimitsOf(const Policy& policy, const SensorId& sensor) {
  LimitWords words = policy.all;
  if (const auto own = policy.sensors.find(sensor); own != policy.sensors.end()) OverlayWords(own->second, words);
  PoseLimits limits;
  Apply(words, limits);
  const auto focal = policy.focal_px.find(sensor);
  if (words.tolerance_px_at_10_m && focal != policy.focal_px.end())
    limits.tolerance.rad = std::min(limits.tolerance.rad, std::atan(*words.tolerance_px_at_10_m / focal->second));
  return limits;
}

PoseLimits LimitsOf(const Policy& policy, const SensorId& a, const SensorId& b) {
  PoseLimits limits = Wider(LimitsOf(policy, a), LimitsOf(policy, b));
  const auto own = policy.pairs.find({std::min(a, b), std::max(a, b)});
  if (own != policy.pairs.end()) Apply(own->second, limits);
  return limits;
}

PoseLimits LimitsOfLoop(const Policy& policy, std::span<const SensorId> sensors) {
  if (sensors.empty()) return LimitsOf(policy, SensorId());
  PoseLimits widest = LimitsOf(policy, sensors.back(), sensors.front());
  for (std::size_t k = 1; k < sensors.size(); ++k) widest = Wider(widest, LimitsOf(policy, sensors[k - 1], sensors[k]));
  return widest;
}

std::set<std::string> NotNeededOf(const Policy& policy, const SensorId& sensor) {
  LimitWords words = policy.all;
  if (const auto own = policy.sensors.find(sensor); own != policy.sensors.end()) OverlayWords(own->second, words);
  return words.not_needed.value_or(std::set<std::string>());
}

PoseLimit ResidualMaxOf(const Policy& policy) {
  return {policy.residual_max_m.value_or(kDefaultResidualMax.m),
          policy.residual_max_rad.value_or(kDefaultResidualMax.rad)};
}

}  // namespace rigcal
