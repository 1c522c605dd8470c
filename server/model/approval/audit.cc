#include "server/model/approval/audit.h"

#include "server/base/digests/sha256.h"
#include "server/model/approval/validity.h"

namespace rigcal {

Digest AuditHash(const Digest& before, const AuditRow& row) {
  const std::string held =
      row.holds ? "\n" + row.holds->kind + " " + std::to_string(row.holds->number) + " " + row.holds->hash.str() : "";
  return Sha256Of(before.str() + "\n" + std::to_string(row.number) + "\n" + std::to_string(row.at.ns) + "\n" +
                  row.robot.str() + "\n" + row.who + "\n" + row.what + held);
}

std::string TextOf(const AuditFault& fault) {
  using Kind = AuditFault::Kind;
  const std::string row =
      "audit row " + std::to_string(fault.number) + (fault.at ? " of " + DayText(*fault.at) : std::string());
  switch (fault.kind) {
    case Kind::kMissing:
      return row + " is missing";
    case Kind::kWithoutHash:
      return row + " has no hash: rigcald did not write it";
    case Kind::kRowChanged:
      return fault.row + " was changed since " + row + " was written about it";
    case Kind::kRowMissing:
      return fault.row + ", which " + row + " is about, is missing";
    case Kind::kRowsBeforeChanged:
      return "one of " + fault.row + ", from before " + row + ", was changed, put in or taken out";
    case Kind::kRowUnheld:
      return fault.row + " has no audit row: rigcald did not write it";
    case Kind::kChanged:
      break;
  }
  return row + " was changed, or one before it is missing";
}

bool Holds(const AuditCheck& check) { return !check.fault && check.row_faults.empty(); }

}  // namespace rigcal
