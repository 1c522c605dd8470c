#include "server/calib/joint/misfit/lost_sight.h"

#include <algorithm>

namespace rigcal::calib::joint {
namespace {

constexpr int kLostMin = 3;
constexpr int kSeenOfFive = 4;  // before the loss

// Whether a board was where it should be, per capture in the order of time. Several boards: one is enough.
using Sights = std::map<int, bool>;

std::map<SensorId, Sights> SightsOf(const SessionStart& start) {
  const SessionProblem& problem = start.problem;
  std::map<SensorId, Sights> sights;
  for (const UnusedLook& look : start.unused) {
    if (look.why != WhyUnused::kNoBoardThere) continue;
    const auto capture = std::find(problem.captures.begin(), problem.captures.end(), look.capture);
    sights[look.sensor][static_cast<int>(capture - problem.captures.begin())] = false;
  }
  for (const PlateSeen& plate : problem.plates)
    if (const auto lossy = sights.find(problem.sensors[static_cast<std::size_t>(plate.sensor)]); lossy != sights.end())
      lossy->second[problem.capture_of_place[static_cast<std::size_t>(plate.place)]] = true;
  return sights;
}

std::optional<LostSight> LossOf(const SensorId& sensor, const Sights& sights, const SessionProblem& problem,
                                std::size_t lidars) {
  const auto last_seen = std::find_if(sights.rbegin(), sights.rend(), [](const auto& one) { return one.second; });
  if (last_seen == sights.rend()) return std::nullopt;
  const auto first_lost = last_seen.base();
  const auto captures = static_cast<int>(sights.size());
  const auto lost = static_cast<int>(std::distance(first_lost, sights.end())), before = captures - lost;
  const auto unseen =
      static_cast<int>(std::count_if(sights.begin(), sights.end(), [](const auto& one) { return !one.second; }));
  if (lost < kLostMin || 5 * (before - (unseen - lost)) < kSeenOfFive * before) return std::nullopt;
  double odds = static_cast<double>(lidars);
  for (int i = 0; i < lost; ++i) odds *= static_cast<double>(unseen - i) / (captures - i);
  if (odds >= kMovedOdds) return std::nullopt;
  const auto name = [&](int capture) { return problem.captures[static_cast<std::size_t>(capture)]; };
  return LostSight{sensor, name(last_seen->first), name(first_lost->first), before, lost, odds};
}

}  // namespace

std::vector<LostSight> LostSightsTold(const SessionStart& start) {
  const auto sights = SightsOf(start);
  std::vector<LostSight> told;
  for (const auto& [sensor, of_sensor] : sights)
    if (auto loss = LossOf(sensor, of_sensor, start.problem, sights.size())) told.push_back(std::move(*loss));
  return told;
}

}  // namespace rigcal::calib::joint
