#include <algorithm>

#include "storage/database/query.h"
#include "storage/sessions/sessions.h"

namespace rigcal::storage {

Status AppendRobot(Store& store, const RobotId& robot, Stamp now) {
  return store.connection().Append("robot " + robot.str(), [&]() -> Status {
    RIGCAL_TRY(CheckName(RobotTag::kKind, robot.str()));
    Query(store, "INSERT INTO robot VALUES (?, ?) ON CONFLICT DO NOTHING").Bind(robot, now).Run();
    return {};
  });
}

Result<std::optional<RobotRow>> LoadRobot(Store& store, const RobotId& robot) {
  return Load<std::optional<RobotRow>>(store, "robot " + robot.str(), [&]() -> Result<std::optional<RobotRow>> {
    Query query(store,
                "SELECT r.robot_id, r.first_seen_ns, a.sessions, a.edges FROM robot r "
                "JOIN summary_arrivals a ON a.robot_id = r.robot_id WHERE r.robot_id = ?");
    if (!query.Bind(robot).Step()) return std::nullopt;
    return RobotRow{query.IdAt<RobotId>(0), query.Time(1), query.Int(2), query.Int(3)};
  });
}

Result<bool> HasRobot(Store& store, const RobotId& robot) {
  return Load<bool>(store, "robot " + robot.str(), [&]() -> Result<bool> {
    return Query(store, "SELECT 1 FROM robot WHERE robot_id = ?").Bind(robot).Step();
  });
}

namespace {

// One id a row.
std::vector<RobotId> NamesOf(Query& query) {
  std::vector<RobotId> names;
  while (query.Step()) names.push_back(query.IdAt<RobotId>(0));
  return names;
}

}  // namespace

Result<std::vector<RobotId>> LoadRobotNames(Store& store, const std::string& prefix, std::int64_t limit) {
  return Load<std::vector<RobotId>>(store, "names of robots", [&]() -> Result<std::vector<RobotId>> {
    // Names are ASCII, and none has the last character of it.
    Query query(store, "SELECT robot_id FROM robot WHERE robot_id >= ? AND robot_id < ? ORDER BY robot_id LIMIT ?");
    return NamesOf(query.Bind(prefix, prefix + '\x7f', limit));
  });
}

Result<std::vector<RobotId>> LoadRobotsBeside(Store& store, const RobotId& name, std::int64_t each_way) {
  return Load<std::vector<RobotId>>(store, "names of robots", [&]() -> Result<std::vector<RobotId>> {
    Query before(store, "SELECT robot_id FROM robot WHERE robot_id < ? ORDER BY robot_id DESC LIMIT ?");
    std::vector<RobotId> names = NamesOf(before.Bind(name, each_way));
    std::reverse(names.begin(), names.end());
    Query after(store, "SELECT robot_id FROM robot WHERE robot_id > ? ORDER BY robot_id LIMIT ?");
    for (RobotId& one : NamesOf(after.Bind(name, each_way))) names.push_back(std::move(one));
    return names;
  });
}

Result<std::vector<RobotId>> LoadRobotsNamed(Store& store, const std::vector<RobotId>& names) {
  return Load<std::vector<RobotId>>(store, "names of robots", [&]() -> Result<std::vector<RobotId>> {
    Query query(store,
                "SELECT robot_id FROM robot WHERE robot_id IN (SELECT value FROM json_each(?)) ORDER BY robot_id");
    return NamesOf(query.Bind(ListOf(names)));
  });
}

}  // namespace rigcal::storage
