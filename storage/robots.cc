#include "storage/query.h"
#include "storage/sessions.h"

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
                "SELECT robot_id, first_seen_ns, (SELECT count(*) FROM session s WHERE s.robot_id = r.robot_id), "
                "(SELECT count(*) FROM counted_edge c WHERE c.robot_id = r.robot_id) FROM robot r WHERE robot_id = ?");
    if (!query.Bind(robot).Step()) return std::nullopt;
    return RobotRow{query.IdAt<RobotId>(0), query.Time(1), query.Int(2), query.Int(3)};
  });
}

Result<bool> HasRobot(Store& store, const RobotId& robot) {
  return Load<bool>(store, "robot " + robot.str(), [&]() -> Result<bool> {
    return Query(store, "SELECT 1 FROM robot WHERE robot_id = ?").Bind(robot).Step();
  });
}

}  // namespace rigcal::storage
