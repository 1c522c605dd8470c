#include "storage/audit_chain.h"

#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

// "retired sensor top of robot mapper-01: taken off" -> mapper-01; empty where it names no robot that is known.
RobotId RobotNamedIn(Connection& connection, const std::string& what) {
  constexpr std::string_view kBefore = " robot ";
  const std::size_t at = what.find(kBefore);
  if (at == std::string::npos) return {};
  const std::size_t begin = at + kBefore.size();
  const std::string name = what.substr(begin, what.find_first_of(":, ", begin) - begin);
  const bool is_known = Query(connection, "SELECT 1 FROM robot WHERE robot_id = ?").Bind(name).Step();
  return RobotId(is_known ? name : "");
}

}  // namespace

void ChainOldAudit(Connection& connection) {
  Query rows(connection, "SELECT number, at_ns, who, what FROM audit ORDER BY number");
  Digest before(kFirstAuditHash);
  while (rows.Step()) {
    AuditRow row{rows.Int(0), rows.Time(1), {}, rows.Text(2), rows.Text(3)};
    row.robot = RobotNamedIn(connection, row.what);
    before = AuditHash(before, row);
    Query(connection, "INSERT INTO audit_chain VALUES (?, ?, ?)")
        .Bind(row.number, NullIfEmpty(row.robot), before)
        .Run();
  }
}

}  // namespace rigcal::storage
