// The folder of an identity: its files, and whether they are as they must be.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/base/identity/dds_identity.h"

namespace rigcal {

// The files of an identity's folder.
namespace identity_files {
inline constexpr const char* kAuthority = "ca.pem";  // who vouches for identities
// Who vouches for what they may do. Not the same: each holder of an identity could sign for itself, as DDS takes the
// signature of anybody for whom the certificate here vouches.
inline constexpr const char* kPermissionsAuthority = "permissions-ca.pem";
inline constexpr const char* kCertificate = "identity.pem";     // who it is
inline constexpr const char* kKey = "identity.key";             // 0600, and never leaves its machine again
inline constexpr const char* kGovernance = "governance.p7s";    // what is encrypted, for all alike
inline constexpr const char* kPermissions = "permissions.p7s";  // what it may write and read, and where
inline constexpr const char* kRevoked = "revoked.crl";          // who is let in no longer
}  // namespace identity_files

// The identity in `folder`, which is good at `now`: kNotFound names a file that is missing, kInvalidInput what is out
// of date, what does not belong together, a key that everybody on the machine can read, or what everybody can change. A
// server's has to have a list of who is let in no longer.
[[nodiscard]] Result<DdsIdentity> ReadIdentity(const std::filesystem::path& folder, Stamp now);
// kInvalidInput: everybody on the machine can read `key`.
[[nodiscard]] Status CheckKeyIsPrivate(const std::filesystem::path& key);
// The serial numbers (hex digits) in a list of revoked certificates in PEM form. kInvalidInput names `origin`.
[[nodiscard]] Result<std::vector<std::string>> ReadRevoked(const std::string& pem, const std::string& origin);
// The list of who is let in no longer in `folder`: the certificate of the authority beside it, and when that made it,
// to the second. Nothing where either cannot be read.
struct RevokedList {
  std::string authority_pem;
  Stamp made_at;
};
[[nodiscard]] std::optional<RevokedList> RevokedListIn(const std::filesystem::path& folder);
// Another text once a file of the folder was replaced or written, or who may read or change it, or the folder, is
// another. Never fails: what is not there is part of it.
[[nodiscard]] std::string FingerprintOf(const std::filesystem::path& folder);

}  // namespace rigcal
