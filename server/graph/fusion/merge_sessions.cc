#include <Eigen/QR>
#include <algorithm>
#include <set>
#include <tuple>

#include "server/graph/fusion/merged_edge.h"
#include "server/graph/fusion/session_fusion.h"
#include "server/graph/uncertainty/graph_jackknife.h"
#include "server/math/covariance.h"
#include "server/model/edges/weak_edge.h"

namespace rigcal::graph {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

Index ColumnsOf(const MergedPairs& merged) {
  Index columns = 0;
  for (const auto& [pair, one] : merged) columns = std::max(columns, one.scores.cols());
  return columns;
}

void Widen(Index columns, MergedEdge& merged) {
  const Index before = merged.scores.cols();
  merged.scores.conservativeResize(Eigen::NoChange, columns);
  merged.scores.rightCols(columns - before).setZero();
}

// Block ids of a session, of all its edges that have blocks.
std::vector<std::string> BlockIdsOf(const BlocksByEdge& blocks) {
  std::set<std::string> ids;
  for (const auto& [edge, own] : blocks)
    for (const BlockVector& block : own.blocks) ids.insert(block.block_id);
  return {ids.begin(), ids.end()};
}

// What the edge's score errs by: by the session's blocks, a column each, or by itself.
MatrixXd ScoresOf(const Edge& edge, const BlocksByEdge& blocks, const std::vector<std::string>& ids) {
  const auto own = blocks.find(edge.id);
  if (own == blocks.end()) return SquareRoot(edge.uncertainty.Omega);
  return edge.uncertainty.Omega * CentredBlocks(own->second.blocks, ids);
}

// Beyond so many pairs what they have in common is let go: it would be a matrix of as many rows and columns, times six.
constexpr std::size_t kPairsTogetherMax = 200;

// A session's edge of its pair, which is there already or begins with it.
MergedEdge& MergedOf(const Edge& edge, MergedPairs& merged) {
  const auto [found, is_new] = merged.try_emplace(PairOf(edge));
  if (is_new) found->second.of_sessions = true, found->second.weak = !WhyWeak(edge).empty();
  return found->second;
}

// A weak edge says nothing beside better ones of its pair, and what weak ones said is let go once better ones come.
std::vector<const Edge*> WithoutWeaker(std::vector<const Edge*> good, MergedPairs& merged) {
  std::erase_if(good, [&](const Edge* edge) {
    const auto found = merged.find(PairOf(*edge));
    if (found == merged.end()) return false;
    const bool is_weak = !WhyWeak(*edge).empty();
    if (found->second.weak && !is_weak) merged.erase(found);
    return is_weak && !found->second.weak;
  });
  return good;
}

void AddApart(const std::vector<const Edge*>& good, Stamp captured_at, MergedPairs& merged) {
  for (auto& [pair, one] : merged) one.scores.resize(Eigen::NoChange, 0);  // `scatter` has each pair's own
  for (const Edge* edge : good) {
    MergedEdge& one = MergedOf(*edge, merged);
    Add(*edge, captured_at, one);
  }
}

void AddTogether(const std::vector<const Edge*>& edges, Stamp captured_at, MergedPairs& merged) {
  std::vector<Edge> good;
  for (const Edge* edge : edges) good.push_back(*edge);
  const BlocksByEdge blocks = BlocksOf(good);
  const std::vector<std::string> ids = BlockIdsOf(blocks);
  const Index shared = ColumnsOf(merged);
  Index own = shared + static_cast<Index>(ids.size());
  for (const Edge& edge : good) {
    MergedEdge& one = MergedOf(edge, merged);
    const bool by_blocks = blocks.contains(edge.id);
    const MatrixXd scores = ScoresOf(edge, blocks, ids);
    const Index at = by_blocks ? shared : own;
    own += by_blocks ? 0 : scores.cols();
    Widen(std::max(one.scores.cols(), at + scores.cols()), one);
    one.scores.middleCols(at, scores.cols()) += scores;
    Add(edge, captured_at, one);
  }
  for (auto& [pair, one] : merged) Widen(own, one);
}

// As few columns as pairs have directions, with the same products among all pairs: R of S^T = Q R, as S S^T = R^T R.
void Compress(MergedPairs& merged) {
  const Index rows = 6 * static_cast<Index>(merged.size()), columns = ColumnsOf(merged);
  if (columns == 0) return;
  for (auto& [pair, one] : merged) one.scatter = one.scores * one.scores.transpose();
  if (columns > rows) {
    MatrixXd transposed(columns, rows);
    Index at = 0;
    for (const auto& [pair, one] : merged) transposed.middleCols<6>(at) = one.scores.transpose(), at += 6;
    const Eigen::HouseholderQR<Eigen::Ref<MatrixXd>> qr(transposed);
    const MatrixXd R = qr.matrixQR().topRows(rows).triangularView<Eigen::Upper>();
    at = 0;
    for (auto& [pair, one] : merged) one.scores = R.middleCols<6>(at).transpose(), at += 6;
  }
}

// Adds the good edges of a session to those of its pairs, and what they have in common as columns of their scores.
void AddSession(const std::vector<const Edge*>& of_session, Stamp captured_at, MergedPairs& merged) {
  const std::vector<const Edge*> good = WithoutWeaker(of_session, merged);
  if (merged.size() > kPairsTogetherMax) return AddApart(good, captured_at, merged);
  AddTogether(good, captured_at, merged);
  Compress(merged);
}

struct SessionEdges {
  Stamp captured_at;
  SessionId id;
  std::vector<const Edge*> good, rest;  // by id
};

std::vector<SessionEdges> OldestFirst(const std::vector<Edge>& edges, const std::map<EdgeId, Stamp>& measured_at) {
  std::map<SessionId, SessionEdges> by_id;
  for (const Edge& edge : edges) {
    const auto at = measured_at.find(edge.id);
    if (edge.session.empty() || IsMerged(edge) || at == measured_at.end()) continue;
    SessionEdges& session = by_id[edge.session];
    session.id = edge.session, session.captured_at = at->second;
    (edge.state == EdgeState::kGood ? session.good : session.rest).push_back(&edge);
  }
  std::vector<SessionEdges> sessions;
  for (auto& [id, session] : by_id) sessions.push_back(std::move(session));
  for (SessionEdges& session : sessions)
    for (auto* list : {&session.good, &session.rest})
      std::sort(list->begin(), list->end(), [](const Edge* x, const Edge* y) { return x->id < y->id; });
  std::sort(sessions.begin(), sessions.end(), [](const SessionEdges& x, const SessionEdges& y) {
    return std::tie(x.captured_at, x.id) < std::tie(y.captured_at, y.id);
  });
  return sessions;
}

// Those that come before the newest `kept` with a good edge, and those without one before the newest `kept`; the oldest
// first.
std::vector<const SessionEdges*> OlderOf(const std::vector<SessionEdges>& sessions, std::size_t kept) {
  std::vector<const SessionEdges*> older;
  std::size_t newer = 0, newer_good = 0;
  for (auto session = sessions.rbegin(); session != sessions.rend(); ++session) {
    if (newer_good >= kept || (session->good.empty() && newer >= kept)) older.push_back(&*session);
    ++newer;
    if (!session->good.empty()) ++newer_good;
  }
  std::reverse(older.begin(), older.end());
  return older;
}

// Good edges of each pair and method, as they are now.
using EdgesOfPairs = std::map<MeasuredPair, std::vector<const Edge*>>;
EdgesOfPairs ByPair(const std::vector<SessionEdges>& sessions) {
  EdgesOfPairs pairs;
  for (const SessionEdges& session : sessions)
    for (const Edge* edge : session.good) pairs[PairOf(*edge)].push_back(edge);
  return pairs;
}

// How the other edges of its pair scatter from visit to visit beyond their own uncertainty (BetweenVisits). Without the
// edge itself: one that is wrong must not excuse itself. Edges that leave a direction open tell nothing of it and are
// left out.
Matrix6d ScatterOfOthers(const Edge& edge, const std::vector<const Edge*>& of_pair) {
  Matrix6d Omega = Matrix6d::Zero();
  Vector6d pull = Vector6d::Zero();
  std::vector<const Edge*> others;
  for (const Edge* other : of_pair)
    if (other != &edge && other->uncertainty.rank == 6) others.push_back(other);
  if (others.size() < 3) return Matrix6d::Zero();
  const Se3& T = others.front()->T_a_b;
  for (const Edge* other : others) {
    Omega += other->uncertainty.Omega;
    pull += other->uncertainty.Omega * (T.Inverse() * other->T_a_b).Log();
  }
  const Se3 mean = T * Se3::Exp(Observable(Omega).covariance * pull);
  std::vector<VisitResidual> visits;
  for (const Edge* other : others)
    visits.push_back({(mean.Inverse() * other->T_a_b).Log(), Observable(other->uncertainty.Omega).covariance});
  return BetweenVisits(visits).Matrix();
}

// Where nothing was merged yet of the pair, or weak ones only, half of its edges that are as weak or as good must agree
// with the one that merging begins with.
bool Fits(const Edge& edge, const MergedPairs& merged, const EdgesOfPairs& window) {
  const std::vector<const Edge*>& of_pair = window.at(PairOf(edge));
  const Matrix6d between = ScatterOfOthers(edge, of_pair);
  const bool is_weak = !WhyWeak(edge).empty();
  const auto found = merged.find(PairOf(edge));
  if (found != merged.end() && (is_weak || !found->second.weak)) return Agree(found->second, edge, between);
  std::size_t agreeing = 0, alike = 0;
  for (const Edge* other : of_pair)
    if (!WhyWeak(*other).empty() == is_weak) ++alike, agreeing += Agree(edge, *other, between) ? 1 : 0;
  return 2 * agreeing >= alike + 1;
}

// With those that contradict what they become part of as uncertain as they are off.
void AddThoughOff(const SessionEdges& session, const EdgesOfPairs& window, MergedPairs& merged) {
  std::vector<Edge> covered;
  covered.reserve(session.good.size());
  std::vector<const Edge*> good;
  for (const Edge* edge : session.good) {
    const auto found = merged.find(PairOf(*edge));
    const bool begins = found == merged.end() || (found->second.weak && WhyWeak(*edge).empty());
    const bool fits = begins || Fits(*edge, merged, window);
    if (!fits) covered.push_back(AsUnsureAsOff(*edge, found->second, ScatterOfOthers(*edge, window.at(PairOf(*edge)))));
    good.push_back(fits ? edge : &covered.back());
  }
  AddSession(good, session.captured_at, merged);
}

// What of a pair that no edge tells any more is said by its newest that failed or is past: that stays.
using Frames = std::pair<SensorId, SensorId>;
std::set<EdgeId> LastWordsOf(const std::vector<SessionEdges>& sessions, const MergedPairs& merged) {
  std::set<Frames> told;
  for (const auto& [pair, one] : merged) told.insert({one.frame_a, one.frame_b});
  for (const SessionEdges& session : sessions)
    for (const Edge* edge : session.good) told.insert({edge->frame_a, edge->frame_b});
  std::map<Frames, EdgeId> last;
  for (const SessionEdges& session : sessions)
    for (const Edge* edge : session.rest)
      if (!told.contains({edge->frame_a, edge->frame_b})) last[{edge->frame_a, edge->frame_b}] = edge->id;
  std::set<EdgeId> ids;
  for (const auto& [frames, id] : last) ids.insert(id);
  return ids;
}

void Take(const std::vector<const Edge*>& edges, std::vector<EdgeId>& taken) {
  for (const Edge* edge : edges) taken.push_back(edge->id);
}

}  // namespace

