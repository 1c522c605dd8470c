#include "storage/work/announcements.h"

#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

const std::string kAnnouncementsSubject = "announcements";

Result<bool> HasAnnouncements(Store& store, const std::string& server) {
  return Load<bool>(store, kAnnouncementsSubject, [&]() -> Result<bool> {
    return Query(store, "SELECT 1 FROM waiting_announcement WHERE server = ? LIMIT 1").Bind(server).Step();
  });
}

// Without a write where nobody is there to be told.
Result<bool> IsHeard(Store& store, const std::string& sender) {
  return Load<bool>(store, kAnnouncementsSubject, [&]() -> Result<bool> {
    Query query(store,
                "SELECT 1 FROM lease_server WHERE until_ns > (SELECT now_ns FROM store_clock) AND owner <> ? LIMIT 1");
    return query.Bind(sender).Step();
  });
}

}  // namespace

Status AppendAnnouncement(Store& store, const WaitingAnnouncement& announcement, const std::string& sender) {
  RIGCAL_ASSIGN(const bool is_heard, IsHeard(store, sender));
  if (!is_heard) return {};
  return store.connection().Append("an announcement of robot " + announcement.robot.str(), [&]() -> Status {
    Query(store,
          "INSERT INTO waiting_announcement (robot_id, kind, subject, json, at_ns, server) SELECT ?, ?, ?, ?, ?, owner "
          "FROM lease_server WHERE until_ns > (SELECT now_ns FROM store_clock) AND owner <> ? ORDER BY owner")
        .Bind(announcement.robot, announcement.kind, announcement.subject, announcement.json, announcement.at, sender)
        .Run();
    return {};
  });
}

Result<std::vector<WaitingAnnouncement>> TakeAnnouncements(Store& store, const std::string& server) {
  using Taken = std::vector<WaitingAnnouncement>;
  RIGCAL_ASSIGN(const bool are_some, HasAnnouncements(store, server));
  if (!are_some) return Taken();
  return Append<Taken>(store, kAnnouncementsSubject, [&]() -> Result<Taken> {
    Query query(store,
                "SELECT robot_id, kind, subject, json, at_ns FROM waiting_announcement WHERE server = ? ORDER BY "
                "number");
    Taken taken;
    query.Bind(server);
    while (query.Step())
      taken.push_back({query.IdAt<RobotId>(0), query.Text(1), query.Text(2), query.Text(3), query.Time(4)});
    Query(store, "DELETE FROM waiting_announcement WHERE server = ?").Bind(server).Run();
    return taken;
  });
}

}  // namespace rigcal::storage
