// Who vouches for the identities of a fleet, and for what they may do: a folder on one machine, with the keys that sign
// them. They are two, as DDS takes what an identity may do from anybody for whom the same certificate vouches.
//   ca.key ca.pem permissions-ca.key permissions-ca.pem governance.p7s revoked.crl
//   server/  robots/<id>/  operators/<name>/     to be handed out: identity_files of server/base/identity
//   issued/<serial>.pem                          every certificate that was ever made
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "client/identity/certificates.h"

namespace rigcal::client {

struct IssuedIdentity {
  DdsIdentity identity;
  bool revoked = false;
};

class Authority {
 public:
  // A new one, good for 20 years, with the identity of a server. kConflict where the folder has one.
  [[nodiscard]] static Result<Authority> Make(const std::filesystem::path& folder, Stamp now);
  // kNotFound where there is none, or one of before there were two keys; kInvalidInput where others can read them.
  [[nodiscard]] static Result<Authority> Open(const std::filesystem::path& folder);

  // A new identity, good until `until` or as long as the authority, and the folder that holds it. kConflict where one
  // of the name is good and `renews` is false; with it the one of before stays good until its date, too. `role`: of an
  // operator.
  [[nodiscard]] Result<DdsIdentity> Issue(IdentityHolder holder, const std::string& name, Stamp now, Stamp until,
                                          bool renews, Role role = Role::kApprover);
  // No certificate of the name is good any longer; how many they were. The list of them is in all folders that are to
  // be handed out, for whoever is to know. kNotFound where there is none.
  [[nodiscard]] Result<int> Revoke(IdentityHolder holder, const std::string& name, Stamp now);
  // By holder and name, the newest first.
  [[nodiscard]] Result<std::vector<IssuedIdentity>> List() const;
  // Where an identity lies, to be handed out.
  [[nodiscard]] std::filesystem::path FolderOf(IdentityHolder holder, const std::string& name) const;

 private:
  Authority(std::filesystem::path folder, Signer signer, Signer permissions)
      : folder_(std::move(folder)), signer_(std::move(signer)), permissions_(std::move(permissions)) {}
  [[nodiscard]] Status WriteFolder(const DdsIdentity& identity, const KeyAndCertificate& texts) const;
  [[nodiscard]] Status WriteRevoked(const std::vector<std::string>& serials, Stamp now) const;
  [[nodiscard]] Result<std::vector<std::string>> Revoked() const;
  [[nodiscard]] Result<std::string> Text(const char* file) const;

  std::filesystem::path folder_;
  Signer signer_;       // of identities
  Signer permissions_;  // of what they may do
};

}  // namespace rigcal::client
