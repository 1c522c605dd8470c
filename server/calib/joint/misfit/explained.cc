#include "server/calib/joint/misfit/explained.h"

#include <algorithm>
#include <cmath>

#include "server/calib/joint/misfit/given_lens.h"
#include "server/calib/joint/misfit/left_over.h"
#include "server/calib/joint/misfit/refocused_lens.h"
#include "server/math/covariance.h"

namespace rigcal::calib::joint {
namespace {

constexpr int kMovesMax = 4;  // in one session: more is no bump, but a rig that is not rigid; of a tracker with a world
                              // of its own likewise, which drifts
constexpr int kMovesTried = 3;   // of the likeliest; those too small to be told hide no other
constexpr int kFieldRounds = 3;  // of fields and everything else in turn

bool IsOf(const Move& move, const Where& look) {
  return move.board == kNone ? look.sensor == move.sensor : look.board == move.board;
}

bool IsAfter(const Refined& refined, const Move& move, const Where& look) {
  return refined.groups.group_of_place[static_cast<std::size_t>(look.place)] >= move.group;
}

// Captures on both sides of the first place of `group`, and `margin` groups from it, in which the one that moved was
// seen; kNone: in none.
struct Sides {
  int before = kNone, after = kNone;
  [[nodiscard]] bool both() const { return before != kNone && after != kNone; }
};
Sides SidesOf(const SessionProblem& problem, const Refined& refined, const Move& move, int margin = 0) {
  Sides sides;
  ForEachLook(problem, [&](const Where& look) {
    if (!IsOf(move, look)) return;
    const int group = refined.groups.group_of_place[static_cast<std::size_t>(look.place)];
    if (group >= move.group + margin && (sides.after == kNone || look.place < sides.after)) sides.after = look.place;
    if (group < move.group - margin && look.place > sides.before) sides.before = look.place;
  });
  return sides;
}

// Between which captures it surely was: somewhere in two groups of several bursts each.
Sides ToldSides(const SessionProblem& problem, const Refined& refined, const Move& move) {
  const Sides wide = SidesOf(problem, refined, move, refined.groups.are_merged ? 1 : 0);
  return wide.both() ? wide : SidesOf(problem, refined, move);
}

void Tell(const SessionProblem& problem, const Refined& refined, const Move& move, SessionEstimate& told) {
  const Sides sides = ToldSides(problem, refined, move);
  const CaptureId &before = CaptureAt(problem, sides.before), &after = CaptureAt(problem, sides.after);
  const auto sensor = [&](int s) { return s == kNone ? SensorId() : problem.sensors[static_cast<std::size_t>(s)]; };
  const auto still = [&](int b) { return b == kNone ? StillFrame{} : problem.boards[static_cast<std::size_t>(b)]; };
  const StillFrame frame = still(move.board), other = still(move.or_board);
  if (move.board == kNone)
    told.moved.push_back({sensor(move.sensor), before, after, move.step, move.odds, move.lens, sensor(move.or_sensor),
                          other.board, other.tracker});
  else
    told.boards_moved.push_back({frame.board, before, after, move.step, move.odds, other.board, frame.tracker});
}

void AddSensorLike(int sensor, const Vector6d& step, SessionStart& start) {
  const auto old = static_cast<std::size_t>(sensor);
  start.problem.sensors.push_back(start.problem.sensors[old]);
  start.problem.range_bias_sigma_m.push_back(start.problem.range_bias_sigma_m[old]);
  start.problem.slant_bias_sigma_m.push_back(start.problem.slant_bias_sigma_m[old]);
  start.state.T_ref_sensor.push_back((start.state.T_ref_sensor[old] * Se3::Exp(step)).Normalized());
  start.state.range_bias_m.push_back(start.state.range_bias_m[old]);
  start.state.slant_bias_m.push_back(start.state.slant_bias_m[old]);
  start.noise.push_back(start.noise[old]);
  // What was known of it from all captures together holds for neither of its poses.
  std::erase_if(start.problem.relatives,
                [&](const RelativeKnown& known) { return known.sensor_a == sensor || known.sensor_b == sensor; });
}

void AddBoardLike(int board, const Vector6d& step, SessionStart& start) {
  const auto old = static_cast<std::size_t>(board);
  start.problem.boards.push_back(start.problem.boards[old]);
  start.state.T_world_board.push_back((start.state.T_world_board[old] * Se3::Exp(step)).Normalized());
}

// Looks from `group` on become those of a second sensor, or at a second board, with a pose of its own.
SessionStart Split(SessionStart start, const Refined& refined, const Move& move) {
  start.state = refined.state;
  start.noise = refined.noise;
  const bool is_board = move.board != kNone;
  const int added = static_cast<int>(is_board ? start.problem.boards.size() : start.problem.sensors.size());
  if (is_board)
    AddBoardLike(move.board, move.step, start);
  else
    AddSensorLike(move.sensor, move.step, start);
  const auto split = [&](auto& looks) {
    for (auto& look : looks)
      if (IsOf(move, look) && IsAfter(refined, move, look)) (is_board ? look.board : look.sensor) = added;
  };
  split(start.problem.corners);
  split(start.problem.plates);
  split(start.problem.poses);
  return start;
}

std::optional<Explained> Again(SessionStart start, const CaptureGroups& groups) {
  auto explained = Explain(std::move(start), groups);
  return explained ? std::optional(std::move(*explained)) : std::nullopt;
}

// Fields are taken out and everything is refined again, until they stay as they are.
std::optional<Explained> WithMisfitsHeld(Explained now) {
  for (int round = 0; round < kFieldRounds; ++round) {
    SessionStart start = now.start;
    start.state = WithFields(start.problem, now.misfits, now.refined.state);
    start.noise = now.refined.noise;
    auto next = Again(std::move(start), now.refined.groups);
    if (!next) return now.misfits.held ? std::optional(std::move(now)) : std::nullopt;
    const bool same = SameFields(now.misfits, next->misfits);
    now = std::move(*next);
    if (same) break;
  }
  return now;
}

// T_before^-1 T_after of the two that `move` has become, and the information on it: the scan's own step is that of a
// sensor whose noise holds the bump.
struct Step {
  Vector6d step = Vector6d::Zero();
  Matrix6d information = Matrix6d::Zero();
};
Step StepBetween(int first, int second, const Refined& split, const Move& move) {
  const bool is_board = move.board != kNone;
  const auto& T = is_board ? split.state.T_world_board : split.state.T_ref_sensor;
  const std::vector<int>& rows = is_board ? split.layout.board : split.layout.pose;
  const auto before = static_cast<std::size_t>(first), after = static_cast<std::size_t>(second);
  const Se3 T_before_after = T[before].Inverse() * T[after];
  Matrix6d C = Matrix6d::Zero();
  const auto add = [&](const Matrix6d& by_row, int row, const Matrix6d& by_column, int column) {
    if (row + 6 <= split.layout.size && column + 6 <= split.layout.size)  // what is never moved has none
      C += by_row * split.covariance.block<6, 6>(row, column) * by_column.transpose();
  };
  const Matrix6d by_after = Matrix6d::Identity(), by_before = -Adjoint(T_before_after.Inverse());
  add(by_before, rows[before], by_before, rows[before]);
  add(by_before, rows[before], by_after, rows[after]);
  add(by_after, rows[after], by_before, rows[before]);
  add(by_after, rows[after], by_after, rows[after]);
  return {T_before_after.Log(), Observable(C).covariance / std::max(1.0, move.scatter)};
}

int PosesOf(const SessionProblem& problem, const Move& move) {
  return static_cast<int>(move.board == kNone ? problem.sensors.size() : problem.boards.size());
}

int FirstOf(const Move& move) { return move.board == kNone ? move.sensor : move.board; }

Step StepOf(const Explained& split, const Move& move) {
  return StepBetween(FirstOf(move), PosesOf(split.start.problem, move) - 1, split.refined, move);
}

struct Next {
  std::optional<Explained> explained;
  std::optional<Move> move;
  std::vector<ContradictedLens> lenses = {};
};

// A move of a camera against a change of its lens: the better of the two, and both of them told unless one is it beyond
// doubt.
Next MoveOrLens(const Explained& now, Next next) {
  if (!next.explained || next.move->board != kNone) return next;
  auto start = WithSecondLens(now.start, now.refined, next.move->sensor, next.move->group);
  if (!start) return next;
  auto by_lens = Again(std::move(*start), now.refined.groups);
  if (!by_lens) return next;
  const std::vector<double>& in_burst = now.refined.weights.in_burst;
  const SensorId& name = now.start.problem.sensors[static_cast<std::size_t>(next.move->sensor)];
  const double lens_better = UnexplainedInTwo(*next.explained, in_burst, name, next.move->group) -
                             UnexplainedInTwo(*by_lens, in_burst, name, next.move->group);
  if (lens_better < -kBeyondDoubt) return next;
  next.move->lens = FocalChangeOf(by_lens->start.problem, by_lens->refined);
  // Two lenses may have a field each, which one pose more does not: then that may be what is better.
  next.move->lens->surely = lens_better > kBeyondDoubt && !next.explained->misfits.held && !by_lens->misfits.held;
  if (lens_better > 0)
    next.explained = by_lens->misfits.held ? WithMisfitsHeld(std::move(*by_lens)) : std::move(by_lens);
  return next;
}

// The tracker with a world of its own whose body or whose world it is; empty: of none.
SensorId TrackerWithWorld(const SessionProblem& problem, const Move& move) {
  if (move.board != kNone) return problem.boards[static_cast<std::size_t>(move.board)].tracker;
  const SensorId& name = problem.sensors[static_cast<std::size_t>(move.sensor)];
  const bool has_world = std::any_of(problem.boards.begin(), problem.boards.end(),
                                     [&](const StillFrame& frame) { return frame.tracker == name; });
  return has_world ? name : SensorId();
}

// Of the body of a tracker where `move` is of its world, or the other way round; null: there is none.
const Move* CounterpartOf(const Move& move, const SessionProblem& problem, const std::vector<Move>& moves) {
  const SensorId tracker = TrackerWithWorld(problem, move);
  const auto other = std::find_if(moves.begin(), moves.end(), [&](const Move& one) {
    return (one.board == kNone) != (move.board == kNone) && TrackerWithWorld(problem, one) == tracker;
  });
  return tracker.empty() || other == moves.end() ? nullptr : &*other;
}

// A tracker's body moves its poses from the right, another origin from the left: a body that turns little afterwards
// does not tell which it was. The one that explains more beyond doubt, else the body, and that it may be the other.
Next BodyOrOrigin(const Explained& now, Next next, Move other) {
  auto split = Again(Split(now.start, now.refined, other), now.refined.groups);
  if (!split) return next;
  const std::vector<double>& in_burst = now.refined.weights.in_burst;
  other.step = StepOf(*split, other).step;
  const double better = next.explained ? LeftOver(*next.explained, in_burst) - LeftOver(*split, in_burst) : 0.0;
  if (better < -kBeyondDoubt) return next;
  const int world = other.board == kNone ? next.move->board : other.board;
  if (better > kBeyondDoubt || other.board == kNone) next = {std::move(split), other};
  if (better <= kBeyondDoubt) next.move->or_board = world;
  return next;
}

// The likeliest move that is none of chance and, by the refined poses on both its sides, large enough to be told;
// `may_move(move)`: not if it is of somebody who moved too often.
template <typename MayMove>
Next ByMove(const Explained& now, const MayMove& may_move) {
  if (now.refined.groups.groups() < kGroupsForMoves) return {};
  int tried = 0;
  const std::vector<Move> moves = ScanForMoves(now.start.problem, now.refined);
  for (Move move : moves) {
    if (move.odds >= kMovedOdds || tried == kMovesTried) break;
    if (!may_move(move) || !SidesOf(now.start.problem, now.refined, move).both()) continue;
    ++tried;
    auto split = Again(Split(now.start, now.refined, move), now.refined.groups);
    // One side may tell too little for a pose of its own: then the scan's step is all there is.
    const Step step = split ? StepOf(*split, move) : Step{move.step, move.information};
    if (!IsMove(step.step, step.information, move.odds)) continue;
    move.step = step.step;
    Next next{split && split->misfits.held ? WithMisfitsHeld(std::move(*split)) : std::move(split), move};
    const Move* other = CounterpartOf(move, now.start.problem, moves);
    return other == nullptr ? MoveOrLens(now, std::move(next)) : BodyOrOrigin(now, std::move(next), *other);
  }
  return {};
}

// Cameras that were given what contradicts the session estimated instead, if that explains it better beyond doubt; with
// fields of what is left, which may do what wrong numbers did and is compared.
Next ByLenses(const Explained& now) {
  const std::vector<std::size_t> cameras = ContradictedLenses(now.start.problem, now.refined);
  if (cameras.empty()) return {};
  auto freed = Again(WithLensesFree(now.start, now.refined, cameras), now.refined.groups);
  if (freed && freed->misfits.any()) freed = WithMisfitsHeld(std::move(*freed));
  const std::vector<double>& in_burst = now.refined.weights.in_burst;
  if (!freed || LeftOver(now, in_burst) - LeftOver(*freed, in_burst) < kBeyondDoubt) return {};
  std::vector<ContradictedLens> told = ContradictedLensesTold(now, *freed, cameras);
  return {std::move(freed), std::nullopt, std::move(told)};
}

// A bump is in time, a misfit in the picture, wrong intrinsics are numbers of the model, and each looks a little like
// the others: the one is taken out first that leaves least.
template <typename MayMove>
Next NextOf(const Explained& now, const MayMove& may_move) {
  Next best = ByMove(now, may_move);
  const auto try_instead = [&](Next other) {
    const std::vector<double>& in_burst = now.refined.weights.in_burst;
    if (!other.explained) return;
    if (!best.explained || LeftOver(*other.explained, in_burst) <= LeftOver(*best.explained, in_burst))
      best = std::move(other);
  };
  if (now.misfits.held) return best;
  if (now.misfits.any()) try_instead({WithMisfitsHeld(now), std::nullopt});
  try_instead(ByLenses(now));
  return best;
}

// A move that was told, and the second pose that its sensor or board has in the problem since; kNone: it has none, as a
// lens explains it better, or as one side tells too little.
struct ToldMove {
  Move move;
  int second = kNone;
  SensorId tracker = {};  // TrackerWithWorld
};

ToldMove ToldOf(const Explained& before, const Next& next) {
  const int poses = PosesOf(before.start.problem, *next.move);
  const bool is_split = next.explained && PosesOf(next.explained->start.problem, *next.move) > poses;
  return {*next.move, is_split ? poses : kNone, TrackerWithWorld(before.start.problem, *next.move)};
}

// The pose of the same sensor or board right before `one`: a move that was found later may have split off what it had.
int PoseBefore(const ToldMove& one, const std::vector<ToldMove>& moves) {
  const auto is_of = [&](const ToldMove& other, int pose) {
    return (other.move.board == kNone) == (one.move.board == kNone) && other.second != kNone &&
           FirstOf(other.move) == pose;
  };
  int before = FirstOf(one.move);
  int group = 0;
  for (const ToldMove& other : moves)
    if (is_of(other, FirstOf(one.move)) && other.move.group < one.move.group && other.move.group >= group)
      before = other.second, group = other.move.group;
  return before;
}

// What one sensor did twice looks like a move of another as long as only a part of it is allowed for: with all moves
// allowed for, those found first are told by the step that is left of them, and not where that is none. `told` has the
// moves of sensors and of boards each in the order in which they were found.
void TellWhatIsLeft(const Explained& last, const std::vector<ToldMove>& moves, SessionEstimate& told) {
  std::size_t sensor = 0, board = 0;
  for (const ToldMove& one : moves) {
    const Move& move = one.move;
    const int second = one.second;
    const bool is_board = move.board != kNone;
    const Step left = second == kNone ? Step{} : StepBetween(PoseBefore(one, moves), second, last.refined, move);
    const bool is_newest = &one == &moves.back();  // something moved
    const bool is_left = is_newest || second == kNone || IsMove(left.step, left.information, move.odds);
    const auto tell = [&](auto& list, std::size_t& at) {
      if (!is_left) return static_cast<void>(list.erase(list.begin() + static_cast<std::ptrdiff_t>(at)));
      if (second != kNone) list[at].step = left.step;
      ++at;
    };
    is_board ? tell(told.boards_moved, board) : tell(told.moved, sensor);
  }
}

}  // namespace

Result<Explained> Explain(SessionStart start, const CaptureGroups& groups) {
  RIGCAL_ASSIGN(Refined refined, Refine(start.problem, start.state, start.noise, groups));
  FoundMisfits misfits = FindMisfits(start.problem, refined);
  return Explained{std::move(start), std::move(refined), std::move(misfits)};
}

bool ExplainsMore(const Explained& one, const Explained& other) {
  const std::vector<double>& in_burst = other.refined.weights.in_burst;
  return LeftOver(one, in_burst) < LeftOver(other, in_burst) - kBeyondDoubt;
}

// What is found is taken out before the next is looked for, so that it does not hide it.
Explained ExplainAll(Explained now, SessionEstimate& told) {
  std::vector<ToldMove> moves;
  while (true) {
    Next next = NextOf(now, [&](const Move& move) {
      const SensorId tracker = TrackerWithWorld(now.start.problem, move);
      return std::count_if(moves.begin(), moves.end(), [&](const ToldMove& one) { return one.tracker == tracker; }) <
             kMovesMax;
    });
    if (next.move) {
      Tell(now.start.problem, now.refined, *next.move, told);
      moves.push_back(ToldOf(now, next));
    }
    told.contradicted_lenses.insert(told.contradicted_lenses.end(), next.lenses.begin(), next.lenses.end());
    if (!next.explained) break;
    now = std::move(*next.explained);
  }
  if (moves.size() > 1) TellWhatIsLeft(now, moves, told);
  std::sort(told.contradicted_lenses.begin(), told.contradicted_lenses.end(),
            [](const ContradictedLens& x, const ContradictedLens& y) { return x.camera < y.camera; });
  return now;
}

}  // namespace rigcal::calib::joint
