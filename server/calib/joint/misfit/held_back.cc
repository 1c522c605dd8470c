#include "server/calib/joint/misfit/held_back.h"

#include <algorithm>
#include <map>
#include <set>

#include "server/calib/core/capture_blocks.h"
#include "server/calib/joint/misfit/moved_pose.h"

namespace rigcal::calib::joint {
namespace {

constexpr double kHeldBackBelow = 0.5;  // of a look's weight

// Per place.
std::vector<std::set<SensorId>> SensorsThatSaw(const SessionProblem& problem) {
  std::vector<std::set<SensorId>> sensors(problem.capture_of_place.size());
  ForEachLook(problem, [&](const Where& look) {
    sensors[static_cast<std::size_t>(look.place)].insert(problem.sensors[static_cast<std::size_t>(look.sensor)]);
  });
  return sensors;
}

// visit(look, is_held_back) of every look.
template <typename Visit>
void ForEachWeighed(const SessionProblem& problem, const LookWeights& weights, const Visit& visit) {
  const auto of = [&](const auto& looks, const std::vector<double>& weight) {
    for (std::size_t i = 0; i < looks.size(); ++i) visit(looks[i], weight[i] < kHeldBackBelow);
  };
  of(problem.corners, weights.corners);
  of(problem.plates, weights.plates);
  of(problem.poses, weights.poses);
}

struct LooksOfCapture {
  int all = 0, held_back = 0;
};

// By name, as one that was moved is two; captures by index.
std::map<SensorId, std::map<int, LooksOfCapture>> LooksOfSensors(const SessionProblem& problem,
                                                                 const LookWeights& weights) {
  std::map<SensorId, std::map<int, LooksOfCapture>> looks;
  ForEachWeighed(problem, weights, [&](const Where& look, bool is_held_back) {
    LooksOfCapture& of_capture = looks[problem.sensors[static_cast<std::size_t>(look.sensor)]]
                                      [problem.capture_of_place[static_cast<std::size_t>(look.place)]];
    ++of_capture.all;
    of_capture.held_back += is_held_back ? 1 : 0;
  });
  return looks;
}

// Of each sensor the captures at its end, by index, in which half of its looks or more are held back; the last first.
std::map<SensorId, std::vector<int>> HeldBackAtTheEnd(const SessionProblem& problem, const LookWeights& weights) {
  std::map<SensorId, std::vector<int>> at_the_end;
  for (const auto& [sensor, captures] : LooksOfSensors(problem, weights))
    for (auto one = captures.rbegin(); one != captures.rend() && 2 * one->second.held_back >= one->second.all; ++one)
      at_the_end[sensor].push_back(one->first);
  return at_the_end;
}

// Of one sensor's looks from a capture on, by index; the order of captures is not that of their names as texts.
bool IsFrom(const SessionProblem& problem, const Where& look, int first_capture) {
  return problem.capture_of_place[static_cast<std::size_t>(look.place)] >= first_capture;
}
bool IsOf(const SessionProblem& problem, const Where& look, const SensorId& sensor) {
  return problem.sensors[static_cast<std::size_t>(look.sensor)] == sensor;
}

// The one sensor that stands against this one in all of its captures from `first_capture` on; none where there is no
// such.
SensorId AgainstFrom(const SessionProblem& problem, const SensorId& sensor, int first_capture) {
  const auto saw = SensorsThatSaw(problem);
  std::set<SensorId> against;
  ForEachLook(problem, [&](const Where& look) {
    if (!IsOf(problem, look, sensor) || !IsFrom(problem, look, first_capture)) return;
    const std::set<SensorId>& all = saw[static_cast<std::size_t>(look.place)];
    against.insert(all.size() != 2 ? SensorId() : *all.begin() == sensor ? *all.rbegin() : *all.begin());
  });
  return against.size() == 1 ? *against.begin() : SensorId();
}

// The only board that a sensor saw from a capture on, where it stands still and nobody else saw it there as it was.
TargetId OnlyBoardFrom(const SessionProblem& problem, const LookWeights& weights, const SensorId& sensor,
                       int first_capture) {
  std::set<int> boards, seen_as_before;
  ForEachWeighed(problem, weights, [&](const Where& look, bool is_held_back) {
    if (!IsFrom(problem, look, first_capture)) return;
    if (IsOf(problem, look, sensor))
      boards.insert(look.board);
    else if (!is_held_back)
      seen_as_before.insert(look.board);
  });
  if (boards.size() != 1 || *boards.begin() == kNone || seen_as_before.contains(*boards.begin())) return {};
  return problem.boards[static_cast<std::size_t>(*boards.begin())].board;
}

// Captures from the first place of the move's group on in which its sensor saw something.
LateContradiction ContradictionOf(const SessionProblem& problem, const Refined& refined, const Move& move) {
  std::set<int> captures;
  ForEachLook(problem, [&](const Where& look) {
    const auto place = static_cast<std::size_t>(look.place);
    if (look.sensor == move.sensor && refined.groups.group_of_place[place] >= move.group)
      captures.insert(problem.capture_of_place[place]);
  });
  const auto name = [&](int sensor) {
    return sensor == kNone ? SensorId() : problem.sensors[static_cast<std::size_t>(sensor)];
  };
  return {name(move.sensor), problem.captures[static_cast<std::size_t>(*captures.begin())],
          static_cast<int>(captures.size()), name(move.or_sensor), TargetId()};
}

// Of several boards in one capture once.
void SortLooks(std::vector<HeldBackLook>& looks) {
  std::stable_sort(looks.begin(), looks.end(), [](const HeldBackLook& x, const HeldBackLook& y) {
    return x.sensor != y.sensor ? x.sensor < y.sensor : TakenBefore{}(x.capture, y.capture);
  });
  const auto same = [](const HeldBackLook& x, const HeldBackLook& y) {
    return x.sensor == y.sensor && x.capture == y.capture && x.against == y.against && x.why == y.why;
  };
  looks.erase(std::unique(looks.begin(), looks.end(), same), looks.end());
}

}  // namespace

std::vector<HeldBackLook> LooksHeldBack(const SessionProblem& problem, const Refined& refined) {
  const auto saw = SensorsThatSaw(problem);
  std::vector<HeldBackLook> held_back;
  ForEachWeighed(problem, refined.weights, [&](const Where& where, bool is_held_back) {
    if (!is_held_back) return;
    HeldBackLook look{problem.sensors[static_cast<std::size_t>(where.sensor)], CaptureAt(problem, where.place)};
    const std::set<SensorId>& all = saw[static_cast<std::size_t>(where.place)];
    if (all.size() == 2) look.against = *all.begin() == look.sensor ? *all.rbegin() : *all.begin();
    held_back.push_back(std::move(look));
  });
  SortLooks(held_back);
  return held_back;
}

std::vector<HeldBackLook> LooksLeftOut(const SessionStart& start) {
  std::vector<HeldBackLook> left_out;
  for (const UnusedLook& look : start.unused)
    if (look.why != WhyUnused::kNoBoardThere)  // LostSightsTold judges these
      left_out.push_back(
          {look.sensor,
           look.capture,
           {},
           look.why == WhyUnused::kPlaceUnknown ? WhyHeldBack::kPlaceUnknown : WhyHeldBack::kBehindTheCamera});
  SortLooks(left_out);
  return left_out;
}

std::vector<LateContradiction> LateContradictions(const SessionProblem& problem, const Refined& refined) {
  std::map<SensorId, LateContradiction> late;
  for (const Move& move : ScanForLateMoves(problem, refined)) {
    LateContradiction one = ContradictionOf(problem, refined, move);
    late.emplace(one.sensor, one);
  }
  for (const auto& [sensor, captures] : HeldBackAtTheEnd(problem, refined.weights)) {
    const CaptureId& first = problem.captures[static_cast<std::size_t>(captures.back())];
    late.insert_or_assign(sensor, LateContradiction{sensor, first, static_cast<int>(captures.size()),
                                                    AgainstFrom(problem, sensor, captures.back()), TargetId()});
  }
  std::vector<LateContradiction> by_sensor;
  for (auto& [sensor, one] : late) {
    const auto first = std::find(problem.captures.begin(), problem.captures.end(), one.first);
    one.or_board = OnlyBoardFrom(problem, refined.weights, sensor, static_cast<int>(first - problem.captures.begin()));
    one.or_world = std::any_of(problem.boards.begin(), problem.boards.end(),
                               [&](const StillFrame& frame) { return frame.tracker == sensor; });
    by_sensor.push_back(one);
  }
  return by_sensor;
}

}  // namespace rigcal::calib::joint
