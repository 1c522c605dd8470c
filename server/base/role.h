// What a person or a program may do at the server. Each role may do all that those before it may.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "server/base/result.h"

namespace rigcal {

enum class Role {
  kViewer,      // reads
  kTechnician,  // retires, restores, begins epochs, measures boards, asks to compute again
  kApprover,    // approves, rejects, rolls back
  kAdmin,       // sets policies and rig models
};
inline constexpr std::array<Role, 4> kRoles = {Role::kViewer, Role::kTechnician, Role::kApprover, Role::kAdmin};

// "viewer", "technician", "approver", "admin".
[[nodiscard]] std::string NameOf(Role role);
// kInvalidInput names all of them.
[[nodiscard]] Result<Role> RoleOf(std::string_view name);
[[nodiscard]] bool MayActAs(Role has, Role wanted);

}  // namespace rigcal
