// Who a process is on DDS: an X.509 certificate of the fleet's own authority (client/identity makes them), with what it
// may do beside it in one folder. Reading only.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "server/base/result.h"
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
  std::string serial;  // of the certificate: hex digits
};
inline constexpr const char* kServerIdentity = "rigcald";

// "robot mapper-01", "operator ada", "the server".
[[nodiscard]] std::string TextOf(const DdsIdentity& identity);

// The files of an identity's folder.
namespace identity_files {
inline constexpr const char* kAuthority = "ca.pem";             // who vouches for identities and for what they may do
inline constexpr const char* kCertificate = "identity.pem";     // who it is
inline constexpr const char* kKey = "identity.key";             // 0600, and never leaves its machine again
inline constexpr const char* kGovernance = "governance.p7s";    // what is encrypted, for all alike
inline constexpr const char* kPermissions = "permissions.p7s";  // what it may write and read, and where
inline constexpr const char* kRevoked = "revoked.crl";          // who is let in no longer
}  // namespace identity_files

// Of a certificate in PEM form; its dates are not looked at. kInvalidInput names `origin` where it is none of ours.
[[nodiscard]] Result<DdsIdentity> ReadCertificate(const std::string& pem, const std::string& origin);
// The identity in `folder`, which is good at `now`: kNotFound names a file that is missing, kInvalidInput what is out
// of date, or a key that everybody on the machine can read.
[[nodiscard]] Result<DdsIdentity> ReadIdentity(const std::filesystem::path& folder, Stamp now);

}  // namespace rigcal
