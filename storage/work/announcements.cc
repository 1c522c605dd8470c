#include "storage/work/announcements.h"

#include "storage/database/query.h"

namespace rigcal::storage {

Status AppendAnnouncement(Store& store, const WaitingAnnouncement& announcement) {
  return store.connection().Append("an announcement of robot " + announcement.robot.str(), [&]() -> Status {
    Query(store, "INSERT INTO waiting_announcement (robot_id, kind, subject, json, at_ns) VALUES (?, ?, ?, ?, ?)")
        .Bind(announcement.robot, announcement.kind, announcement.subject, announcement.json, announcement.at)
        .Run();
    return {};
  });
}

Result<std::vector<WaitingAnnouncement>> TakeAnnouncements(Store& store) {
  return Append<std::vector<WaitingAnnouncement>>(
      store, "announcements", [&]() -> Result<std::vector<WaitingAnnouncement>> {
        Query query(store, "SELECT robot_id, kind, subject, json, at_ns FROM waiting_announcement ORDER BY number");
        std::vector<WaitingAnnouncement> taken;
        while (query.Step())
          taken.push_back({query.IdAt<RobotId>(0), query.Text(1), query.Text(2), query.Text(3), query.Time(4)});
        Query(store, "DELETE FROM waiting_announcement").Run();
        return taken;
      });
}

}  // namespace rigcal::storage
