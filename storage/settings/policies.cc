#include "storage/settings/policies.h"

#include "storage/audit.h"
#include "storage/database/query.h"
#include "storage/sessions/standing.h"
#include "storage/sessions/standing_row.h"

namespace rigcal::storage {
namespace {

std::string PolicySubject(const PolicyPlace& place) { return "the policy of " + TextOf(place); }

PolicyVersion PolicyVersionOf(const Query& query) {
  PolicyVersion version;
  version.number = query.Int(0);
  version.place = {PolicyScopeOf(query.Text(1)), query.Text(2)};
  version.version = query.Int(3);
  version.word = {query.Time(4), query.Text(5), query.Text(6)};
  version.text = query.Text(7);
  return version;
}

// Its number.
std::int64_t InsertPolicy(Store& store, const PolicyVersion& next) {
  return Query(store,
               "INSERT INTO policy (scope, subject, version, at_ns, who, reason, text) VALUES (?, ?, ?, ?, ?, ?, ?) "
               "RETURNING number")
      .Bind(NameOf(next.place.scope), next.place.subject, next.version, next.word.at, next.word.who, next.word.reason,
            next.text)
      .RunForKey()
      .value();
}

}  // namespace

Result<PolicyVersion> AppendPolicy(Store& store, const PolicyPlace& place, const std::string& text, const Word& word) {
  RIGCAL_TRY(CheckWord(word));
  return Append<PolicyVersion>(store, PolicySubject(place), [&]() -> Result<PolicyVersion> {
    RIGCAL_ASSIGN(const auto newest, LoadPolicy(store, place));
    if (newest && newest->text == text) return *newest;
    PolicyVersion next{place, 0, newest ? newest->version + 1 : 1, word, text};
    next.number = InsertPolicy(store, next);
    RIGCAL_TRY(
        AppendAudit(store, word.at, word.who,
                    "set version " + std::to_string(next.version) + " of " + PolicySubject(place) + Because(word),
                    RobotId(place.scope == PolicyScope::kRobot ? place.subject : ""),
                    AuditedRow{AuditedKind::kPolicy, next.number}));
    return next;
  });
}

Result<std::optional<PolicyVersion>> LoadPolicy(Store& store, const PolicyPlace& place) {
  using Version = std::optional<PolicyVersion>;
  return Load<Version>(store, PolicySubject(place), [&]() -> Result<Version> {
    Query query(store,
                "SELECT number, scope, subject, version, at_ns, who, reason, text FROM policy "
                "WHERE scope = ? AND subject = ? ORDER BY version DESC LIMIT 1");
    return query.Bind(NameOf(place.scope), place.subject).Step() ? Version(PolicyVersionOf(query)) : std::nullopt;
  });
}

Result<std::int64_t> LoadPolicyWatermark(Store& store) {
  return Load<std::int64_t>(store, "policies", [&]() -> Result<std::int64_t> {
    Query query(store, "SELECT coalesce(max(number), 0) FROM policy");
    return query.Step() ? query.Int(0) : 0;
  });
}

Result<std::string> LoadRigModel(Store& store, const RobotId& robot) {
  return Load<std::string>(store, "rig model of robot " + robot.str(), [&]() -> Result<std::string> {
    Query query(store,
                "SELECT rig_model FROM session_model WHERE robot_id = ? "
                "ORDER BY captured_ns DESC, session_number DESC LIMIT 1");
    return query.Bind(robot).Step() ? query.Text(0) : std::string();
  });
}

Result<bool> HasRigModel(Store& store, const std::string& model) {
  return Load<bool>(store, "rig model " + model, [&]() -> Result<bool> {
    return Query(store, "SELECT 1 FROM session_model WHERE rig_model = ? LIMIT 1").Bind(model).Step();
  });
}

// From each name to the next: a fleet has few models, and very many sessions of each.
Result<std::vector<std::string>> LoadRigModels(Store& store, int max) {
  return Load<std::vector<std::string>>(store, "rig models", [&]() -> Result<std::vector<std::string>> {
    std::vector<std::string> models;
    std::string last;  // no model is called so
    while (static_cast<int>(models.size()) < max) {
      Query query(store, "SELECT min(rig_model) FROM session_model WHERE rig_model > ?");
      if (!query.Bind(last).Step() || query.IsNull(0)) break;
      last = query.Text(0);
      models.push_back(last);
    }
    return models;
  });
}

Result<std::vector<RobotId>> LoadRobotsToJudge(Store& store, const RobotId& after, int max) {
  return Load<std::vector<RobotId>>(store, "robots to judge", [&]() -> Result<std::vector<RobotId>> {
    Query query(store,
                "SELECT robot_id FROM waiting_verdict WHERE robot_id > ?1 UNION "
                "SELECT robot_id FROM waiting_rig_model WHERE robot_id > ?1 UNION "
                "SELECT robot_id FROM waiting_merge_anew WHERE robot_id > ?1 ORDER BY robot_id LIMIT ?2");
    query.Bind(after, max);
    std::vector<RobotId> robots;
    while (query.Step()) robots.push_back(query.IdAt<RobotId>(0));
    return robots;
  });
}

Result<std::int64_t> CountRobotsToJudge(Store& store, std::int64_t policy_number) {
  return Load<std::int64_t>(store, "robots to judge", [&]() -> Result<std::int64_t> {
    Query query(store, "SELECT count(*) FROM waiting_verdict WHERE policy_number = ?");
    return query.Bind(policy_number).Step() ? query.Int(0) : 0;
  });
}

}  // namespace rigcal::storage
