#include "storage/audited_rows.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <string_view>
#include <utility>

#include "server/base/digests/sha256.h"
#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

struct HeldKind {
  const char *kind, *plural;
  const char* since;      // the file of storage/schema after which its rows of before are to be held
  const char* columns;    // as one text, NULL as nothing
  const char* beside;     // likewise what there is of a row that is held by itself only
  const char* reals;      // columns that are reals, a comma before each: engines write those differently
  const char* what;       // the row in a few words
  const char* unaudited;  // of a row `t`: that it needs no audit row
};

// A session that came whole is current by a word of the robot's, and nobody decided that: its first word alone.
constexpr std::array<HeldKind, 5> kHeldKinds = {{
    {"decision", "decisions", "0030_held_decisions.sql",
     "number || '\n' || robot_id || '\n' || revision_number || '\n' || how || '\n' || at_ns || '\n' "
     "|| who || '\n' || reason || '\n' || edge_watermark",
     "coalesce('\n' || digest, '') || coalesce('\n' || poses_hash, '')", "",
     "replace(how, '_', ' ') || ' revision ' || revision_number || ' of robot ' || robot_id || ', by ' || who",
     "false"},
    {"standing", "standings", "0030_held_decisions.sql",
     "number || '\n' || robot_id || '\n' || at_ns || '\n' || how || '\n' || coalesce(CAST(session_number AS TEXT), '') "
     "|| '\n' || coalesce(CAST(edge_number AS TEXT), '') || '\n' || coalesce(sensor_id, '') || '\n' || who || '\n' || "
     "reason",
     "CASE how WHEN 'epoch' THEN '\n' || coalesce((SELECT CAST(begins_ns AS TEXT) FROM epoch WHERE standing_number = "
     "number), '') "
     "ELSE '' END",
     "",
     "how || coalesce(' session number ' || session_number, '') || coalesce(' edge number ' || edge_number, '') || "
     "coalesce(' sensor ' || sensor_id, '') || ' of robot ' || robot_id || ', by ' || who",
     "t.how = 'pushed' AND t.who = 'robot ' || t.robot_id AND t.reason = '' AND NOT EXISTS (SELECT 1 FROM standing e "
     "WHERE e.session_number = t.session_number AND e.number < t.number)"},
    {"policy", "policies", "0030_held_decisions.sql",
     "number || '\n' || scope || '\n' || subject || '\n' || version || '\n' || at_ns || '\n' || who "
     "|| '\n' || reason || '\n' || text",
     "''", "",
     "'version ' || version || ' of the ' || scope || coalesce(nullif(' ' || subject, ' '), '') || ', by ' || who",
     "false"},
    {"rig_model", "rig models", "0050_held_digests.sql",
     "number || '\n' || name || '\n' || version || '\n' || at_ns || '\n' || who || '\n' || reason || '\n' || text",
     "''", "", "'version ' || version || ' of ' || name || ', by ' || who", "false"},
    {"board_measure", "board measures", "0050_held_digests.sql",
     "number || '\n' || serial || '\n' || kind || '\n' || col_count || '\n' || row_count || '\n' || sigma_is_assumed "
     "|| '\n' || coalesce(CAST(next_check_ns AS TEXT), '') || '\n' || at_ns || '\n' || who || '\n' || reason",
     "''", ", square_m, length_x_m, length_y_m, measured_x_m, measured_y_m, sigma_m, flatness_m",
     "'of board ' || serial || ', by ' || who", "false"},
}};

// After the kind, in the table audit_row: all rows up to one.
constexpr const char* kBefore = "_before";

const HeldKind* HeldKindOf(const std::string& kind) {
  for (const HeldKind& one : kHeldKinds)
    if (kind == one.kind) return &one;
  return nullptr;
}

// Of a row whose columns from `first` on are one text and then the reals.
Digest HashOfRow(const HeldKind& kind, const Query& row, int first) {
  std::string text = kind.kind + std::string("\n") + row.Text(first);
  const std::string_view reals = kind.reals;
  const auto end = first + 1 + static_cast<int>(std::count(reals.begin(), reals.end(), ','));
  for (int column = first + 1; column < end; ++column)
    text += "\n" + (row.IsNull(column) ? std::string() : HeldNumber(row.Real(column)));
  return Sha256Of(text);
}

// Of all rows up to `newest`: of their hashes, each with a line feed after it.
struct HeldBefore {
  std::int64_t rows = 0, newest = 0;
  Digest hash;
};

HeldBefore HashOfRowsBefore(Connection& connection, const HeldKind& kind, std::int64_t newest) {
  Query rows(connection, std::string("SELECT number, ") + kind.columns + kind.reals + " FROM " + kind.kind +
                             " WHERE number <= ? ORDER BY number");
  rows.Bind(newest);
  HeldBefore before;
  std::string hashes;
  while (rows.Step()) {
    before.newest = rows.Int(0);
    hashes += HashOfRow(kind, rows, 1).str() + "\n";
    ++before.rows;
  }
  before.hash = Sha256Of(hashes);
  return before;
}

