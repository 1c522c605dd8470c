#include <limits>
#include <map>

#include "storage/boards/uses.h"
#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

struct UsedIn {
  std::int64_t number = 0;           // of the session
  std::int64_t first_edge = kNever;  // of its good edges the first that counted; kNever: there is none
  TracedSession session;
};

// By robot; of each the oldest first.
std::map<RobotId, std::vector<UsedIn>> LoadUses(Store& store, const std::string& serial) {
  Query query(store,
              "SELECT s.robot_id, s.number, s.session_id, s.captured_ns, (SELECT c.number FROM edge e "
              "CROSS JOIN counted_edge c ON c.edge_number = e.number WHERE e.session_id = s.session_id "
              "AND e.state = 'good' ORDER BY e.number LIMIT 1) "
              "FROM (SELECT DISTINCT session_number FROM session_board WHERE serial = ? AND serial <> '') b "
              "CROSS JOIN session s ON s.number = b.session_number ORDER BY s.robot_id, s.captured_ns, s.number");
  query.Bind(serial);
  std::map<RobotId, std::vector<UsedIn>> uses;
  while (query.Step())
    uses[query.IdAt<RobotId>(0)].push_back(
        {query.Int(1), query.IsNull(4) ? kNever : query.Int(4), {query.IdAt<SessionId>(2), query.Time(3)}});
  return uses;
}

// Whether sessions of a robot counted when its standings up to some number were known. As LoadSuperseded and
// LoadRetiredSessions say it of the newest.
class Standings {
 public:
  Standings(Store& store, const RobotId& robot) {
    Query words(store,
                "SELECT session_number, number, how = 'retired' FROM standing WHERE robot_id = ? AND session_number IS "
                "NOT NULL ORDER BY number");
    words.Bind(robot);
    while (words.Step()) said_[words.Int(0)].push_back({words.Int(1), words.Int(2) != 0});
    Query repeats(store, "SELECT earlier_number, later_number FROM session_repeat WHERE robot_id = ?");
    repeats.Bind(robot);
    while (repeats.Step()) {
      repeats_.emplace(repeats.Int(0), repeats.Int(1));
      repeats_.emplace(repeats.Int(1), repeats.Int(0));
    }
  }

  [[nodiscard]] bool Counted(std::int64_t session, std::int64_t up_to) const {
    const auto said = said_.find(session);
    if (said == said_.end() || said->second.front().number > up_to) return false;
    bool retired = false;
    for (const Said& one : said->second)
      if (one.number <= up_to) retired = one.retires;
    if (retired) return false;
    const auto [first, last] = repeats_.equal_range(session);
    for (auto other = first; other != last; ++other)
      if (CurrentBy(other->second, up_to) > CurrentBy(session, up_to)) return false;
    return true;
  }

 private:
  struct Said {
    std::int64_t number = 0;
    bool retires = false;
  };
  // The newest word by which it was current.
  [[nodiscard]] std::int64_t CurrentBy(std::int64_t session, std::int64_t up_to) const {
    std::int64_t number = 0;
    if (const auto said = said_.find(session); said != said_.end())
      for (const Said& one : said->second)
        if (one.number <= up_to && !one.retires) number = one.number;
    return number;
  }

  std::map<std::int64_t, std::vector<Said>> said_;     // by session, in order
  std::multimap<std::int64_t, std::int64_t> repeats_;  // both ways
};

// One that is from before standings were kept counts all that had come.
std::vector<int> DependingRevisions(Store& store, const RobotId& robot, const std::vector<UsedIn>& uses,
                                    const Standings& standings) {
  Query query(store,
              "SELECT r.number, r.edge_watermark, w.standing_watermark FROM revision r LEFT JOIN revision_standing w "
              "ON w.robot_id = r.robot_id AND w.revision_number = r.number WHERE r.robot_id = ? ORDER BY r.number");
  query.Bind(robot);
  std::vector<int> revisions;
  while (query.Step())
    for (const UsedIn& use : uses) {
      if (use.first_edge > query.Int(1) || !(query.IsNull(2) || standings.Counted(use.number, query.Int(2)))) continue;
      revisions.push_back(static_cast<int>(query.Int(0)));
      break;
    }
  return revisions;
}

TracedRobot TracedRobotOf(Store& store, const RobotId& robot, const std::vector<UsedIn>& uses) {
  const Standings standings(store, robot);
  TracedRobot traced{robot, {}, DependingRevisions(store, robot, uses, standings)};
  for (const UsedIn& use : uses) {
    traced.sessions.push_back(use.session);
    traced.sessions.back().counts = standings.Counted(use.number, kNever);
  }
  return traced;
}

}  // namespace

Result<BoardTrace> LoadBoardTrace(Store& store, const std::string& serial) {
  BoardTrace trace;
  RIGCAL_TRY(store.connection().Load("what depends on board " + serial, [&] {
    return store.Read([&]() -> Status {
      for (const auto& [robot, uses] : LoadUses(store, serial))
        trace.robots.push_back(TracedRobotOf(store, robot, uses));
      return {};
    });
  }));
  return trace;
}

}  // namespace rigcal::storage
