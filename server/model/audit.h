// The audit: who decided what, when, in rows of which each holds the hash of all before it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/base/ids.h"
#include "server/base/stamp.h"

namespace rigcal {

struct AuditRow {
  std::int64_t number = 0;  // from 1, in the order in which they were written
  Stamp at;
  RobotId robot;  // that it is about; empty: none, or several
  std::string who, what;
  std::optional<Digest> hash = {};  // absent: it has none
};

// Before the first row.
inline constexpr const char* kFirstAuditHash = "0000000000000000000000000000000000000000000000000000000000000000";

// sha256 of six lines: the hash before it, number, time in ns, robot, who, what; a line feed between each two.
[[nodiscard]] Digest AuditHash(const Digest& before, const AuditRow& row);

// The first row that does not hold.
struct AuditFault {
  enum class Kind { kChanged, kMissing, kWithoutHash };
  Kind kind = Kind::kChanged;
  std::int64_t number = 0;
  std::optional<Stamp> at = {};  // as the row says now; absent: it is missing
};
// "audit row 17 of 3 Nov 2026 was changed, or one before it is missing"
[[nodiscard]] std::string TextOf(const AuditFault& fault);

struct AuditCheck {
  std::int64_t rows = 0;         // that hold, from the first on
  std::int64_t head_number = 0;  // of the last of them; 0: there is none
  Digest head{kFirstAuditHash};  // its hash
  std::optional<AuditFault> fault = {};
};

}  // namespace rigcal
