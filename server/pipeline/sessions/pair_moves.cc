#include "server/pipeline/sessions/pair_moves.h"

#include <algorithm>
#include <map>
#include <set>

#include "server/calib/core/capture_blocks.h"
#include "server/calib/core/pair_change.h"
#include "server/graph/solve/weak_edges.h"
#include "server/model/edges/method.h"

namespace rigcal::pipeline {
namespace {

struct Changed {
  const Edge* edge = nullptr;
  calib::PairChange change;

  [[nodiscard]] bool Has(const SensorId& sensor) const { return edge->frame_a == sensor || edge->frame_b == sensor; }
};

// The likeliest first.
std::vector<Changed> ChangesOf(const std::vector<const Edge*>& good) {
  std::vector<Changed> changes;
  for (const Edge* edge : good)
    if (const auto change = calib::FindPairChange(edge->uncertainty.blocks, good.size()))
      changes.push_back({edge, *change});
  std::stable_sort(changes.begin(), changes.end(),
                   [](const Changed& x, const Changed& y) { return x.change.odds < y.change.odds; });
  return changes;
}

// First and last captures of the session's blocks, by block id.
using BlockEnds = std::map<std::string, std::pair<CaptureId, CaptureId>>;
BlockEnds EndsOfBlocks(const std::vector<CaptureId>& captures) {
  BlockEnds ends;
  for (const calib::CaptureBlock& block :
       calib::CaptureBlocks(captures, std::set<CaptureId>(captures.begin(), captures.end()))) {
    const auto [first, last] = std::minmax_element(block.captures.begin(), block.captures.end(), calib::TakenBefore());
    ends.emplace(block.id, std::pair(*first, *last));
  }
  return ends;
}

// A pair tells the time to some captures.
bool AreOfOneTime(const Changed& x, const Changed& y, const std::vector<std::string>& ids) {
  constexpr std::ptrdiff_t kNear = 3;
  const auto at = [&](const Changed& one) { return std::find(ids.begin(), ids.end(), one.change.first_after); };
  return std::abs(at(x) - at(y)) <= kNear;
}

std::vector<std::string> BlocksInOrder(const std::vector<const Edge*>& good) {
  std::set<CaptureId, calib::TakenBefore> ids;
  for (const Edge* edge : good)
    for (const BlockVector& block : edge->uncertainty.blocks) ids.insert(CaptureId(block.block_id));
  std::vector<std::string> order;
  for (const CaptureId& id : ids) order.push_back(id.str());
  return order;
}

// T_a_b Exp(step) as a move of a: T_a Exp(u) with u = -Ad(T_a_b) step.
Vector6d StepOf(const Changed& one, const SensorId& sensor) {
  if (one.edge->frame_b == sensor) return one.change.step;
  return -Adjoint(one.edge->T_a_b) * one.change.step;
}

// A stretch of time, "part 10", as no capture is known by.
CaptureId OfStretch(std::string block) {
  std::replace(block.begin(), block.end(), ' ', '-');
  return CaptureId(block);
}

// The change is after the first capture of the block before it, and before the last of the block after it.
SensorMovedWithin Told(const Changed& one, const BlockEnds& ends, const SensorId& sensor, const SensorId& or_sensor) {
  const auto before = ends.find(one.change.last_before), after = ends.find(one.change.first_after);
  SensorMovedWithin moved{sensor, before == ends.end() ? OfStretch(one.change.last_before) : before->second.first,
                          after == ends.end() ? OfStretch(one.change.first_after) : after->second.second};
  moved.step = StepOf(one, sensor);
  moved.odds = one.change.odds;
  moved.or_sensor = or_sensor;
  return moved;
}

// To half of the longer, metres and radians together: what robust pairs tell of a step falls short of it.
bool Agree(const Vector6d& x, const Vector6d& y) { return (x - y).norm() <= 0.5 * std::max(x.norm(), y.norm()); }

// The only sensor of the pairs of `same` where there are several of these and each tells the same step of it; none: an
// empty id.
SensorId InCommon(const std::vector<const Changed*>& same) {
  if (same.size() < 2) return {};
  for (const SensorId& sensor : {same.front()->edge->frame_a, same.front()->edge->frame_b})
    if (std::all_of(same.begin(), same.end(), [&](const Changed* one) {
          return one->Has(sensor) && Agree(StepOf(*one, sensor), StepOf(*same.front(), sensor));
        }))
      return sensor;
  return {};
}

// Sensors that took part in the joint refinement, or in that of an island, with the smallest move of each that it would
// have told whenever it was: any, of one that saw nothing in more than a few captures, as these may be all on one side
// of the move.
struct Look {
  std::size_t part = 0;  // 0: the reference's; else of which island
  SmallestMove smallest;
};
struct LookedAt {
  std::map<SensorId, Look> sensors;

