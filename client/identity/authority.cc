#include "client/identity/authority.h"

#include <algorithm>
#include <tuple>

#include "client/identity/permissions.h"
#include "server/base/files/durable_file.h"
#include "server/base/ids.h"

namespace rigcal::client {
namespace {

namespace fs = std::filesystem;
using namespace identity_files;  // NOLINT: all of them

constexpr const char* kAuthorityKey = "ca.key";
constexpr const char* kPermissionsKey = "permissions-ca.key";
constexpr const char* kIssued = "issued";
constexpr std::size_t kTextBytesMax = 4 << 20;
constexpr std::int64_t kHour_ns = 3'600'000'000'000;
constexpr std::int64_t kAuthorityFor_ns = 20 * 365 * 24 * kHour_ns;

// Clocks of robots are not all right.
Stamp Before(Stamp now) { return {now.ns - kHour_ns}; }

Result<std::string> TextOfFile(const fs::path& file) { return ReadFile(file, kTextBytesMax); }

// Folders that a person looks into, in an order that is always the same.
std::vector<fs::path> Below(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

bool IsOf(const DdsIdentity& identity, IdentityHolder holder, const std::string& name) {
  return identity.holder == holder && identity.name == name;
}

// A folder whose files nobody else reads, whatever they are made as.
Status MakePrivateFolder(const fs::path& folder) {
  RIGCAL_TRY(MakeFolderDurably(folder));
  std::error_code error;
  fs::permissions(folder, fs::perms::owner_all, error);
  if (!error) return {};
  return Fail(ErrorCode::kStorage, folder.string() + " cannot be kept from others: " + error.message(),
              "Give a folder that is yours.");
}

Status WriteKey(const fs::path& file, const std::string& key) {
  RIGCAL_TRY(WriteDurably(file, key));
  std::error_code error;
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write, error);
  if (!error) return {};
  return Fail(ErrorCode::kStorage, file.string() + " cannot be kept from others: " + error.message(),
              "Give a folder that is yours.");
}

// A new key and certificate, in two files.
Result<Signer> MakeSigner(const fs::path& folder, const char* key, const char* certificate, const std::string& of,
                          Stamp now) {
  RIGCAL_ASSIGN(const KeyAndCertificate texts, Signer::Make(of, Before(now), {now.ns + kAuthorityFor_ns}));
  RIGCAL_TRY(WriteDurably(folder / certificate, texts.certificate));
  RIGCAL_TRY(WriteKey(folder / key, texts.key));
  return Signer::Read(texts, folder.string());
}

Result<Signer> OpenSigner(const fs::path& folder, const char* key, const char* certificate) {
  RIGCAL_TRY(CheckKeyIsPrivate(folder / key));
  RIGCAL_ASSIGN(std::string key_text, TextOfFile(folder / key));
  RIGCAL_ASSIGN(std::string certificate_text, TextOfFile(folder / certificate));
  return Signer::Read({std::move(key_text), std::move(certificate_text)}, folder.string());
}

Status CheckNameOf(IdentityHolder holder, const std::string& name) {
  if (holder == IdentityHolder::kServer && name != kServerIdentity)
    return Fail(ErrorCode::kInvalidInput, "a server's identity has no name of its own",
                "Call it '" + std::string(kServerIdentity) + "'.");
  if (name == "policy" || (name == kServerIdentity && holder != IdentityHolder::kServer))
    return Fail(ErrorCode::kInvalidInput, "'" + name + "' is Rigcal's own name", "Take another one.");
  return CheckName(NameOf(holder), name);
}

}  // namespace

Result<Authority> Authority::Make(const fs::path& folder, Stamp now) {
  std::error_code error;
  if (fs::exists(folder / kAuthorityKey, error))
    return Fail(ErrorCode::kConflict, "there is an authority in " + folder.string() + " already",
                "Use it, or give another folder: identities of two authorities never meet.");
  RIGCAL_TRY(MakePrivateFolder(folder));
  RIGCAL_TRY(MakePrivateFolder(folder / kIssued));
  RIGCAL_ASSIGN(Signer permissions, MakeSigner(folder, kPermissionsKey, kPermissionsAuthority, "permissions", now));
  RIGCAL_ASSIGN(const std::string governance, permissions.Sign(GovernanceText()));
  RIGCAL_TRY(WriteDurably(folder / kGovernance, governance));
  RIGCAL_ASSIGN(const KeyAndCertificate texts, Signer::Make("identities", Before(now), {now.ns + kAuthorityFor_ns}));
  RIGCAL_TRY(WriteDurably(folder / kAuthority, texts.certificate));
  RIGCAL_ASSIGN(Signer signer, Signer::Read(texts, folder.string()));
  Authority made(folder, std::move(signer), std::move(permissions));
  RIGCAL_TRY(made.WriteRevoked({}, now));
  // Its key is the last: whoever finds that has a whole authority.
  RIGCAL_TRY(WriteKey(folder / kAuthorityKey, texts.key));
  RIGCAL_TRY(made.Issue(IdentityHolder::kServer, kServerIdentity, now, made.signer_.not_after(), false));
  return made;
}

Result<Authority> Authority::Open(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder / kAuthorityKey, error))
    return Fail(ErrorCode::kNotFound, "there is no authority for identities in " + folder.string(),
                "Make one with `rigcal identity init`, or give its folder as --authority.");
  if (!fs::exists(folder / kPermissionsKey, error))
    return Fail(ErrorCode::kNotFound, "the authority in " + folder.string() + " lacks " + kPermissionsKey,
                "Bring it back from a backup, or make another authority with `rigcal identity init` in a new folder, "
                "and all identities anew.");
  RIGCAL_ASSIGN(Signer signer, OpenSigner(folder, kAuthorityKey, kAuthority));
  RIGCAL_ASSIGN(Signer permissions, OpenSigner(folder, kPermissionsKey, kPermissionsAuthority));
  return Authority(folder, std::move(signer), std::move(permissions));
}

