#include "storage/audit_chain.h"

namespace rigcal::storage {
namespace {

// "retired sensor top of robot mapper-01: taken off" -> mapper-01; empty where it names no robot that is known.
RobotId RobotNamedIn(SQLite::Statement& is_known, const std::string& what) {
  constexpr std::string_view kBefore = " robot ";
  const std::size_t at = what.find(kBefore);
  if (at == std::string::npos) return {};
  const std::size_t begin = at + kBefore.size();
  const std::string name = what.substr(begin, what.find_first_of(":, ", begin) - begin);
  is_known.reset();
  is_known.bind(1, name);
  return RobotId(is_known.executeStep() ? name : "");
}

void InsertAuditHash(SQLite::Statement& insert, const AuditRow& row, const Digest& hash) {
  insert.reset();
  insert.bind(1, row.number);
  row.robot.empty() ? insert.bind(2) : insert.bind(2, row.robot.str());
  insert.bind(3, hash.str());
  insert.exec();
}

}  // namespace

void ChainOldAudit(SQLite::Database& database) {
  SQLite::Statement rows(database, "SELECT number, at_ns, who, what FROM audit ORDER BY number");
  SQLite::Statement is_known(database, "SELECT 1 FROM robot WHERE robot_id = ?");
  SQLite::Statement insert(database, "INSERT INTO audit_chain VALUES (?, ?, ?)");
  Digest before(kFirstAuditHash);
  while (rows.executeStep()) {
    AuditRow row{rows.getColumn(0).getInt64(),
                 {rows.getColumn(1).getInt64()},
                 {},
                 rows.getColumn(2).getString(),
                 rows.getColumn(3).getString()};
    row.robot = RobotNamedIn(is_known, row.what);
    before = AuditHash(before, row);
    InsertAuditHash(insert, row, before);
  }
}

}  // namespace rigcal::storage
