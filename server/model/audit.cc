#include "server/model/audit.h"

#include "server/base/sha256.h"
#include "server/model/validity.h"

namespace rigcal {

Digest AuditHash(const Digest& before, const AuditRow& row) {
  return Sha256Of(before.str() + "\n" + std::to_string(row.number) + "\n" + std::to_string(row.at.ns) + "\n" +
                  row.robot.str() + "\n" + row.who + "\n" + row.what);
}

std::string TextOf(const AuditFault& fault) {
  const std::string row =
      "audit row " + std::to_string(fault.number) + (fault.at ? " of " + DayText(*fault.at) : std::string());
  switch (fault.kind) {
    case AuditFault::Kind::kMissing:
      return row + " is missing";
    case AuditFault::Kind::kWithoutHash:
      return row + " has no hash: rigcald did not write it";
    case AuditFault::Kind::kChanged:
      break;
  }
  return row + " was changed, or one before it is missing";
}

}  // namespace rigcal
