#include <algorithm>
#include <iterator>
#include <map>

#include "server/graph/fusion/visit_sides.h"
#include "server/math/covariance.h"
#include "server/math/statistics.h"
#include "server/model/graph/connected.h"

namespace rigcal::graph {
namespace {

struct Found {
  SensorMovedBetween moved;
  Matrix6d covariance = Matrix6d::Zero();
  double gain = 0.0;
};

// Some visits: the change is before the element `first_after`, and one of `changes` that are asked about.
struct VisitsAbout {
  Visits visits;
  std::size_t first_after = 0;
  double changes = 1.0;
};

bool IsMove(const Found& found) {
  return rigcal::IsMove(found.moved.step, Observable(found.covariance).covariance, found.moved.odds);
}

std::size_t LastBefore(const VisitsAbout& about, const SensorId& sensor) {
  std::size_t k = about.first_after - 1;
  while (k > 0 && !about.visits.told[k].contains(sensor)) --k;
  return k;
}

std::size_t FirstAfter(const VisitsAbout& about, const SensorId& sensor) {
  std::size_t k = about.first_after;
  while (k + 1 < about.visits.told.size() && !about.visits.told[k].contains(sensor)) ++k;
  return k;
}

// Named by the visits nearest to the change that tell of the sensor: what is between them tells nothing of it. Of
// `looks` such, each as likely by chance as `tail`.
Found FoundBy(const Change& change, const VisitsAbout& about, double tail, double looks) {
  const std::vector<SessionEstimate>& sessions = about.visits.sessions;
  return {{change.sensor, sessions[LastBefore(about, change.sensor)].session,
           sessions[FirstAfter(about, change.sensor)].session, change.step, std::min(1.0, looks * tail)},
          change.covariance,
          change.gain};
}

// By the scatter that the sessions themselves show, of two none.
Found ShownBy(const BothSides& both, const VisitsAbout& about, const SensorId& reference) {
  const Change change = LikeliestChange(both.difference, reference);
  return FoundBy(change, about, TailOf(both.sides, change.gain), about.changes * both.sensors_asked);
}

// The two nearest to the change that tell of the sensor.
VisitsAbout NearestTwo(const VisitsAbout& about, const SensorId& sensor) {
  VisitsAbout two{{}, 1, 1.0};
  for (const std::size_t k : {LastBefore(about, sensor), FirstAfter(about, sensor)}) {
    two.visits.sessions.push_back(about.visits.sessions[k]);
    two.visits.told.push_back(about.visits.told[k]);
  }
  return two;
}

// Do more than two of the sessions tell of it? Else none tells what it scatters by.
bool ShowScatterOf(const SensorId& sensor, const Visits& visits) {
  return std::count_if(visits.told.begin(), visits.told.end(),
                       [&](const std::set<SensorId>& told) { return told.contains(sensor); }) > 2;
}

std::optional<Found> ChangeInFrame(const FusionInput& input, const VisitsAbout& about,
                                   const SensorsOfSessions& left_out) {
  auto both = SidesAbout(input, about.visits, about.first_after, left_out);
  if (!both) return std::nullopt;
  const Found found = ShownBy(*both, about, input.reference);
  const bool shown = IsMove(found);
  if (shown ? ShowScatterOf(found.moved.sensor, about.visits) : about.visits.sessions.size() <= 2) return found;
  // Of two visits nothing tells what a sensor scatters by, few tell little of it, and no F of few degrees of freedom is
  // ever unlikely. What the two about the change say by themselves stands unless the scatter of a sound mount explains
  // it.
  if (!shown) {
    const VisitsAbout two = NearestTwo(about, found.moved.sensor);
    const auto by_two = SidesAbout(input, two.visits, two.first_after, left_out);
    if (!by_two || !IsMove(ShownBy(*by_two, two, input.reference))) return found;
  }
  const double looks = about.changes * both->sensors_asked;
  const auto of_sound = DifferenceOfSoundMounts(std::move(both->sides));
  if (!of_sound) return found;
  const Change large = LikeliestChange(*of_sound, input.reference);
  return FoundBy(large, about, ChiSquareTail(large.gain, 6), looks);
}

// Of each sensor, how many of `told` tell of it.
std::map<SensorId, std::size_t> CountsOf(const std::vector<std::set<SensorId>>& told, std::size_t from,
                                         std::size_t to) {
  std::map<SensorId, std::size_t> counts;
  for (std::size_t k = from; k < to; ++k)
    for (const SensorId& sensor : told[k]) ++counts[sensor];
  return counts;
}

// In whose frame visits are held against each other: the reference's, or, where one side does not tell it as it was
// remounted since, that of the sensor which both sides tell the oftenest. No such: that of the reference.
SensorId FrameOf(const VisitsAbout& about, const SensorId& reference) {
  const auto before = CountsOf(about.visits.told, 0, about.first_after);
  const auto after = CountsOf(about.visits.told, about.first_after, about.visits.told.size());
  SensorId frame = reference;
  if (before.contains(reference) && after.contains(reference)) return frame;
  std::size_t most = 0;
  for (const auto& [sensor, count] : before) {
    const auto found = after.find(sensor);
    if (found == after.end() || std::min(count, found->second) <= most) continue;
    frame = sensor;
    most = std::min(count, found->second);
  }
  return frame;
}

// The frame above, and for each island that both sides tell apart from it the first of its sensors.
std::vector<SensorId> FramesOf(const VisitsAbout& about, const SensorId& reference) {
  const auto middle = about.visits.told.begin() + static_cast<std::ptrdiff_t>(about.first_after);
  const auto before = Connected({about.visits.told.begin(), middle}),
             after = Connected({middle, about.visits.told.end()});
  std::vector<SensorId> frames = {FrameOf(about, reference)};
  for (const std::set<SensorId>& x : before)
    for (const std::set<SensorId>& y : after) {
      std::vector<SensorId> both;
      std::set_intersection(x.begin(), x.end(), y.begin(), y.end(), std::back_inserter(both));
      if (both.size() >= 2 && !(x.contains(frames.front()) && y.contains(frames.front())))
        frames.push_back(both.front());
    }
  return frames;
}

std::optional<Found> LikelierOf(std::optional<Found> best, std::optional<Found> found) {
  if (!found || !IsMove(*found)) return best;
  const bool is_better = !best || found->moved.odds < best->moved.odds ||
                         (found->moved.odds == best->moved.odds && found->gain > best->gain);
  return is_better ? found : best;
}

std::optional<Found> ChangeIn(const FusionInput& input, const VisitsAbout& about, const SensorsOfSessions& left_out) {
  std::optional<Found> best;
  for (const SensorId& frame : FramesOf(about, input.reference)) {
    const GraphSolution start = frame == input.reference ? input.start : InFrameOf(frame, input.start);
    best = LikelierOf(std::move(best), ChangeInFrame({input.edges, input.within, frame, start}, about, left_out));
  }
  return best;
}

// Of each sensor so many visits on one side that there are kVisitsCompared on both, half of them on each where there
// are as many.
std::map<SensorId, std::size_t> WantedBeside(const std::map<SensorId, std::size_t>& others) {
  std::map<SensorId, std::size_t> wanted;
  for (const auto& [sensor, count] : others) wanted[sensor] = kVisitsCompared - std::min(count, kVisitsCompared / 2);
  return wanted;
}

bool TakesOneOf(const std::set<SensorId>& told, std::map<SensorId, std::size_t>& wanted) {
  bool takes = false;
  for (const SensorId& sensor : told) {
    const auto found = wanted.find(sensor);
    if (found == wanted.end() || found->second == 0) continue;
    --found->second;
    takes = true;
  }
  return takes;
}

// The nearest to a change before the element `first_after`. Not all: a step is held against the scatter about it, which
// neither another step of long ago nor a mount that creeps through the years belongs to.
VisitsAbout NearestTo(std::size_t first_after, const Visits& all) {
  const std::size_t count = all.sessions.size();
  auto before = WantedBeside(CountsOf(all.told, first_after, count));
  auto after = WantedBeside(CountsOf(all.told, 0, first_after));
  std::vector<std::size_t> taken;
  for (std::size_t k = first_after; k-- > 0;)
    if (TakesOneOf(all.told[k], before)) taken.push_back(k);
  std::reverse(taken.begin(), taken.end());
  VisitsAbout about{{}, taken.size(), static_cast<double>(count - 1)};
  for (std::size_t k = first_after; k < count; ++k)
    if (TakesOneOf(all.told[k], after)) taken.push_back(k);
  for (const std::size_t k : taken) {
    about.visits.sessions.push_back(all.sessions[k]);
    about.visits.told.push_back(all.told[k]);
  }
  return about;
}

std::optional<Found> LikeliestOf(const FusionInput& input, const std::vector<SessionEstimate>& oldest_first,
                                 const SensorsOfSessions& left_out) {
  Visits all{oldest_first, {}};
  for (const SessionEstimate& one : oldest_first) all.told.push_back(SensorsTold(input, one, left_out));
  std::optional<Found> best;
  for (std::size_t k = 1; k < oldest_first.size(); ++k) {
    const VisitsAbout about = NearestTo(k, all);
    if (about.first_after == 0 || about.first_after == about.visits.sessions.size()) continue;
    best = LikelierOf(std::move(best), ChangeIn(input, about, left_out));
  }
  return best;
}

}  // namespace

MovesBetween FindMovesBetween(const FusionInput& input, const std::vector<SessionEstimate>& estimates) {
  std::vector<SessionEstimate> oldest_first;
  for (const SessionEstimate& estimate : estimates)
    if (IsFused(estimate, input)) oldest_first.push_back(estimate);
  std::reverse(oldest_first.begin(), oldest_first.end());
  MovesBetween moves;
  SensorsOfSessions left_out;
  while (static_cast<int>(moves.moved.size()) < kMovesMax) {
    const auto found = LikeliestOf(input, oldest_first, left_out);
    if (!found) break;
    moves.moved.push_back(found->moved);
    for (const SessionEstimate& one : oldest_first) {
      left_out.insert({one.session, found->moved.sensor});
      if (one.session == found->moved.last_before) break;
    }
  }
  if (oldest_first.size() > kVisitsApart)
    oldest_first.erase(oldest_first.begin(), oldest_first.end() - static_cast<std::ptrdiff_t>(kVisitsApart));
  moves.apart = FindApart(input, oldest_first, left_out);
  return moves;
}

}  // namespace rigcal::graph