fs::path Authority::FolderOf(IdentityHolder holder, const std::string& name) const {
  if (holder == IdentityHolder::kServer) return folder_ / "server";
  return folder_ / (holder == IdentityHolder::kRobot ? "robots" : "operators") / name;
}

Result<std::string> Authority::Text(const char* file) const { return TextOfFile(folder_ / file); }

Result<DdsIdentity> Authority::Issue(IdentityHolder holder, const std::string& name, Stamp now, Stamp until,
                                     bool renews, Role role) {
  RIGCAL_TRY(CheckNameOf(holder, name));
  DdsIdentity wanted{holder, name, Before(now), {std::min(until.ns, signer_.not_after().ns)}, "", role};
  RIGCAL_ASSIGN(const auto issued, List());
  const bool has_one = std::any_of(issued.begin(), issued.end(), [&](const IssuedIdentity& one) {
    return IsOf(one.identity, holder, name) && !one.revoked && one.identity.not_after > now;
  });
  if (has_one && !renews)
    return Fail(ErrorCode::kConflict, TextOf(wanted) + " has an identity that is good",
                "Revoke it first; or give --renew, then both are good, each until its date.");
  RIGCAL_ASSIGN(const KeyAndCertificate texts, signer_.Vouch(wanted));
  RIGCAL_ASSIGN(DdsIdentity made, ReadCertificate(texts.certificate, "the new certificate"));
  RIGCAL_TRY(WriteDurably(folder_ / kIssued / (made.serial + ".pem"), texts.certificate));
  RIGCAL_TRY(WriteFolder(made, texts));
  return made;
}

