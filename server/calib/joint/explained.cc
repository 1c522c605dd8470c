#include "server/calib/joint/explained.h"

#include <cmath>

#include "server/model/session_estimate.h"

namespace rigcal::calib::joint {
namespace {

constexpr int kMovesMax = 4;     // in one session: more is no bump, but a rig that is not rigid
constexpr int kFieldRounds = 3;  // of fields and everything else in turn

// Captures on both sides of the first place of `group` in which the sensor saw something.
SensorMovedWithin Told(const SessionProblem& problem, const Refined& refined, const SensorMove& move) {
  SensorMovedWithin told;
  told.sensor = problem.sensors[static_cast<std::size_t>(move.sensor)];
  told.step = move.step;
  told.odds = move.odds;
  int before = kNone, after = kNone;
  const auto look_at = [&](const auto& looks) {
    for (const auto& look : looks) {
      if (look.sensor != move.sensor) continue;
      const bool is_after = refined.group_of_place[static_cast<std::size_t>(look.place)] >= move.group;
      if (is_after && (after == kNone || look.place < after)) after = look.place;
      if (!is_after && look.place > before) before = look.place;
    }
  };
  look_at(problem.corners);
  look_at(problem.plates);
  look_at(problem.poses);
  if (before != kNone) told.last_before = CaptureAt(problem, before);
  if (after != kNone) told.first_after = CaptureAt(problem, after);
  return told;
}

// The sensor's looks from `group` on become those of a second sensor with a pose of its own.
SessionStart Split(SessionStart start, const Refined& refined, const SensorMove& move) {
  const auto old = static_cast<std::size_t>(move.sensor);
  const int added = static_cast<int>(start.problem.sensors.size());
  start.state = refined.state;
  start.noise = refined.noise;
  start.problem.sensors.push_back(start.problem.sensors[old]);
  start.problem.range_bias_sigma_m.push_back(start.problem.range_bias_sigma_m[old]);
  start.state.T_ref_sensor.push_back((start.state.T_ref_sensor[old] * Se3::Exp(move.step)).Normalized());
  start.state.range_bias_m.push_back(start.state.range_bias_m[old]);
  start.noise.push_back(start.noise[old]);
  const auto split = [&](auto& looks) {
    for (auto& look : looks)
      if (look.sensor == move.sensor && refined.group_of_place[static_cast<std::size_t>(look.place)] >= move.group)
        look.sensor = added;
  };
  split(start.problem.corners);
  split(start.problem.plates);
  split(start.problem.poses);
  // What was known of it from all captures together holds for neither of its poses.
  std::erase_if(start.problem.relatives, [&](const RelativeKnown& known) {
    return known.sensor_a == move.sensor || known.sensor_b == move.sensor;
  });
  return start;
}

std::optional<Explained> Again(SessionStart start, const std::vector<int>& group_of_place) {
  auto explained = Explain(std::move(start), group_of_place);
  return explained ? std::optional(std::move(*explained)) : std::nullopt;
}

// Fields are taken out and everything is refined again, until they stay as they are.
std::optional<Explained> WithMisfitsHeld(Explained now) {
  for (int round = 0; round < kFieldRounds; ++round) {
    SessionStart start = now.start;
    start.state = WithFields(start.problem, now.misfits, now.refined.state);
    start.noise = now.refined.noise;
    auto next = Again(std::move(start), now.refined.group_of_place);
    if (!next) return now.misfits.held ? std::optional(std::move(now)) : std::nullopt;
    const bool same = SameFields(now.misfits, next->misfits);
    now = std::move(*next);
    if (same) break;
  }
  return now;
}

// The likeliest move, where it is one.
std::optional<SensorMove> MoveIn(const Explained& now) {
  if (now.refined.groups < kGroupsForMoves) return std::nullopt;
  const std::vector<SensorMove> moves = ScanForMoves(now.start.problem, now.refined);
  if (moves.empty() || !IsMove(moves.front().step, moves.front().covariance, moves.front().odds)) return std::nullopt;
  const SensorMovedWithin told = Told(now.start.problem, now.refined, moves.front());
  if (told.last_before.empty() || told.first_after.empty()) return std::nullopt;
  return moves.front();
}

// Twice the negative logarithm of the likelihood of all that was seen, but for what is the same for any explanation, at
// the noise that it leaves; with what its fields and its moves had to choose from (Schwarz 1978).
double LeftOver(const Explained& explained) {
  const SessionProblem& problem = explained.start.problem;
  const SessionFit& fit = explained.refined.at_optimum.fit;
  double left = explained.misfits.held ? explained.misfits.components.complexity : 0.0;
  const auto add = [&](const LookFit& look, double weight, double sigma, double sigma_rad) {
    left += weight * look.squares.sum() + 2 * look.numbers[0] * std::log(sigma);
    if (look.numbers[1] > 0) left += 2 * look.numbers[1] * std::log(sigma_rad);
  };
  const auto add_all = [&](const auto& looks, const std::vector<LookFit>& fits, const std::vector<double>& weights) {
    for (std::size_t i = 0; i < looks.size(); ++i) {
      const SensorNoise& noise = explained.refined.noise[static_cast<std::size_t>(looks[i].sensor)];
      add(fits[i], weights[i], noise.sigma, noise.sigma_rad);
    }
  };
  add_all(problem.corners, fit.corners, explained.refined.weights.corners);
  add_all(problem.plates, fit.plates, explained.refined.weights.plates);
  add_all(problem.poses, fit.poses, explained.refined.weights.poses);
  return left + 6 * std::log(static_cast<double>(problem.corners.size())) * static_cast<double>(problem.sensors.size());
}

std::optional<Explained> WithMove(const Explained& now, const SensorMove& move) {
  auto next = Again(Split(now.start, now.refined, move), now.refined.group_of_place);
  return next && next->misfits.held ? WithMisfitsHeld(std::move(*next)) : std::move(next);
}

// A bump is in time, a misfit in the picture, and either looks a little like the other: of the two the one is taken out
// first that leaves less.
struct Next {
  std::optional<Explained> explained;
  bool is_move = false;
};
Next NextOf(const Explained& now, const std::optional<SensorMove>& move) {
  const bool bent = !now.misfits.held && now.misfits.any();
  Next by_move{move ? WithMove(now, *move) : std::nullopt, true};
  if (!bent) return by_move;
  Next by_field{WithMisfitsHeld(now), false};
  if (!by_field.explained) return by_move;
  if (by_move.explained && LeftOver(*by_move.explained) < LeftOver(*by_field.explained)) return by_move;
  return by_field;
}

}  // namespace

Result<Explained> Explain(SessionStart start, const std::vector<int>& group_of_place) {
  RIGCAL_ASSIGN(Refined refined, Refine(start.problem, start.state, start.noise, group_of_place));
  FoundMisfits misfits = FindMisfits(start.problem, refined);
  return Explained{std::move(start), std::move(refined), std::move(misfits)};
}

// What is found is taken out before the next is looked for, so that it does not hide it.
Explained ExplainAll(Explained now, std::vector<SensorMovedWithin>& moved) {
  while (true) {
    const std::optional<SensorMove> move = static_cast<int>(moved.size()) < kMovesMax ? MoveIn(now) : std::nullopt;
    Next next = NextOf(now, move);
    if (move && (next.is_move || !next.explained)) moved.push_back(Told(now.start.problem, now.refined, *move));
    if (!next.explained) return now;
    now = std::move(*next.explained);
  }
}

}  // namespace rigcal::calib::joint
