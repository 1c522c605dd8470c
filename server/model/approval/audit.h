// The audit: who decided what, when, in rows of which each holds the hash of all before it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"

namespace rigcal {

// A row of another table, one that decides, which an audit row holds by its hash.
struct HeldRow {
  std::string kind;         // the table: "decision"; "decision_before": all up to `number`, from before
  std::int64_t number = 0;  // in its table
  Digest hash;
};

struct AuditRow {
  std::int64_t number = 0;  // from 1, in the order in which they were written
  Stamp at;
  RobotId robot;  // that it is about; empty: none, or several
  std::string who, what;
  std::optional<Digest> hash = {};    // absent: it has none
  std::optional<HeldRow> holds = {};  // absent: none
  std::optional<Digest> digest = {};  // of the document that it decides about; absent: no decision, or one from before
};

inline constexpr const char* kServerWho = "rigcald";  // of rows about the audit itself

// Before the first row.
inline constexpr const char* kFirstAuditHash = "0000000000000000000000000000000000000000000000000000000000000000";

// sha256 of six lines: the hash before it, number, time in ns, robot, who, what; of one that holds a row a seventh: its
// kind, number and hash with a space between each two. A line feed between each two lines.
[[nodiscard]] Digest AuditHash(const Digest& before, const AuditRow& row);

// What does not hold: a row of the audit, or one that decides.
struct AuditFault {
  enum class Kind { kChanged, kMissing, kWithoutHash, kRowChanged, kRowMissing, kRowsBeforeChanged, kRowUnheld };
  Kind kind = Kind::kChanged;
  std::int64_t number = 0;       // of the audit row; 0: there is none
  std::optional<Stamp> at = {};  // as the audit row says now; absent: it is missing
  // Of kRow...: "decision 7 (approved revision 2 of robot rig, by Ada)", "the document of revision 2 of robot rig".
  std::string row = {};
};
// "audit row 17 of 3 Nov 2026 was changed, or one before it is missing"
[[nodiscard]] std::string TextOf(const AuditFault& fault);

inline constexpr std::size_t kRowFaultsMax = 100;  // that are named

struct AuditCheck {
  std::int64_t rows = 0;                    // that hold, from the first on
  std::int64_t head_number = 0;             // of the last of them; 0: there is none
  Digest head{kFirstAuditHash};             // its hash
  std::optional<AuditFault> fault = {};     // the first audit row that does not hold
  std::vector<AuditFault> row_faults = {};  // rows that decide, and what they decide about, that are not as it holds
  std::int64_t row_faults_count = 0;        // also of those beyond kRowFaultsMax
  std::int64_t from_before = 0;             // rows that decide, from before the audit held each: it holds them together
  std::int64_t without_digest = 0;          // decisions from before these held the document and poses of their revision
};
// Neither kind of fault.
[[nodiscard]] bool Holds(const AuditCheck& check);

}  // namespace rigcal