// Whole or not there: made beside, then renamed over what was there.
Status Authority::WriteFolder(const DdsIdentity& identity, const KeyAndCertificate& texts) const {
  const fs::path folder = FolderOf(identity.holder, identity.name);
  const fs::path beside = folder.parent_path() / (".new-" + identity.serial);
  RIGCAL_TRY(MakePrivateFolder(beside));
  RIGCAL_ASSIGN(const std::string permissions, permissions_.Sign(PermissionsText(identity)));
  RIGCAL_TRY(WriteDurably(beside / kPermissions, permissions));
  for (const char* file : {kAuthority, kPermissionsAuthority, kGovernance, kRevoked}) {
    RIGCAL_ASSIGN(const std::string text, Text(file));
    RIGCAL_TRY(WriteDurably(beside / file, text));
  }
  RIGCAL_TRY(WriteDurably(beside / kCertificate, texts.certificate));
  RIGCAL_TRY(WriteKey(beside / kKey, texts.key));
  std::error_code error;
  fs::remove_all(folder, error);
  if (!error) fs::rename(beside, folder, error);
  if (error)
    return Fail(ErrorCode::kStorage, folder.string() + " cannot be replaced: " + error.message(),
                "See who owns it; then make the identity again with --renew.");
  return SyncFolder(folder.parent_path());
}

Result<std::vector<std::string>> Authority::Revoked() const {
  RIGCAL_ASSIGN(const std::string pem, Text(kRevoked));
  return ReadRevoked(pem, (folder_ / kRevoked).string());
}

// The list is renewed with each revocation only: it is good as long as the authority, so that none runs out unnoticed.
Status Authority::WriteRevoked(const std::vector<std::string>& serials, Stamp now) const {
  RIGCAL_ASSIGN(const std::string list, signer_.ListRevoked(serials, Before(now)));
  RIGCAL_TRY(WriteDurably(folder_ / kRevoked, list));
  std::vector<fs::path> folders = {folder_ / "server"};
  for (const char* all : {"robots", "operators"})
    for (const fs::path& one : Below(folder_ / all)) folders.push_back(one);
  std::error_code error;
  for (const fs::path& one : folders)
    if (fs::exists(one / kCertificate, error)) RIGCAL_TRY(WriteDurably(one / kRevoked, list));
  return {};
}

Result<int> Authority::Revoke(IdentityHolder holder, const std::string& name, Stamp now) {
  RIGCAL_ASSIGN(const auto issued, List());
  RIGCAL_ASSIGN(std::vector<std::string> serials, Revoked());
  const std::size_t before = serials.size();
  bool is_known = false;
  for (const IssuedIdentity& one : issued) {
    if (!IsOf(one.identity, holder, name)) continue;
    is_known = true;
    if (!one.revoked) serials.push_back(one.identity.serial);
  }
  if (!is_known)
    return Fail(ErrorCode::kNotFound, "there is no identity of " + NameOf(holder) + " " + name,
                "`rigcal identity list` shows those that there are.");
  RIGCAL_TRY(WriteRevoked(serials, now));
  return static_cast<int>(serials.size() - before);
}

Result<std::vector<IssuedIdentity>> Authority::List() const {
  RIGCAL_ASSIGN(const auto revoked, Revoked());
  std::vector<IssuedIdentity> all;
  for (const fs::path& file : Below(folder_ / kIssued)) {
    RIGCAL_ASSIGN(const std::string pem, TextOfFile(file));
    RIGCAL_ASSIGN(DdsIdentity identity, ReadCertificate(pem, file.string()));
    const bool is_revoked = std::find(revoked.begin(), revoked.end(), identity.serial) != revoked.end();
    all.push_back({std::move(identity), is_revoked});
  }
  const auto order = [](const IssuedIdentity& one) {
    return std::tuple(one.identity.holder, one.identity.name, -one.identity.not_before.ns, one.identity.serial);
  };
  std::sort(all.begin(), all.end(), [&](const auto& a, const auto& b) { return order(a) < order(b); });
  return all;
}

}  // namespace rigcal::client
