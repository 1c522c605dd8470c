// Who a process is on DDS: an X.509 certificate of the fleet's own authority (client/identity makes them), with what it
// may do beside it in one folder (identity_folder.h). Reading only.
#pragma once

#include <string>
#include <string_view>

#include "server/base/result.h"
#include "server/base/role.h"
#include "server/base/stamp.h"

namespace rigcal {

enum class IdentityHolder { kServer, kRobot, kOperator };

// "server", "robot", "operator", as certificates and `rigcal identity` spell them. kInvalidInput for any other.
[[nodiscard]] std::string NameOf(IdentityHolder holder);
[[nodiscard]] Result<IdentityHolder> IdentityHolderOf(const std::string& name);

struct DdsIdentity {
  IdentityHolder holder = IdentityHolder::kOperator;
  std::string name;  // robot id or person; of a server kServerIdentity
  Stamp not_before, not_after;
  std::string serial;           // of the certificate: hex digits
  Role role = Role::kApprover;  // of an operator: what it may do
};
inline constexpr const char* kServerIdentity = "rigcald";

// "robot mapper-01", "operator ada (approver)", "the server".
[[nodiscard]] std::string TextOf(const DdsIdentity& identity);

// Of a certificate in PEM form; its dates are not looked at. kInvalidInput names `origin` where it is none of ours.
[[nodiscard]] Result<DdsIdentity> ReadCertificate(const std::string& pem, const std::string& origin);

}  // namespace rigcal
