#include "server/pipeline/sessions/pair_moves.h"

#include <algorithm>
#include <map>
#include <set>

#include "server/calib/core/capture_blocks.h"
#include "server/calib/core/pair_change.h"
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

// Of two either of which may have been moved; where the refinement looked at one, the other.
SensorMovedWithin EitherOf(const Changed& one, const BlockEnds& ends, const std::set<SensorId>& refined) {
  const SensorId &a = one.edge->frame_a, &b = one.edge->frame_b;
  if (refined.contains(b)) return Told(one, ends, a, {});
  return Told(one, ends, b, refined.contains(a) ? SensorId() : a);
}

std::vector<SensorMovedWithin> MovesOf(std::vector<Changed> changes, const std::vector<std::string>& ids,
                                       const BlockEnds& ends, const std::set<SensorId>& refined) {
  std::vector<SensorMovedWithin> moves;
  while (!changes.empty()) {
    const Changed likeliest = changes.front();
    std::vector<const Changed*> same;
    for (const Changed& one : changes)
      if (AreOfOneTime(one, likeliest, ids)) same.push_back(&one);
    if (const SensorId common = InCommon(same); !common.empty() && !refined.contains(common))
      moves.push_back(Told(likeliest, ends, common, {}));
    else
      for (const Changed* one : same) moves.push_back(EitherOf(*one, ends, refined));
    std::erase_if(changes, [&](const Changed& one) { return AreOfOneTime(one, likeliest, ids); });
  }
  return moves;
}

// Sensors that the joint refinement looked at.
std::set<SensorId> Refined(const SessionEstimate& estimate) {
  std::set<SensorId> refined;
  if (estimate.why_not.empty())
    for (const RefinedPose& pose : estimate.poses) refined.insert(pose.sensor);
  return refined;
}

bool IsTold(const SensorId& sensor, const std::vector<SensorMovedWithin>& moved) {
  return std::any_of(moved.begin(), moved.end(),
                     [&](const SensorMovedWithin& one) { return one.sensor == sensor || one.or_sensor == sensor; });
}

// Good ones that tell of a sensor that took no part, without those of a sensor that is known to have moved.
std::vector<const Edge*> PairsThatTell(const std::vector<Edge>& edges, const std::set<SensorId>& refined,
                                       const SessionEstimate& estimate) {
  std::vector<const Edge*> telling;
  for (const Edge& edge : edges) {
    if (edge.state != EdgeState::kGood || (refined.contains(edge.frame_a) && refined.contains(edge.frame_b))) continue;
    if (!IsTold(edge.frame_a, estimate.moved) && !IsTold(edge.frame_b, estimate.moved)) telling.push_back(&edge);
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
  const std::set<SensorId> refined = Refined(estimate);
  const std::vector<const Edge*> telling = PairsThatTell(edges, refined, estimate);
  const auto moves = MovesOf(ChangesOf(telling), BlocksInOrder(telling), EndsOfBlocks(captures), refined);
  estimate.moved.insert(estimate.moved.end(), moves.begin(), moves.end());
  for (const SmallestMoveByPairs& one : SmallestOf(telling))
    if (!refined.contains(one.sensor)) estimate.by_pairs.push_back(one);
}

}  // namespace rigcal::pipeline
