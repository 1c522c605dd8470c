#include "storage/audit.h"

#include "storage/query.h"

namespace rigcal::storage {
namespace {

constexpr const char* kAuditSubject = "the audit";

// Columns number, at_ns, robot_id, who, what, hash.
AuditRow AuditRowOf(const Query& query) {
  AuditRow row;
  row.number = query.Int(0);
  row.at = query.Time(1);
  if (!query.IsNull(2)) row.robot = query.IdAt<RobotId>(2);
  row.who = query.Text(3);
  row.what = query.Text(4);
  if (!query.IsNull(5)) row.hash = query.IdAt<Digest>(5);
  return row;
}

// The next number after all that there are, also where one of both tables was cut.
std::int64_t NextAuditNumber(Store& store) {
  Query query(store,
              "SELECT max(coalesce((SELECT max(number) FROM audit), 0), coalesce((SELECT max(number) FROM "
              "audit_chain), 0)) + 1");
  return query.Step() ? query.Int(0) : 1;
}

Digest AuditHead(Store& store) {
  Query query(store, "SELECT hash FROM audit_chain ORDER BY number DESC LIMIT 1");
  return query.Step() ? query.IdAt<Digest>(0) : Digest(kFirstAuditHash);
}

// Of a row that is gone while its hash is there.
std::optional<std::int64_t> FirstMissingAudit(Store& store) {
  Query query(store,
              "SELECT number FROM audit_chain c WHERE NOT EXISTS (SELECT 1 FROM audit a WHERE a.number = c.number) "
              "ORDER BY number LIMIT 1");
  return query.Step() ? std::optional(query.Int(0)) : std::nullopt;
}

std::optional<AuditFault> AuditFaultOf(const AuditRow& row, const Digest& before) {
  if (!row.hash) return AuditFault{AuditFault::Kind::kWithoutHash, row.number, row.at};
  if (AuditHash(before, row) != *row.hash) return AuditFault{AuditFault::Kind::kChanged, row.number, row.at};
  return std::nullopt;
}

// Up to the first row that does not hold.
void WalkAudit(Store& store, AuditCheck& check) {
  Query query(store,
              "SELECT a.number, a.at_ns, c.robot_id, a.who, a.what, c.hash FROM audit a "
              "LEFT JOIN audit_chain c ON c.number = a.number ORDER BY a.number");
  while (query.Step()) {
    const AuditRow row = AuditRowOf(query);
    check.fault = AuditFaultOf(row, check.head);
    if (check.fault) return;
    check.head = *row.hash;
    check.head_number = row.number;
    ++check.rows;
  }
}

}  // namespace

Status AppendAudit(Store& store, Stamp now, const std::string& who, const std::string& what, const RobotId& robot) {
  return store.connection().Append(kAuditSubject, [&]() -> Status {
    const AuditRow row{NextAuditNumber(store), now, robot, who, what};
    Query(store, "INSERT INTO audit VALUES (?, ?, ?, ?)").Bind(row.number, now, who, what).Run();
    Query(store, "INSERT INTO audit_chain VALUES (?, ?, ?)")
        .Bind(row.number, NullIfEmpty(robot), AuditHash(AuditHead(store), row))
        .Run();
    return {};
  });
}

Result<std::vector<AuditRow>> LoadAudit(Store& store, const RobotId& robot, std::int64_t before, std::int64_t limit) {
  return Load<std::vector<AuditRow>>(store, kAuditSubject, [&]() -> Result<std::vector<AuditRow>> {
    const std::int64_t below = before > 0 ? before : kAllRows;
    Query query(store, robot.empty() ? "SELECT a.number, a.at_ns, c.robot_id, a.who, a.what, c.hash FROM audit a "
                                       "LEFT JOIN audit_chain c ON c.number = a.number "
                                       "WHERE a.number < ?1 ORDER BY a.number DESC LIMIT ?2"
                                     : "SELECT a.number, a.at_ns, c.robot_id, a.who, a.what, c.hash FROM audit_chain c "
                                       "JOIN audit a ON a.number = c.number "
                                       "WHERE c.number < ?1 AND c.robot_id = ?3 ORDER BY c.number DESC LIMIT ?2");
    query.Bind(below, limit);
    if (!robot.empty()) query.Bind(robot);
    std::vector<AuditRow> rows;
    while (query.Step()) rows.push_back(AuditRowOf(query));
    return rows;
  });
}

Result<AuditCheck> VerifyAudit(Store& store) {
  return Load<AuditCheck>(store, kAuditSubject, [&]() -> Result<AuditCheck> {
    AuditCheck check;
    RIGCAL_TRY(store.Read([&]() -> Status {
      WalkAudit(store, check);
      const auto missing = FirstMissingAudit(store);
      if (missing && (!check.fault || *missing < check.fault->number))
        check.fault = AuditFault{AuditFault::Kind::kMissing, *missing};
      return {};
    }));
    return check;
  });
}

}  // namespace rigcal::storage
