#include <algorithm>

#include "server/graph/fusion/visit_sides.h"
#include "server/math/covariance.h"
#include "server/math/statistics.h"

namespace rigcal::graph {
namespace {

struct Found {
  SensorMovedBetween moved;
  Matrix6d covariance = Matrix6d::Zero();
  double gain = 0.0;
  std::size_t first_after = 0;
};

bool IsMove(const Found& found) {
  return rigcal::IsMove(found.moved.step, Observable(found.covariance).covariance, found.moved.odds);
}

// Of `looks` such, each as likely by chance as `tail`.
Found FoundBy(const Change& change, const std::vector<SessionEstimate>& oldest_first, std::size_t first_after,
              double tail, double looks) {
  return {{change.sensor, oldest_first[first_after - 1].session, oldest_first[first_after].session, change.step,
           std::min(1.0, looks * tail)},
          change.covariance,
          change.gain,
          first_after};
}

// By the scatter that the sessions themselves show, of two none.
std::optional<Found> ShownBefore(const FusionInput& input, const std::vector<SessionEstimate>& oldest_first,
                                 std::size_t first_after, const SensorsOfSessions& left_out) {
  const auto both = SidesAbout(input, oldest_first, first_after, left_out);
  if (!both) return std::nullopt;
  const Change change = LikeliestChange(both->difference, input.reference);
  return FoundBy(change, oldest_first, first_after, TailOf(both->sides, change.gain), both->looks);
}

// Do more than two of the sessions tell of it? Else none tells what it scatters by.
bool ShowScatterOf(const SensorId& sensor, const FusionInput& input, const std::vector<SessionEstimate>& sessions,
                   const SensorsOfSessions& left_out) {
  return std::count_if(sessions.begin(), sessions.end(), [&](const SessionEstimate& one) {
           return SensorsTold(input, one, left_out).contains(sensor);
         }) > 2;
}

// `oldest_first`; the change is before its element `first_after`.
std::optional<Found> ChangeBefore(const FusionInput& input, const std::vector<SessionEstimate>& oldest_first,
                                  std::size_t first_after, const SensorsOfSessions& left_out) {
  const auto found = ShownBefore(input, oldest_first, first_after, left_out);
  if (!found) return found;
  const bool shown = IsMove(*found);
  if (shown ? ShowScatterOf(found->moved.sensor, input, oldest_first, left_out) : oldest_first.size() <= 2)
    return found;
  // Of two visits nothing tells what a sensor scatters by, few tell little of it, and no F of few degrees of freedom is
  // ever unlikely. What the two about the change say by themselves stands unless the scatter of a sound mount explains
  // it.
  const std::vector<SessionEstimate> two = {oldest_first[first_after - 1], oldest_first[first_after]};
  const auto by_two = shown ? found : ShownBefore(input, two, 1, left_out);
  if (!by_two || !IsMove(*by_two)) return found;
  const auto both = SidesAbout(input, oldest_first, first_after, left_out);
  const auto of_sound = both ? DifferenceOfSoundMounts(both->sides) : std::nullopt;
  if (!of_sound) return found;
  const Change large = LikeliestChange(*of_sound, input.reference);
  return FoundBy(large, oldest_first, first_after, ChiSquareTail(large.gain, 6), both->looks);
}

std::optional<Found> LikeliestOf(const FusionInput& input, const std::vector<SessionEstimate>& oldest_first,
                                 const SensorsOfSessions& left_out) {
  std::optional<Found> best;
  for (std::size_t k = 1; k < oldest_first.size(); ++k) {
    auto found = ChangeBefore(input, oldest_first, k, left_out);
    if (found && IsMove(*found) &&
        (!best || found->moved.odds < best->moved.odds ||
         (found->moved.odds == best->moved.odds && found->gain > best->gain)))
      best = std::move(found);
  }
  return best;
}

}  // namespace

MovesBetween FindMovesBetween(const FusionInput& input, const std::vector<SessionEstimate>& estimates) {
  std::vector<SessionEstimate> oldest_first;
  for (const SessionEstimate& estimate : estimates)
    if (oldest_first.size() < kVisitsCompared && IsFused(estimate, input)) oldest_first.push_back(estimate);
  std::reverse(oldest_first.begin(), oldest_first.end());
  MovesBetween moves;
  SensorsOfSessions left_out;
  while (static_cast<int>(moves.moved.size()) < kMovesMax) {
    const auto found = LikeliestOf(input, oldest_first, left_out);
    if (!found) break;
    moves.moved.push_back(found->moved);
    for (std::size_t k = 0; k < found->first_after; ++k)
      left_out.insert({oldest_first[k].session, found->moved.sensor});
  }
  moves.apart = FindApart(input, oldest_first, left_out);
  return moves;
}

}  // namespace rigcal::graph
