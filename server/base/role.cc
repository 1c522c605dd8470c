#include "server/base/role.h"

#include "server/base/text.h"

namespace rigcal {

std::string NameOf(Role role) {
  constexpr std::array<const char*, 4> kNames = {"viewer", "technician", "approver", "admin"};
  return kNames[static_cast<std::size_t>(role)];
}

Result<Role> RoleOf(std::string_view name) {
  for (const Role role : kRoles)
    if (NameOf(role) == name) return role;
  return Fail(ErrorCode::kInvalidInput, "there is no role " + Quoted(name),
              "Take viewer, technician, approver or admin.");
}

bool MayActAs(Role has, Role wanted) { return has >= wanted; }

}  // namespace rigcal