  [[nodiscard]] bool Has(const SensorId& sensor) const { return sensors.contains(sensor); }
  // One refinement looked at both: at what is between two of them none did.
  [[nodiscard]] bool HasTogether(const SensorId& a, const SensorId& b) const {
    return Has(a) && Has(b) && sensors.at(a).part == sensors.at(b).part;
  }
};
void AddLookedAt(const SessionEstimate& estimate, std::size_t captures, std::size_t part, LookedAt& looked_at) {
  constexpr std::size_t kUnseenMax = calib::kSideBlocksMin / 2;
  if (!estimate.why_not.empty()) return;
  for (const RefinedPose& pose : estimate.poses) {
    const SmallestMove told = pose.smallest_move.value_or(SmallestMove{});
    const bool always = static_cast<std::size_t>(told.captures) + kUnseenMax >= captures;
    looked_at.sensors.emplace(pose.sensor, Look{part, always ? told : SmallestMove{}});
  }
}
LookedAt LookedAtIn(const SessionEstimate& estimate, std::size_t captures) {
  LookedAt looked_at;
  AddLookedAt(estimate, captures, 0, looked_at);
  for (std::size_t i = 0; i < estimate.islands.size(); ++i)
    AddLookedAt(estimate.islands[i], captures, i + 1, looked_at);
  return looked_at;
}

// It would have been told of such a step.
bool IsCleared(const LookedAt& looked_at, const SensorId& sensor, const Vector6d& step) {
  const auto found = looked_at.sensors.find(sensor);
  if (found == looked_at.sensors.end()) return false;
  const SmallestMove& smallest = found->second.smallest;
  return step.head<3>().norm() > smallest.m || step.tail<3>().norm() > smallest.rad;
}

// Of two either of which may have been moved; where the refinement cleared one, the other. Of two islands each may have
// been moved as a whole.
SensorMovedWithin EitherOf(const Changed& one, const BlockEnds& ends, const LookedAt& looked_at) {
  const SensorId &a = one.edge->frame_a, &b = one.edge->frame_b;
  if (looked_at.Has(a) && looked_at.Has(b)) return Told(one, ends, b, a);
  if (IsCleared(looked_at, b, StepOf(one, b))) return Told(one, ends, a, {});
  return Told(one, ends, b, IsCleared(looked_at, a, StepOf(one, a)) ? SensorId() : a);
}

std::vector<SensorMovedWithin> MovesOf(std::vector<Changed> changes, const std::vector<std::string>& ids,
                                       const BlockEnds& ends, const LookedAt& looked_at) {
  std::vector<SensorMovedWithin> moves;
  while (!changes.empty()) {
    const Changed likeliest = changes.front();
    std::vector<const Changed*> same;
    for (const Changed& one : changes)
      if (AreOfOneTime(one, likeliest, ids)) same.push_back(&one);
    const SensorId common = InCommon(same);
    if (!common.empty() && !IsCleared(looked_at, common, StepOf(likeliest, common)))
      moves.push_back(Told(likeliest, ends, common, {}));
    else  // several pairs tell of one that was cleared: nobody is by himself accused, or cleared
      for (const Changed* one : same)
        moves.push_back(common.empty() ? EitherOf(*one, ends, looked_at)
                                       : Told(*one, ends, one->edge->frame_b, one->edge->frame_a));
    std::erase_if(changes, [&](const Changed& one) { return AreOfOneTime(one, likeliest, ids); });
  }
  return moves;
}

// The session says already that it was moved, or that something is wrong with it.
bool IsTold(const SensorId& sensor, const SessionEstimate& estimate) {
  if (std::any_of(estimate.islands.begin(), estimate.islands.end(),
                  [&](const SessionEstimate& island) { return IsTold(sensor, island); }))
    return true;
  const auto names = [&](const auto& told) { return told.sensor == sensor || told.or_sensor == sensor; };
  return std::any_of(estimate.boards_moved.begin(), estimate.boards_moved.end(),
                     [&](const BoardMovedWithin& moved) { return moved.world_of == sensor; }) ||
         std::any_of(estimate.moved.begin(), estimate.moved.end(), names) ||
         std::any_of(estimate.late.begin(), estimate.late.end(), names) ||
         std::any_of(estimate.lost_sights.begin(), estimate.lost_sights.end(),
                     [&](const LostSight& lost) { return lost.sensor == sensor; });
}

// Good ones that tell of a sensor that took no part: not weak ones beside better ones, whose errors change with the
// place, nor those of a sensor that is told already.
std::vector<const Edge*> PairsThatTell(const std::vector<Edge>& edges, const LookedAt& looked_at,
                                       const SessionEstimate& estimate) {
  const std::set<EdgeId> weak = graph::WeakBesideBetter(edges);
  std::vector<const Edge*> telling;
  for (const Edge& edge : edges) {
    const SensorId &a = edge.frame_a, &b = edge.frame_b;
    if (edge.state != EdgeState::kGood || weak.contains(edge.id)) continue;
    if (looked_at.HasTogether(a, b)) continue;
    if (!IsTold(a, estimate) && !IsTold(b, estimate)) telling.push_back(&edge);
  }
  return telling;
}

// Of each sensor by the pair that sees most, of those of which a capture tells the pose by itself: where another
// unknown takes up part of a step it is not known.
std::vector<SmallestMoveByPairs> SmallestOf(const std::vector<const Edge*>& good) {
  std::map<SensorId, SmallestMove> smallest;
  for (const Edge* edge : good) {
    if (edge->method != NameOf(Method::kLidarLidar)) continue;
    SmallestMove move = calib::SmallestPairChange(edge->uncertainty.blocks, good.size());
    move.captures = std::max(move.captures, static_cast<int>(edge->captures.size()));
    if (move.m >= kAnyMove_m) continue;
    for (const SensorId& sensor : {edge->frame_a, edge->frame_b}) {
      const auto [one, is_new] = smallest.emplace(sensor, move);
      if (!is_new && move.rad < one->second.rad) one->second = move;
    }
  }
  std::vector<SmallestMoveByPairs> told;
  for (const auto& [sensor, move] : smallest) told.push_back({sensor, move});
  return told;
}

}  // namespace

void AddMovesOfPairs(const std::vector<Edge>& edges, const std::vector<CaptureId>& captures,
                     SessionEstimate& estimate) {
  const LookedAt looked_at = LookedAtIn(estimate, captures.size());
  const std::vector<const Edge*> telling = PairsThatTell(edges, looked_at, estimate);
  const auto moves = MovesOf(ChangesOf(telling), BlocksInOrder(telling), EndsOfBlocks(captures), looked_at);
  estimate.moved.insert(estimate.moved.end(), moves.begin(), moves.end());
  for (const SmallestMoveByPairs& one : SmallestOf(telling))
    if (!looked_at.Has(one.sensor)) estimate.by_pairs.push_back(one);
}

}  // namespace rigcal::pipeline