void AppendHeldBefore(Connection& connection, const HeldKind& kind, const HeldBefore& before, Stamp now) {
  Query head(connection, "SELECT number, hash FROM audit_chain ORDER BY number DESC LIMIT 1");
  const bool any = head.Step();
  if (any && head.Int(0) == std::numeric_limits<std::int64_t>::max()) return;  // it is damaged
  AuditRow row;
  row.number = (any ? head.Int(0) : 0) + 1;
  row.at = now;
  row.who = kServerWho;
  row.what = "from here on the audit holds each of the " + std::string(kind.plural) + ": the " +
             std::to_string(before.rows) + " of before it holds together";
  row.holds = HeldRow{kind.kind + std::string(kBefore), before.newest, before.hash};
  const Digest hash = AuditHash(Digest(any ? head.Text(1) : kFirstAuditHash), row);
  Query(connection, "INSERT INTO audit VALUES (?, ?, ?, ?)").Bind(row.number, row.at, row.who, row.what).Run();
  Query(connection, "INSERT INTO audit_chain VALUES (?, NULL, ?)").Bind(row.number, hash).Run();
  Query(connection, "INSERT INTO audit_row VALUES (?, ?, ?, ?)")
      .Bind(row.number, row.holds->kind, row.holds->number, row.holds->hash)
      .Run();
}

// "policy 3 (version 2 of the fleet, by Ada)"; of one that is gone its number alone.
std::string NamedHeldRow(Connection& connection, const HeldKind& kind, std::int64_t number) {
  std::string name = kind.kind + std::string(" ") + std::to_string(number);
  std::replace(name.begin(), name.end(), '_', ' ');
  Query row(connection, std::string("SELECT ") + kind.what + " FROM " + kind.kind + " WHERE number = ?");
  return row.Bind(number).Step() ? name + " (" + row.Text(0) + ")" : name;
}

void CheckRowsOfBefore(Connection& connection, const HeldKind& kind, const AuditFault& about, const HeldRow& held,
                       AuditCheck& check) {
  const HeldBefore now = HashOfRowsBefore(connection, kind, held.number);
  check.from_before += now.rows;
  if (now.hash == held.hash) return;
  AuditFault fault = about;
  fault.kind = AuditFault::Kind::kRowsBeforeChanged;
  fault.row = "the " + std::string(kind.plural) + " up to number " + std::to_string(held.number);
  AddRowFault(std::move(fault), check);
}

void CheckHeldRow(Connection& connection, AuditFault fault, const HeldRow& held, AuditCheck& check) {
  const HeldKind* kind = HeldKindOf(held.kind);
  if (kind == nullptr) {
    const HeldKind* before = HeldKindOf(held.kind.substr(0, held.kind.rfind(kBefore)));
    if (before != nullptr) CheckRowsOfBefore(connection, *before, fault, held, check);
    return;
  }
  const auto hash = HashOfHeldRow(connection, held.kind, held.number);
  if (hash == held.hash) return;
  fault.kind = hash ? AuditFault::Kind::kRowChanged : AuditFault::Kind::kRowMissing;
  fault.row = NamedHeldRow(connection, *kind, held.number);
  AddRowFault(std::move(fault), check);
}

// Rows that no audit row holds: they were written by somebody else.
void FindUnheldRows(Connection& connection, const HeldKind& kind, AuditCheck& check) {
  const std::string name = kind.kind;
  Query rows(connection,
             "SELECT number FROM " + name +
                 " t WHERE NOT EXISTS (SELECT 1 FROM audit_row r JOIN audit_chain c ON c.number = r.number WHERE "
                 "r.kind = '" +
                 name +
                 "' AND r.row_number = t.number) AND NOT EXISTS (SELECT 1 FROM audit_row b JOIN "
                 "audit_chain c ON c.number = b.number WHERE b.kind = '" +
                 name + "_before' AND t.number <= b.row_number) AND NOT (" + kind.unaudited + ") ORDER BY number");
  while (rows.Step())
    AddRowFault({AuditFault::Kind::kRowUnheld, 0, {}, NamedHeldRow(connection, kind, rows.Int(0))}, check);
}

}  // namespace

void AddRowFault(AuditFault fault, AuditCheck& check) {
  ++check.row_faults_count;
  if (check.row_faults.size() < kRowFaultsMax) check.row_faults.push_back(std::move(fault));
}

std::string HeldNumber(double value) {
  if (value == 0.0) value = 0.0;  // without a sign: not every engine keeps it
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::optional<Digest> HashOfHeldRow(Connection& connection, const std::string& kind, std::int64_t number) {
  const HeldKind* held = HeldKindOf(kind);
  if (held == nullptr) return std::nullopt;
  Query row(connection, std::string("SELECT ") + held->columns + " || " + held->beside + held->reals + " FROM " +
                            held->kind + " WHERE number = ?");
  return row.Bind(number).Step() ? std::optional(HashOfRow(*held, row, 0)) : std::nullopt;
}

void HoldRowsOfBefore(Connection& connection, std::string_view schema_file, Stamp now) {
  for (const HeldKind& kind : kHeldKinds) {
    if (schema_file != kind.since) continue;
    const HeldBefore before = HashOfRowsBefore(connection, kind, std::numeric_limits<std::int64_t>::max());
    if (before.rows > 0) AppendHeldBefore(connection, kind, before, now);
  }
}

void CheckHeldRows(Connection& connection, AuditCheck& check) {
  Query held(connection,
             "SELECT r.number, a.at_ns, r.kind, r.row_number, r.hash FROM audit_row r LEFT JOIN audit a ON "
             "a.number = r.number ORDER BY r.number");
  while (held.Step()) {
    AuditFault about;
    about.number = held.Int(0);
    if (!held.IsNull(1)) about.at = held.Time(1);
    CheckHeldRow(connection, about, {held.Text(2), held.Int(3), held.IdAt<Digest>(4)}, check);
  }
  for (const HeldKind& kind : kHeldKinds) FindUnheldRows(connection, kind, check);
}

}  // namespace rigcal::storage
