// Causes that the files of a session show: those that are missing, cannot be read, or show no board.
#include <algorithm>
#include <map>
#include <set>

#include "server/fleet/causes/root_causes.h"
#include "server/fleet/wording.h"
#include "server/model/edges/captures_wanted.h"
#include "server/model/edges/method.h"
#include "server/model/sensors/unfound_boards.h"

namespace rigcal::fleet {
namespace {

// A session with fewer captures is short, whatever its boards show.
constexpr double kCapturesOfSession = 10;
// A sensor that sees a board in less of what it recorded almost never does.
constexpr double kAlmostNeverRatio = 0.1;

std::string CountOf(double count) { return std::to_string(static_cast<long>(count)); }

std::string ThingsOf(std::optional<SensorKind> kind) {
  if (!kind) return "files";
  if (*kind == SensorKind::kCamera) return "pictures";
  return *kind == SensorKind::kLidar ? "clouds" : "poses";
}

// Failures of one sensor for one loss, with the end of those that tells most.
struct BlindSensor {
  Blind most;
  std::vector<const Edge*> edges;
};

// What other pairs of these sensors failed for without saying of what, as two lidars do.
void TakeSilent(CauseSearch& search, std::map<SensorId, BlindSensor>& blind) {
  const auto is_silent = [](const EdgeEnd& end) {
    const auto sight = SightOf(end);
    return !sight || sight->captures == 0;  // neither sensor has a file
  };
  for (auto& [sensor, of_sensor] : blind) {
    const auto silent = search.Take([&, &id = sensor](const Edge& edge) {
      return SawTooLittle(edge) && IsEndOf(edge, id) && is_silent(EndsOf(edge)[0]) && is_silent(EndsOf(edge)[1]);
    });
    of_sensor.edges.insert(of_sensor.edges.end(), silent.begin(), silent.end());
  }
}

// Two sensors that see the board at other times look different ways, and no one of them is to blame.
bool FailedForLoss(const Edge& edge, Loss loss) {
  return loss == Loss::kNoBoard ? FailedFor(edge, {"too_few_captures"}) : SawTooLittle(edge);
}

bool SeesAlmostNothing(const Blind& blind) {
  const auto method = MethodNamed(blind.end.edge->method);
  const double least = method ? static_cast<double>(RowOf(*method).captures.least) : 0.0;
  return blind.sight.with_board < std::max(least, kAlmostNeverRatio * blind.sight.readable());
}

bool HasGoodEdge(const CauseSearch& search, const EdgeEnd& end) {
  return std::any_of(search.edges.begin(), search.edges.end(), [&](const Edge& edge) {
    return edge.state == EdgeState::kGood && edge.session == end.edge->session && IsEndOf(edge, end.sensor);
  });
}

bool WasRecordedApart(const Blind& blind) {
  for (const EdgeEnd& other : EndsOf(*blind.end.edge))
    if (const auto sight = SightOf(other); sight && other.sensor != blind.end.sensor)
      return RecordedApart(blind.sight.files, sight->files, sight->captures);
  return false;
}

// What the edge of the same session between these two tells of the first. Nothing: there is none.
std::optional<Sight> SightBeside(const CauseSearch& search, const SessionId& session, const SensorId& one,
                                 const SensorId& other) {
  for (const Edge& edge : search.edges)
    if (edge.session == session && IsEndOf(edge, one) && IsEndOf(edge, other))
      for (const EdgeEnd& end : EndsOf(edge))
        if (const auto sight = SightOf(end); sight && end.sensor == one) return sight;
  return std::nullopt;
}

// Both are told of by an edge of this session, and have no capture together.
bool ShareNone(const CauseSearch& search, const SessionId& session, const SensorId& one, const SensorId& other) {
  const auto of_one = SightBeside(search, session, one, other), of_other = SightBeside(search, session, other, one);
  return of_one && of_other &&
         RecordedInTurn(of_one->files, of_other->files, of_one->files + of_other->files - of_one->captures);
}

// Of the pair's captures those that sensors have which recorded in turn with this one and with each other. All that
// these recorded, the partner did too.
double CapturesInTurn(const CauseSearch& search, const Blind& blind) {
  const Edge& edge = *blind.end.edge;
  const SensorId &sensor = blind.end.sensor, &partner = sensor == edge.frame_a ? edge.frame_b : edge.frame_a;
  std::vector<SensorId> thirds;
  double captures = 0.0;
  for (const Edge& beside : search.edges) {
    if (beside.session != edge.session || !IsEndOf(beside, partner) || IsEndOf(beside, sensor)) continue;
    const SensorId& third = partner == beside.frame_a ? beside.frame_b : beside.frame_a;
    const auto of_third = SightBeside(search, edge.session, third, partner);
    const auto of_partner = SightBeside(search, edge.session, partner, third);
    if (!of_third || !of_partner || of_partner->files != of_partner->captures) continue;
    const auto shares_none = [&](const SensorId& other) { return ShareNone(search, edge.session, other, third); };
    if (!shares_none(sensor) || !std::all_of(thirds.begin(), thirds.end(), shares_none)) continue;
    thirds.push_back(third);
    captures += of_third->files;
  }
  return captures;
}

double CapturesOfItsPasses(const CauseSearch& search, const Blind& blind) {
  return blind.sight.captures - CapturesInTurn(search, blind);
}

bool LacksNoFiles(const CauseSearch& search, const Blind& blind) {
  const double captures = CapturesOfItsPasses(search, blind);
  return WasRecordedApart(blind) || (captures < blind.sight.captures && !LacksFiles(blind.sight.files, captures));
}

// Where sensors look all around, each sees the board in a part of the captures, and that a pair sees it in too few
// together is said by the pair.
bool IsToBlame(const CauseSearch& search, const Blind& blind, Loss loss) {
  if (blind.sight.LargestLoss() != loss) return false;
  if (loss == Loss::kNoFile) return !LacksNoFiles(search, blind);
  return loss == Loss::kUnreadable || (SeesAlmostNothing(blind) && !HasGoodEdge(search, blind.end));
}

std::map<SensorId, BlindSensor> TakeBlind(CauseSearch& search, Loss loss) {
  const std::vector<const Edge*> taken = search.Take([&](const Edge& edge) {
    const auto blind = FailedForLoss(edge, loss) ? BlindEndOf(edge) : std::nullopt;
    return blind && IsToBlame(search, *blind, loss);
  });
  std::map<SensorId, BlindSensor> by_sensor;
  for (const Edge* edge : taken) {
    const Blind blind = *BlindEndOf(*edge);
    BlindSensor& of_sensor = by_sensor.try_emplace(blind.end.sensor, BlindSensor{blind, {}}).first->second;
    of_sensor.edges.push_back(edge);
    if (blind.sight.captures > of_sensor.most.sight.captures) of_sensor.most = blind;
  }
  if (loss != Loss::kNoBoard) TakeSilent(search, by_sensor);  // which look for no board
  return by_sensor;
}

RootCause CauseOf(CauseKind kind, const SensorId& sensor, const BlindSensor& blind) {
  RootCause cause;
  cause.kind = kind;
  cause.sensors = {sensor};
  cause.edges = IdsOf(blind.edges);
  return cause;
}

RootCause MissingFiles(const CauseSearch& search, const SensorId& sensor, const BlindSensor& blind) {
  RootCause cause = CauseOf(CauseKind::kFilesMissing, sensor, blind);
  const Sight& sight = blind.most.sight;
  const auto kind = KindOf(search.headers, *blind.most.end.edge, sensor);
  const std::string name = sensor.str(), things = ThingsOf(kind) == "poses" ? "poses" : "files";
  cause.said.why = sight.files == 0 ? name + " has no " + things
                                    : name + " has " + things + " for " + CountOf(sight.files) + " of " +
                                          CountOf(CapturesOfItsPasses(search, blind.most)) + " captures";
  const std::string place = things == "poses" ? name + "/poses.csv" : name + "/";
  cause.said.what_to_do = "Copy what is missing into " + place + ", or take these captures again";
  cause.command = kPushAgain;
  return cause;
}

// Of several sensors without a file the same is to be done.
RootCause AbsentSensors(const std::map<SensorId, BlindSensor>& absent) {
  RootCause cause;
  cause.kind = CauseKind::kFilesMissing;
  for (const auto& [sensor, blind] : absent) {
    cause.sensors.push_back(sensor);
    for (const EdgeId& edge : IdsOf(blind.edges)) cause.edges.push_back(edge);
  }
  cause.said.why = List(cause.sensors) + " have no files";
  cause.said.what_to_do = "Copy them into their folders, or take these captures again";
  cause.command = kPushAgain;
  return cause;
}

RootCause UnreadableFiles(const CauseSearch& search, const SensorId& sensor, const BlindSensor& blind) {
  RootCause cause = CauseOf(CauseKind::kFilesUnreadable, sensor, blind);
  const EdgeEnd& end = blind.most.end;
  const Sight& sight = blind.most.sight;
  cause.said.why = CountOf(sight.unreadable) + " of " + CountOf(sight.files) + " " +
                   ThingsOf(KindOf(search.headers, *end.edge, sensor)) + " of " + sensor.str() + " cannot be read";
  const std::vector<CaptureResidual>& captures = end.edge->captures;
  if (const auto first = end.Figure("first_unreadable", "_idx");
      first && *first < static_cast<double>(captures.size())) {
    cause.captures = {captures[static_cast<std::size_t>(*first)].capture};
    cause.said.why += ", the first is " + cause.captures.front().str();
  }
  cause.said.what_to_do = "Copy them again from where they were recorded, or take these captures again";
  cause.command = kPushAgain;
  return cause;
}

RootCause UnseenBoard(const CauseSearch& search, const SensorId& sensor, const BlindSensor& blind) {
  RootCause cause = CauseOf(CauseKind::kBoardUnseen, sensor, blind);
  const EdgeEnd& end = blind.most.end;
  const Sight& sight = blind.most.sight;
  const auto kind = KindOf(search.headers, *end.edge, sensor);
  const std::vector<const Target*> boards = BoardsOf(search.headers, end);
  for (const Target* board : boards) cause.boards.push_back(board->id);
  const std::string name = sensor.str(), board = boards.size() == 1 ? BoardName(*boards.front()) : "a board";
  cause.said.why = name + " sees " + board + " in " + (sight.with_board == 0 ? "none" : CountOf(sight.with_board)) +
                   " of " + CountOf(sight.readable()) + " " + ThingsOf(kind);
  const std::string more = "in " + std::to_string(kCapturesMore) + " more captures";
  cause.said.what_to_do =
      kind == SensorKind::kLidar
          ? "Hold the board near " + name + ", free of walls, " + more + ", and check its plate_size_m"
          : "Show the whole board to " + name + ", sharp and evenly lit, " + more;
  cause.command = kCheckFirst;
  return cause;
}

std::vector<SensorId> SensorsOf(const std::vector<const Edge*>& edges) {
  std::set<SensorId> sensors;
  for (const Edge* edge : edges) sensors.insert({edge->frame_a, edge->frame_b});
  return {sensors.begin(), sensors.end()};
}

// Of good pairs of the newest session of each sensor, where its files were enough all the same. By sensor the end that
// lost most.
std::map<SensorId, Blind> EndsLackingFiles(const CauseSearch& search) {
  std::map<SensorId, std::pair<Stamp, Blind>> worst;
  for (const Edge& edge : search.edges) {
    const auto at = search.captured_at.find(edge.session);
    if (edge.state != EdgeState::kGood || at == search.captured_at.end()) continue;
    for (const EdgeEnd& end : EndsOf(edge)) {
      const Sight none, sight = SightOf(end).value_or(none);
      const auto known = worst.try_emplace(end.sensor, at->second, Blind{end, sight}).first;
      const auto lost = [](const Sight& one) { return one.captures - one.files; };
      const bool newer = known->second.first < at->second, same = known->second.first == at->second;
      if (newer || (same && lost(known->second.second.sight) < lost(sight))) known->second = {at->second, {end, sight}};
    }
  }
  std::map<SensorId, Blind> lacking;
  for (const auto& [sensor, one] : worst)
    if (LacksFiles(one.second.sight.files, one.second.sight.captures) && !LacksNoFiles(search, one.second))
      lacking.emplace(sensor, one.second);
  return lacking;
}

}  // namespace

void FindFileCauses(CauseSearch& search) {
  std::map<SensorId, BlindSensor> missing = TakeBlind(search, Loss::kNoFile);
  for (const auto& [sensor, blind] : EndsLackingFiles(search)) missing.try_emplace(sensor, BlindSensor{blind, {}});
  std::map<SensorId, BlindSensor> absent;
  for (const auto& [sensor, blind] : missing)
    if (blind.most.sight.files == 0) absent.emplace(sensor, blind);
  if (absent.size() > 1) search.causes.push_back(AbsentSensors(absent));
  for (const auto& [sensor, blind] : missing)
    if (absent.size() < 2 || !absent.contains(sensor)) search.causes.push_back(MissingFiles(search, sensor, blind));
  for (const auto& [sensor, blind] : TakeBlind(search, Loss::kUnreadable))
    search.causes.push_back(UnreadableFiles(search, sensor, blind));
}

void FindUnseenBoards(CauseSearch& search) {
  for (const auto& [sensor, blind] : TakeBlind(search, Loss::kNoBoard))
    search.causes.push_back(UnseenBoard(search, sensor, blind));
}

void FindShortSessions(CauseSearch& search) {
  const auto captures_of = [](const Edge& edge) {
    const auto captures = edge.figures.find("captures_total");
    return captures == edge.figures.end() ? kCapturesOfSession : captures->second;
  };
  const std::vector<const Edge*> taken = search.Take([&](const Edge& edge) {
    return FailedFor(edge, {"too_few_captures"}) && !edge.session.empty() && captures_of(edge) < kCapturesOfSession;
  });
  std::map<SessionId, std::vector<const Edge*>> by_session;
  for (const Edge* edge : taken) by_session[edge->session].push_back(edge);
  for (const auto& [session, edges] : by_session) {
    RootCause cause{CauseKind::kShortSession, SensorsOf(edges), {}, {}, IdsOf(edges), {}, kCheckFirst};
    double captures = 0.0;
    for (const Edge* edge : edges) captures = std::max(captures, captures_of(*edge));
    cause.said.why = "the session of " + NameOfSession(session, search.captured_at) + " has " + CountOf(captures) +
                     (captures == 1 ? " capture only" : " captures only");
    cause.said.what_to_do =
        "Take " + std::to_string(kCapturesUsual) + " captures, with the board at different distances and tilts";
    search.causes.push_back(std::move(cause));
  }
}

void FindNotMeasured(CauseSearch& search) {
  std::set<SensorId> named;
  for (const Edge& edge : search.edges) named.insert({edge.frame_a, edge.frame_b});
  RootCause cause;
  cause.kind = CauseKind::kNotMeasured;
  for (const SensorPose& pose : search.solution.poses)
    if (!pose.known && !named.contains(pose.sensor)) cause.sensors.push_back(pose.sensor);
  if (cause.sensors.empty()) return;
  const std::string sensors = List(cause.sensors), them = cause.sensors.size() == 1 ? "it" : "them";
  cause.said.why = "no session measured " + sensors;
  cause.said.what_to_do =
      "Capture " + sensors + " together with a known sensor, or take " + them + " out of session.yaml";
  search.causes.push_back(std::move(cause));
}

}  // namespace rigcal::fleet
