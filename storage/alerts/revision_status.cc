#include "storage/alerts/revision_status.h"

#include <algorithm>

#include "server/formats/alerts/status_fields.h"
#include "storage/database/compressed.h"
#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

constexpr std::size_t kStatusTextMax = 16u << 20;

// The newest word by which a session was current.
std::string CurrentWordOf(const std::string& session) {
  return "(SELECT max(number) FROM standing WHERE session_number = " + session + " AND how <> 'retired')";
}

// Of a visit `v` with its session `s`: that it counts now, as LoadSuperseded (sessions/standing.h) and
// LoadRetiredSessions (sessions/retired.h) have it.
std::string VisitCounts() {
  const std::string other = "r.earlier_number + r.later_number - s.number";
  return "NOT EXISTS (SELECT 1 FROM session_repeat r WHERE r.robot_id = v.robot_id AND s.number IN (r.earlier_number, "
         "r.later_number) AND " +
         CurrentWordOf(other) + " > " + CurrentWordOf("s.number") +
         ") AND NOT EXISTS (SELECT 1 FROM standing t WHERE t.session_number = s.number AND t.how = 'retired' AND NOT "
         "EXISTS (SELECT 1 FROM standing later WHERE later.session_number = s.number AND later.number > t.number AND "
         "later.how = 'restored'))";
}

std::string RevisionStatusSubject(const RevisionKey& key) {
  return "the status by revision " + std::to_string(key.number) + " of robot " + key.robot.str();
}

}  // namespace

Status AppendRevisionStatus(Store& store, const RevisionKey& key, const StatusFacts& facts) {
  return store.connection().Append(RevisionStatusSubject(key), [&]() -> Status {
    RIGCAL_ASSIGN(std::string zstd,
                  Compress(RevisionStatusSubject(key), formats::WriteStatusFacts(facts), kStatusTextMax));
    Query(store, "INSERT INTO revision_status VALUES (?, ?, ?)")
        .Bind(key.robot, key.number, Blob{std::move(zstd)})
        .Run();
    return {};
  });
}

Result<std::optional<StatusFacts>> LoadRevisionStatus(Store& store, const RevisionKey& key) {
  using Facts = std::optional<StatusFacts>;
  return Load<Facts>(store, RevisionStatusSubject(key), [&]() -> Result<Facts> {
    Query query(store, "SELECT zstd FROM revision_status WHERE robot_id = ? AND revision_number = ?");
    if (!query.Bind(key.robot, key.number).Step()) return std::nullopt;
    RIGCAL_ASSIGN(const std::string text, Decompress(RevisionStatusSubject(key), query.Text(0), kStatusTextMax));
    RIGCAL_ASSIGN(StatusFacts facts, formats::ReadStatusFacts(text));
    return facts;
  });
}

Status AppendModelVisit(Store& store, const std::string& rig_model, const RevisionKey& key, const SessionId& session) {
  return store.connection().Append("a visit of robot " + key.robot.str(), [&]() -> Status {
    Query(store,
          "INSERT INTO model_visit (rig_model, robot_id, session_id, revision_number) VALUES (?, ?, ?, ?) "
          "ON CONFLICT (robot_id, session_id) DO NOTHING")
        .Bind(rig_model, key.robot, session, key.number)
        .Run();
    return {};
  });
}

Result<bool> HasModelVisit(Store& store, const RobotId& robot, const SessionId& session) {
  return Load<bool>(store, "a visit of robot " + robot.str(), [&]() -> Result<bool> {
    Query query(store, "SELECT 1 FROM model_visit WHERE robot_id = ? AND session_id = ?");
    return query.Bind(robot, session).Step();
  });
}

Result<std::vector<RevisionKey>> LoadModelVisits(Store& store, const std::string& rig_model, const RobotId& robot,
                                                 int max) {
  using Keys = std::vector<RevisionKey>;
  return Load<Keys>(store, "the visits of rig model " + rig_model, [&]() -> Result<Keys> {
    const bool of_robot = !robot.empty();
    Query query(store,
                "SELECT v.robot_id, v.revision_number FROM model_visit v CROSS JOIN session s ON s.session_id = "
                "v.session_id WHERE " +
                    std::string(of_robot ? "v.robot_id" : "v.rig_model") + " = ? AND " + VisitCounts() +
                    " ORDER BY v.number DESC LIMIT ?");
    query.Bind(of_robot ? robot.str() : rig_model, max);
    Keys keys;
    while (query.Step()) keys.push_back({query.IdAt<RobotId>(0), static_cast<int>(query.Int(1))});
    std::reverse(keys.begin(), keys.end());
    return keys;
  });
}

}  // namespace rigcal::storage