Merge MergeOlderSessions(const std::vector<MergedEdge>& before, const std::vector<Edge>& edges,
                         const std::map<EdgeId, Stamp>& measured_at, std::size_t kept) {
  MergedPairs merged;
  for (const MergedEdge& one : before)
    if (one.of_sessions) merged.emplace(MeasuredPair{one.frame_a, one.frame_b, one.method}, one);
  const std::vector<SessionEdges> sessions = OldestFirst(edges, measured_at);
  const EdgesOfPairs window = ByPair(sessions);
  const std::set<EdgeId> last_words = LastWordsOf(sessions, merged);
  Merge result;
  const auto take = [&](const SessionEdges& session) {
    Take(session.good, result.taken);
    Take(session.rest, result.taken);
  };
  std::vector<const SessionEdges*> apart;
  for (const SessionEdges* session : OlderOf(sessions, kept)) {
    const auto fits = [&](const Edge* edge) { return Fits(*edge, merged, window); };
    if (!std::all_of(session->good.begin(), session->good.end(), fits)) {
      apart.push_back(session);
      continue;
    }
    if (!session->good.empty()) AddSession(session->good, session->captured_at, merged);
    take(*session);
  }
  for (std::size_t i = 0; i + kept < apart.size(); ++i) {
    AddThoughOff(*apart[i], window, merged);
    take(*apart[i]);
  }
  std::erase_if(result.taken, [&](const EdgeId& id) { return last_words.contains(id); });
  for (auto& [pair, one] : merged) result.merged.push_back(std::move(one));
  return result;
}

}  // namespace rigcal::graph
