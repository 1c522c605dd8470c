#include "server/pipeline/sessions/pair_moves.h"

#include <algorithm>
#include <map>
#include <set>

#include "server/calib/core/capture_blocks.h"
#include "server/calib/core/pair_change.h"

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

// The change is after the first capture of the block before it, and before the last of the block after it.
SensorMovedWithin Told(const Changed& one, const BlockEnds& ends, const SensorId& sensor, const SensorId& or_sensor) {
  const auto before = ends.find(one.change.last_before), after = ends.find(one.change.first_after);
  SensorMovedWithin moved{sensor, before == ends.end() ? CaptureId(one.change.last_before) : before->second.first,
                          after == ends.end() ? CaptureId(one.change.first_after) : after->second.second};
  moved.step = StepOf(one, sensor);
  moved.odds = one.change.odds;
  moved.or_sensor = or_sensor;
  return moved;
}

// The only sensor of the pairs of `same`, where there are several of these; none: an empty id.
SensorId InCommon(const std::vector<const Changed*>& same) {
  if (same.size() < 2) return {};
  for (const SensorId& sensor : {same.front()->edge->frame_a, same.front()->edge->frame_b})
    if (std::all_of(same.begin(), same.end(), [&](const Changed* one) { return one->Has(sensor); })) return sensor;
  return {};
}

std::vector<SensorMovedWithin> MovesOf(std::vector<Changed> changes, const std::vector<std::string>& ids,
                                       const BlockEnds& ends) {
  std::vector<SensorMovedWithin> moves;
  while (!changes.empty()) {
    const Changed likeliest = changes.front();
    std::vector<const Changed*> same;
    for (const Changed& one : changes)
      if (AreOfOneTime(one, likeliest, ids)) same.push_back(&one);
    const SensorId common = InCommon(same);
    moves.push_back(common.empty() ? Told(likeliest, ends, likeliest.edge->frame_b, likeliest.edge->frame_a)
                                   : Told(likeliest, ends, common, {}));
    std::erase_if(changes, [&](const Changed& one) {
      return one.edge == likeliest.edge || (!common.empty() && one.Has(common) && AreOfOneTime(one, likeliest, ids));
    });
  }
  return moves;
}

// Of each sensor by the pair that sees most.
std::vector<SmallestMoveByPairs> SmallestOf(const std::vector<const Edge*>& good) {
  std::map<SensorId, SmallestMove> smallest;
  for (const Edge* edge : good) {
    SmallestMove move = calib::SmallestPairChange(edge->uncertainty.blocks, good.size());
    move.captures = std::max(move.captures, static_cast<int>(edge->captures.size()));
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
  std::vector<const Edge*> good;
  for (const Edge& edge : edges)
    if (edge.state == EdgeState::kGood) good.push_back(&edge);
  estimate.moved = MovesOf(ChangesOf(good), BlocksInOrder(good), EndsOfBlocks(captures));
  estimate.by_pairs = SmallestOf(good);
}

}  // namespace rigcal::pipeline
