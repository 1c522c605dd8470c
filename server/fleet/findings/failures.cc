#include "server/fleet/findings/failures.h"

#include <algorithm>
#include <map>
#include <set>

#include "server/model/edges/method.h"
#include "server/model/edges/past.h"

namespace rigcal::fleet {
namespace {

using PairKey = std::pair<SensorId, SensorId>;

PairKey KeyOf(const Edge& edge) { return std::minmax(edge.frame_a, edge.frame_b); }

// What has no date is older than what has one.
std::pair<std::int64_t, EdgeId> AgeOf(const Edge& edge, const SessionTimes& captured_at) {
  const auto time = captured_at.find(edge.session);
  return {time == captured_at.end() ? 0 : time->second.ns, edge.id};
}

// Of the session that was captured last: what older ones know mends none of its failures where each of its pairs
// failed, nor those of a sensor that was seen in it and fitted nothing.
struct LastVisit {
  SessionId session;
  bool barren = true;
  std::set<SensorId> fitted;  // by a good pair

  [[nodiscard]] bool Keeps(const Edge& failure) const {
    if (session.empty() || failure.session != session) return false;
    return barren || TellsMove(failure) ||
           (!SawTooLittle(failure) && !(fitted.contains(failure.frame_a) && fitted.contains(failure.frame_b)));
  }
};

LastVisit LastVisitOf(const std::vector<Edge>& edges, const SessionTimes& captured_at) {
  std::map<std::pair<Stamp, SessionId>, LastVisit> visits;
  for (const Edge& edge : edges) {
    const auto time = captured_at.find(edge.session);
    if (time == captured_at.end() || IsPast(edge)) continue;
    LastVisit& visit = visits[{time->second, edge.session}];
    visit.session = edge.session;
    if (edge.state == EdgeState::kFailed) continue;
    visit.barren = false;
    visit.fitted.insert({edge.frame_a, edge.frame_b});
  }
  return visits.empty() ? LastVisit() : visits.rbegin()->second;
}

// Both sensors look at one board.
bool SharesBoard(Method method) { return method == Method::kStereo || method == Method::kLidarCamera; }

}  // namespace

std::vector<const Edge*> FindOpenFailures(const std::vector<Edge>& edges, const SessionTimes& captured_at) {
  std::set<PairKey> good;
  std::map<PairKey, const Edge*> newest;
  for (const Edge& edge : edges) {
    if (edge.state == EdgeState::kGood) good.insert(KeyOf(edge));
    if (edge.state == EdgeState::kGood || IsPast(edge)) continue;
    const Edge*& kept = newest[KeyOf(edge)];
    if (kept == nullptr || AgeOf(*kept, captured_at) < AgeOf(edge, captured_at)) kept = &edge;
  }
  const LastVisit last = LastVisitOf(edges, captured_at);
  std::vector<const Edge*> open;
  for (const auto& [pair, edge] : newest)
    if (!good.contains(pair) || last.Keeps(*edge)) open.push_back(edge);
  std::sort(open.begin(), open.end());  // of one vector
  return open;
}

bool FailedFor(const Edge& edge, std::initializer_list<std::string_view> codes) {
  return !edge.diagnoses.empty() && std::find(codes.begin(), codes.end(), edge.diagnoses.front().code) != codes.end();
}

bool TellsMove(const Edge& edge) {
  return edge.state == EdgeState::kFailed &&
         std::any_of(edge.diagnoses.begin(), edge.diagnoses.end(),
                     [](const Diagnosis& diagnosis) { return diagnosis.code == "moved_within"; });
}

bool SawTooLittle(const Edge& edge) {
  return FailedFor(edge, {"too_few_captures", "no_common_view", "no_common_clouds"});
}

std::optional<double> EdgeEnd::Figure(const std::string& name, const char* unit) const {
  const auto figure = edge->figures.find(name + side + unit);
  return figure == edge->figures.end() ? std::nullopt : std::optional(figure->second);
}

std::array<EdgeEnd, 2> EndsOf(const Edge& edge) {
  return {EdgeEnd{&edge, edge.frame_a, "_a"}, EdgeEnd{&edge, edge.frame_b, "_b"}};
}

bool IsEndOf(const Edge& edge, const SensorId& sensor) { return edge.frame_a == sensor || edge.frame_b == sensor; }

Loss Sight::LargestLoss() const {
  const double no_file = captures - files, no_board = readable() - with_board;
  if (no_file >= std::max(unreadable, no_board)) return Loss::kNoFile;
  return unreadable >= no_board ? Loss::kUnreadable : Loss::kNoBoard;
}

std::optional<Sight> SightOf(const EdgeEnd& end) {
  const auto captures = end.edge->figures.find("captures_total");
  const std::optional<double> files = end.Figure("files"), with_board = end.Figure("files_with_board");
  if (captures == end.edge->figures.end() || !files || !with_board) return std::nullopt;
  return Sight{captures->second, *files, end.Figure("files_unreadable").value_or(0.0), *with_board};
}

std::optional<Blind> BlindEndOf(const Edge& edge) {
  const auto less = [](const Sight& x, const Sight& y) {
    return std::pair(x.with_board, x.LargestLoss()) < std::pair(y.with_board, y.LargestLoss());
  };
  std::optional<Blind> blind;
  for (const EdgeEnd& end : EndsOf(edge))
    if (const auto sight = SightOf(end); sight && sight->IsSeldom() && (!blind || less(*sight, blind->sight)))
      blind = Blind{end, *sight};
  return blind;
}

SessionHeaders WithoutPast(const SessionHeaders& headers, const std::vector<Edge>& edges) {
  SessionHeaders current;
  for (const Edge& edge : edges)
    if (const auto header = headers.find(edge.session); header != headers.end() && !IsPast(edge))
      current.insert(*header);
  return current;
}

std::vector<const SessionHeader*> NewestFirst(const SessionHeaders& headers) {
  std::vector<const SessionHeader*> newest;
  for (const auto& [session, header] : headers) newest.push_back(&header);
  std::stable_sort(newest.begin(), newest.end(),
                   [](const SessionHeader* x, const SessionHeader* y) { return x->captured_at > y->captured_at; });
  return newest;
}

const Sensor* SensorOf(const SessionHeaders& headers, const Edge& edge, const SensorId& sensor) {
  const auto header = headers.find(edge.session);
  return header == headers.end() ? nullptr : rigcal::SensorOf(header->second, sensor);
}

std::optional<SensorKind> KindOf(const SessionHeaders& headers, const Edge& edge, const SensorId& sensor) {
  if (const Sensor* listed = SensorOf(headers, edge, sensor)) return listed->kind;
  const auto method = MethodNamed(edge.method);
  if (!method || RowOf(*method).a != RowOf(*method).b) return std::nullopt;
  return RowOf(*method).a;
}

std::vector<const Target*> BoardsOf(const SessionHeaders& headers, const EdgeEnd& end) {
  const Edge& edge = *end.edge;
  const auto method = MethodNamed(edge.method);
  const Sensor *a = SensorOf(headers, edge, edge.frame_a), *b = SensorOf(headers, edge, edge.frame_b);
  if (!method || a == nullptr || b == nullptr) return {};
  const SessionHeader& header = headers.at(edge.session);
  if (SharesBoard(*method)) return CommonTargets(header, *a, *b);
  const Sensor& own = end.sensor == a->id ? *a : *b;
  return CommonTargets(header, own, own);
}

const SensorPose* ReferenceOf(const GraphSolution& solution) {
  const auto reference = std::find_if(solution.poses.begin(), solution.poses.end(),
                                      [](const SensorPose& pose) { return pose.known && pose.covariance.isZero(0.0); });
  return reference == solution.poses.end() ? nullptr : &*reference;
}

}  // namespace rigcal::fleet
