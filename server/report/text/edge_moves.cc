#include "server/report/text/edge_moves.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "server/model/edges/merged_edge.h"

namespace rigcal::report {
namespace {

using PairKey = std::tuple<SensorId, SensorId, std::string>;
using Newest = std::map<PairKey, const Edge*>;
using Stamps = std::map<SessionId, Stamp>;

Stamp StampOf(const Edge& edge, const Stamps& captured_at) {
  const auto found = captured_at.find(edge.session);
  return found == captured_at.end() ? Stamp{} : found->second;
}

// Finished edges have no session: the one that the other revision does not hold is the newer.
Newest NewestOf(const formats::RevisionInput& revision, const std::set<EdgeId>& elsewhere, const Stamps& captured_at) {
  const auto age = [&](const Edge& edge) {
    return std::make_tuple(StampOf(edge, captured_at), !elsewhere.contains(edge.id), edge.id);
  };
  Newest newest;
  for (const Edge& edge : revision.edges) {
    if (edge.state != EdgeState::kGood) continue;
    const Edge*& best = newest[{edge.frame_a, edge.frame_b, edge.method}];
    if (!best || age(*best) < age(edge)) best = &edge;
  }
  return newest;
}

std::set<EdgeId> IdsOf(const formats::RevisionInput& revision) {
  std::set<EdgeId> ids;
  for (const Edge& edge : revision.edges) ids.insert(edge.id);
  return ids;
}

EdgeMove MoveBetween(const Edge* before, const Edge* now) {
  EdgeMove move{before, now};
  if (!before || !now || before->id == now->id || IsMerged(*before) || IsMerged(*now)) return move;
  move.measured_again = true;
  const Vector6d d = (before->T_a_b.Inverse() * now->T_a_b).Log();
  for (int axis = 0; axis < 6; ++axis) {
    const AxisSigma left = SigmaOf(before->uncertainty, axis), right = SigmaOf(now->uncertainty, axis);
    if (!left.known || !right.known) continue;
    move.known[static_cast<std::size_t>(axis)] = true;
    move.d(axis) = d(axis);
    move.sigma(axis) = std::hypot(left.value, right.value);
    if (move.sigma(axis) > 0.0) move.in_sigmas = std::max(move.in_sigmas, std::abs(move.d(axis)) / move.sigma(axis));
  }
  return move;
}

int RankOf(const EdgeMove& move) {
  if (move.measured_again) return 0;
  return move.before && move.now ? 2 : 1;
}

}  // namespace

std::vector<EdgeMove> EdgeMoves(const formats::RevisionInput& before, const formats::RevisionInput& now,
                                const Stamps& captured_at) {
  const Newest old = NewestOf(before, IdsOf(now), captured_at), current = NewestOf(now, IdsOf(before), captured_at);
  std::vector<EdgeMove> moves;
  for (const auto& [key, edge] : current) {
    const auto found = old.find(key);
    moves.push_back(MoveBetween(found == old.end() ? nullptr : found->second, edge));
  }
  for (const auto& [key, edge] : old)
    if (!current.contains(key)) moves.push_back(MoveBetween(edge, nullptr));
  std::stable_sort(moves.begin(), moves.end(), [](const EdgeMove& a, const EdgeMove& b) {
    return std::make_tuple(RankOf(a), -a.in_sigmas) < std::make_tuple(RankOf(b), -b.in_sigmas);
  });
  return moves;
}

}  // namespace rigcal::report
