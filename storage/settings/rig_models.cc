#include "storage/settings/rig_models.h"

#include "storage/audit.h"
#include "storage/database/query.h"
#include "storage/sessions/standing.h"
#include "storage/sessions/standing_row.h"

namespace rigcal::storage {
namespace {

std::string RigModelSubject(const std::string& name) { return "rig model " + name; }

constexpr const char* kRigModelColumns = "SELECT number, name, version, at_ns, who, reason, text FROM rig_model ";

RigModelVersion RigModelVersionOf(const Query& query) {
  RigModelVersion version;
  version.number = query.Int(0);
  version.name = query.Text(1);
  version.version = query.Int(2);
  version.word = {query.Time(3), query.Text(4), query.Text(5)};
  version.text = query.Text(6);
  return version;
}

}  // namespace

Result<RigModelVersion> AppendRigModel(Store& store, const std::string& name, const std::string& text,
                                       const Word& word) {
  RIGCAL_TRY(CheckWord(word));
  return Append<RigModelVersion>(store, RigModelSubject(name), [&]() -> Result<RigModelVersion> {
    RIGCAL_ASSIGN(const auto newest, LoadRigModelVersion(store, name));
    if (newest && newest->text == text) return *newest;
    RigModelVersion next{name, 0, newest ? newest->version + 1 : 1, word, text};
    next.number = Query(store,
                        "INSERT INTO rig_model (name, version, at_ns, who, reason, text) VALUES (?, ?, ?, ?, ?, ?) "
                        "RETURNING number")
                      .Bind(next.name, next.version, word.at, word.who, word.reason, next.text)
                      .RunForKey()
                      .value();
    RIGCAL_TRY(
        AppendAudit(store, word.at, word.who,
                    "set version " + std::to_string(next.version) + " of " + RigModelSubject(name) + Because(word), {},
                    AuditedRow{AuditedKind::kRigModel, next.number}));
    return next;
  });
}

Result<std::optional<RigModelVersion>> LoadRigModelVersion(Store& store, const std::string& name) {
  using Version = std::optional<RigModelVersion>;
  return Load<Version>(store, RigModelSubject(name), [&]() -> Result<Version> {
    Query query(store, std::string(kRigModelColumns) + "WHERE name = ? ORDER BY version DESC LIMIT 1");
    return query.Bind(name).Step() ? Version(RigModelVersionOf(query)) : std::nullopt;
  });
}

Result<std::int64_t> LoadRigModelWatermark(Store& store) {
  return Load<std::int64_t>(store, "rig models", [&]() -> Result<std::int64_t> {
    Query query(store, "SELECT coalesce(max(number), 0) FROM rig_model");
    return query.Step() ? query.Int(0) : 0;
  });
}

// From each name to the next: a model may have very many versions.
Result<std::vector<RigModelVersion>> LoadRigModelVersions(Store& store, int max) {
  using Versions = std::vector<RigModelVersion>;
  return Load<Versions>(store, "rig models", [&]() -> Result<Versions> {
    Versions versions;
    std::string last;  // no model is called so
    while (static_cast<int>(versions.size()) < max) {
      Query query(store, std::string(kRigModelColumns) + "WHERE name > ? ORDER BY name, version DESC LIMIT 1");
      if (!query.Bind(last).Step()) break;
      versions.push_back(RigModelVersionOf(query));
      last = versions.back().name;
    }
    return versions;
  });
}

Result<std::int64_t> CountRobotsOfModelToJudge(Store& store, std::int64_t rig_model_number) {
  return Load<std::int64_t>(store, "robots to judge", [&]() -> Result<std::int64_t> {
    Query query(store, "SELECT count(*) FROM waiting_rig_model WHERE rig_model_number = ?");
    return query.Bind(rig_model_number).Step() ? query.Int(0) : 0;
  });
}

// Of each robot that ever was of it what its newest session says: from each robot to the next, two look-ups each, as
// a robot may have very many sessions.
Result<std::vector<RobotId>> LoadRobotsOfModel(Store& store, const std::string& name, int max) {
  using Robots = std::vector<RobotId>;
  return Load<Robots>(store, RigModelSubject(name), [&]() -> Result<Robots> {
    Query query(
        store,
        "WITH RECURSIVE r(robot_id) AS (SELECT min(robot_id) FROM session_model WHERE rig_model = ?1 UNION ALL "
        "SELECT (SELECT min(m.robot_id) FROM session_model m WHERE m.rig_model = ?1 AND m.robot_id > r.robot_id) "
        "FROM r WHERE r.robot_id IS NOT NULL) SELECT robot_id FROM r WHERE robot_id IS NOT NULL "
        "AND ?1 = (SELECT rig_model FROM session_model newest WHERE newest.robot_id = r.robot_id "
        "ORDER BY captured_ns DESC, session_number DESC LIMIT 1) LIMIT ?2");
    query.Bind(name, max);
    Robots robots;
    while (query.Step()) robots.push_back(query.IdAt<RobotId>(0));
    return robots;
  });
}

}  // namespace rigcal::storage
