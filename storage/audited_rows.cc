#include "storage/audited_rows.h"

#include <array>
#include <limits>
#include <utility>

#include "server/base/digests/sha256.h"

namespace rigcal::storage {
namespace {

struct HeldKind {
  const char *kind, *plural;
  const char* columns;    // as one text, NULL as nothing
  const char* beside;     // likewise what other tables say of it: of a row that is held by itself
  const char* what;       // the row in a few words
  const char* unaudited;  // of a row `t`: that it needs no audit row
};

// A session that came whole is current by a word of the robot's, and nobody decided that: its first word alone.
constexpr std::array<HeldKind, 3> kHeldKinds = {{
    {"decision", "decisions",
     "number || char(10) || robot_id || char(10) || revision_number || char(10) || how || char(10) || at_ns || char(10) "
     "|| who || char(10) || reason || char(10) || edge_watermark",
     "''",
     "replace(how, '_', ' ') || ' revision ' || revision_number || ' of robot ' || robot_id || ', by ' || who", "0"},
    {"standing", "standings",
     "number || char(10) || robot_id || char(10) || at_ns || char(10) || how || char(10) || coalesce(session_number, '') "
     "|| char(10) || coalesce(edge_number, '') || char(10) || coalesce(sensor_id, '') || char(10) || who || char(10) || "
     "reason",
     "CASE how WHEN 'epoch' THEN char(10) || coalesce((SELECT begins_ns FROM epoch WHERE standing_number = number), '') "
     "ELSE '' END",
     "how || coalesce(' session number ' || session_number, '') || coalesce(' edge number ' || edge_number, '') || "
     "coalesce(' sensor ' || sensor_id, '') || ' of robot ' || robot_id || ', by ' || who",
     "t.how = 'pushed' AND t.who = 'robot ' || t.robot_id AND t.reason = '' AND NOT EXISTS (SELECT 1 FROM standing e "
     "WHERE e.session_number = t.session_number AND e.number < t.number)"},
    {"policy", "policies",
     "number || char(10) || scope || char(10) || subject || char(10) || version || char(10) || at_ns || char(10) || who "
     "|| char(10) || reason || char(10) || text",
     "''",
     "'version ' || version || ' of the ' || scope || coalesce(nullif(' ' || subject, ' '), '') || ', by ' || who", "0"},
}};

const HeldKind* HeldKindOf(const std::string& kind) {
  for (const HeldKind& one : kHeldKinds)
    if (kind == one.kind) return &one;
  return nullptr;
}

Digest HashOfHeldText(const HeldKind& kind, const std::string& columns) {
  return Sha256Of(kind.kind + std::string("\n") + columns);
}

// Of all rows up to `newest`: of their hashes, each with a line feed after it.
struct HeldBefore {
  std::int64_t rows = 0, newest = 0;
  Digest hash;
};

HeldBefore HashOfRowsBefore(SQLite::Database& database, const HeldKind& kind, std::int64_t newest) {
  SQLite::Statement rows(database, std::string("SELECT number, ") + kind.columns + " FROM " + kind.kind +
                                       " WHERE number <= ? ORDER BY number");
  rows.bind(1, newest);
  HeldBefore before;
  std::string hashes;
  while (rows.executeStep()) {
    before.newest = rows.getColumn(0).getInt64();
    hashes += HashOfHeldText(kind, rows.getColumn(1).getString()).str() + "\n";
    ++before.rows;
  }
  before.hash = Sha256Of(hashes);
  return before;
}

void AppendHeldBefore(SQLite::Database& database, const HeldKind& kind, const HeldBefore& before, Stamp now) {
  SQLite::Statement head(database, "SELECT number, hash FROM audit_chain ORDER BY number DESC LIMIT 1");
  const bool any = head.executeStep();
  if (any && head.getColumn(0).getInt64() == std::numeric_limits<std::int64_t>::max()) return;  // it is damaged
  AuditRow row;
  row.number = (any ? head.getColumn(0).getInt64() : 0) + 1;
  row.at = now;
  row.who = kServerWho;
  row.what = "from here on the audit holds each of the " + std::string(kind.plural) + ": the " +
             std::to_string(before.rows) + " of before it holds together";
  row.holds = HeldRow{kind.kind + std::string("_before"), before.newest, before.hash};
  const Digest hash = AuditHash(Digest(any ? head.getColumn(1).getString() : kFirstAuditHash), row);
  SQLite::Statement audit(database, "INSERT INTO audit VALUES (?, ?, ?, ?)");
  SQLite::bind(audit, row.number, row.at.ns, row.who, row.what);
  audit.exec();
  SQLite::Statement chain(database, "INSERT INTO audit_chain VALUES (?, NULL, ?)");
  SQLite::bind(chain, row.number, hash.str());
  chain.exec();
  SQLite::Statement held(database, "INSERT INTO audit_row VALUES (?, ?, ?, ?)");
  SQLite::bind(held, row.number, row.holds->kind, row.holds->number, row.holds->hash.str());
  held.exec();
}

void AddRowFault(AuditFault fault, AuditCheck& check) {
  ++check.row_faults_count;
  if (check.row_faults.size() < kRowFaultsMax) check.row_faults.push_back(std::move(fault));
}

// "policy 3 (version 2 of the fleet, by Ada)"; of one that is gone its number alone.
std::string NamedHeldRow(SQLite::Database& database, const HeldKind& kind, std::int64_t number) {
  const std::string name = kind.kind + std::string(" ") + std::to_string(number);
  SQLite::Statement row(database,
                        std::string("SELECT ") + kind.what + " FROM " + kind.kind + " WHERE number = ?");
  row.bind(1, number);
  return row.executeStep() ? name + " (" + row.getColumn(0).getString() + ")" : name;
}

void CheckRowsOfBefore(SQLite::Database& database, const HeldKind& kind, const AuditFault& about, const HeldRow& held,
                       AuditCheck& check) {
  const HeldBefore now = HashOfRowsBefore(database, kind, held.number);
  check.from_before += now.rows;
  if (now.hash == held.hash) return;
  AuditFault fault = about;
  fault.kind = AuditFault::Kind::kRowsBeforeChanged;
  fault.row = "the " + std::string(kind.plural) + " up to number " + std::to_string(held.number);
  AddRowFault(std::move(fault), check);
}

void CheckHeldRow(SQLite::Database& database, AuditFault fault, const HeldRow& held, AuditCheck& check) {
  const HeldKind* kind = HeldKindOf(held.kind);
  if (kind == nullptr) {
    const HeldKind* before = HeldKindOf(held.kind.substr(0, held.kind.find('_')));
    if (before != nullptr) CheckRowsOfBefore(database, *before, fault, held, check);
    return;
  }
  const auto hash = HashOfHeldRow(database, held.kind, held.number);
  if (hash == held.hash) return;
  fault.kind = hash ? AuditFault::Kind::kRowChanged : AuditFault::Kind::kRowMissing;
  fault.row = NamedHeldRow(database, *kind, held.number);
  AddRowFault(std::move(fault), check);
}

// Rows that no audit row holds: they were written by somebody else.
void FindUnheldRows(SQLite::Database& database, const HeldKind& kind, AuditCheck& check) {
  const std::string name = kind.kind;
  SQLite::Statement rows(
      database, "SELECT number FROM " + name +
                    " t WHERE NOT EXISTS (SELECT 1 FROM audit_row r JOIN audit_chain c ON c.number = r.number WHERE "
                    "r.kind = '" + name + "' AND r.row_number = t.number) AND NOT EXISTS (SELECT 1 FROM audit_row b JOIN "
                    "audit_chain c ON c.number = b.number WHERE b.kind = '" + name +
                    "_before' AND t.number <= b.row_number) AND NOT (" + kind.unaudited + ") ORDER BY number");
  while (rows.executeStep())
    AddRowFault({AuditFault::Kind::kRowUnheld, 0, {}, NamedHeldRow(database, kind, rows.getColumn(0).getInt64())},
                check);
}

}  // namespace

std::optional<Digest> HashOfHeldRow(SQLite::Database& database, const std::string& kind, std::int64_t number) {
  const HeldKind* held = HeldKindOf(kind);
  if (held == nullptr) return std::nullopt;
  SQLite::Statement row(database, std::string("SELECT ") + held->columns + " || " + held->beside + " FROM " +
                                     held->kind + " WHERE number = ?");
  row.bind(1, number);
  return row.executeStep() ? std::optional(HashOfHeldText(*held, row.getColumn(0).getString())) : std::nullopt;
}

void HoldRowsOfBefore(SQLite::Database& database, Stamp now) {
  for (const HeldKind& kind : kHeldKinds) {
    const HeldBefore before = HashOfRowsBefore(database, kind, std::numeric_limits<std::int64_t>::max());
    if (before.rows > 0) AppendHeldBefore(database, kind, before, now);
  }
}

void CheckHeldRows(SQLite::Database& database, AuditCheck& check) {
  SQLite::Statement held(database,
                         "SELECT r.number, a.at_ns, r.kind, r.row_number, r.hash FROM audit_row r LEFT JOIN audit a ON "
                         "a.number = r.number ORDER BY r.number");
  while (held.executeStep()) {
    AuditFault about;
    about.number = held.getColumn(0).getInt64();
    if (!held.getColumn(1).isNull()) about.at = Stamp{held.getColumn(1).getInt64()};
    const HeldRow row{held.getColumn(2).getString(), held.getColumn(3).getInt64(), Digest(held.getColumn(4).getString())};
    CheckHeldRow(database, about, row, check);
  }
  for (const HeldKind& kind : kHeldKinds) FindUnheldRows(database, kind, check);
}

}  // namespace rigcal::storage
