#include "storage/audit.h"

#include <limits>

#include "storage/audited_rows.h"
#include "storage/database/query.h"
#include "storage/revisions/decided_content.h"

namespace rigcal::storage {
namespace {

constexpr const char* kAuditSubject = "the audit";

const std::string kAuditColumns = "a.number, a.at_ns, c.robot_id, a.who, a.what, c.hash";

// Columns kAuditColumns.
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

// The next number after all that there are, also where one of the tables was cut.
Result<std::int64_t> NextAuditNumber(Store& store) {
  Query query(store,
              "SELECT max(coalesce((SELECT max(number) FROM audit), 0), coalesce((SELECT max(number) FROM "
              "audit_chain), 0), coalesce((SELECT max(number) FROM audit_row), 0))");
  const std::int64_t newest = query.Step() ? query.Int(0) : 0;
  if (newest < std::numeric_limits<std::int64_t>::max()) return newest + 1;
  return Fail(ErrorCode::kStorage,
              "the audit is damaged: its newest row has the number " + std::to_string(newest) +
                  ", so that no row can follow, and nothing can be decided",
              "`rigcal audit verify` names what is wrong; put the store back from a backup.");
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
  Query query(store, "SELECT " + kAuditColumns +
                         ", r.kind, r.row_number, r.hash FROM audit a LEFT JOIN audit_chain c ON c.number = a.number "
                         "LEFT JOIN audit_row r ON r.number = a.number ORDER BY a.number");
  while (query.Step()) {
    AuditRow row = AuditRowOf(query);
    if (!query.IsNull(6)) row.holds = HeldRow{query.Text(6), query.Int(7), query.IdAt<Digest>(8)};
    check.fault = AuditFaultOf(row, check.head);
    if (check.fault) return;
    check.head = *row.hash;
    check.head_number = row.number;
    ++check.rows;
  }
}

}  // namespace

namespace {

std::string KindNameOf(AuditedKind kind) {
  switch (kind) {
    case AuditedKind::kDecision:
      return "decision";
    case AuditedKind::kStanding:
      return "standing";
    case AuditedKind::kPolicy:
      return "policy";
    case AuditedKind::kRigModel:
      return "rig_model";
    case AuditedKind::kBoardMeasure:
      break;
  }
  return "board_measure";
}

Result<HeldRow> HeldRowOf(Store& store, const AuditedRow& about) {
  const std::string kind = KindNameOf(about.kind);
  const auto hash = HashOfHeldRow(store.connection(), kind, about.number);
  if (hash) return HeldRow{kind, about.number, *hash};
  return Fail(ErrorCode::kInternal, kind + " " + std::to_string(about.number) + " was never written",
              "This is a fault of rigcald: please report it.");
}

void InsertAudit(Store& store, const AuditRow& row) {
  Query(store, "INSERT INTO audit VALUES (?, ?, ?, ?)").Bind(row.number, row.at, row.who, row.what).Run();
  Query(store, "INSERT INTO audit_chain VALUES (?, ?, ?)")
      .Bind(row.number, NullIfEmpty(row.robot), AuditHash(AuditHead(store), row))
      .Run();
  if (!row.holds) return;
  Query(store, "INSERT INTO audit_row VALUES (?, ?, ?, ?)")
      .Bind(row.number, row.holds->kind, row.holds->number, row.holds->hash)
      .Run();
}

}  // namespace

Status AppendAudit(Store& store, Stamp now, const std::string& who, const std::string& what, const RobotId& robot,
                   const std::optional<AuditedRow>& about) {
  return store.connection().Append(kAuditSubject, [&]() -> Status {
    RIGCAL_ASSIGN(const std::int64_t number, NextAuditNumber(store));
    AuditRow row{number, now, robot, who, what};
    if (about) {
      RIGCAL_ASSIGN(row.holds, HeldRowOf(store, *about));
    }
    InsertAudit(store, row);
    return {};
  });
}

Status CheckAuditGoesOn(Store& store) {
  return store.connection().Load(kAuditSubject, [&]() -> Status {
    RIGCAL_TRY(NextAuditNumber(store));
    return {};
  });
}

Result<std::vector<AuditRow>> LoadAudit(Store& store, const RobotId& robot, std::int64_t before, std::int64_t limit) {
  return Load<std::vector<AuditRow>>(store, kAuditSubject, [&]() -> Result<std::vector<AuditRow>> {
    const std::int64_t below = before > 0 ? before : kAllRows;
    const std::string decided =
        " LEFT JOIN audit_row r ON r.number = a.number AND r.kind = 'decision' LEFT JOIN decision d ON d.number = "
        "r.row_number ";
    const std::string of_all = " FROM audit a LEFT JOIN audit_chain c ON c.number = a.number" + decided +
                               "WHERE a.number < ?1 ORDER BY a.number DESC LIMIT ?2";
    const std::string of_robot = " FROM audit_chain c JOIN audit a ON a.number = c.number" + decided +
                                 "WHERE c.number < ?1 AND c.robot_id = ?3 ORDER BY c.number DESC LIMIT ?2";
    Query query(store, "SELECT " + kAuditColumns + ", d.digest" + (robot.empty() ? of_all : of_robot));
    query.Bind(below, limit);
    if (!robot.empty()) query.Bind(robot);
    std::vector<AuditRow> rows;
    while (query.Step()) {
      rows.push_back(AuditRowOf(query));
      if (!query.IsNull(6)) rows.back().digest = query.IdAt<Digest>(6);
    }
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
      CheckHeldRows(store.connection(), check);
      CheckDecidedContent(store, check);
      return {};
    }));
    return check;
  });
}

}  // namespace rigcal::storage
