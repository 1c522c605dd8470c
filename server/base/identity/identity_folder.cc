#include "server/base/identity/identity_folder.h"

#include <openssl/bn.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <sys/stat.h>

#include <array>
#include <initializer_list>
#include <memory>

#include "server/base/files/durable_file.h"
#include "server/base/identity/openssl_time.h"

namespace rigcal {
namespace {

namespace fs = std::filesystem;
using namespace identity_files;  // NOLINT: all of them
constexpr std::size_t kIdentityBytesMax = 1 << 20;
constexpr std::size_t kRevokedBytesMax = 4 << 20;
constexpr std::array kNeeded = {kAuthority, kPermissionsAuthority, kCertificate, kKey, kGovernance, kPermissions};

template <auto Free>
struct FreedBy {
  template <typename T>
  void operator()(T* one) const {
    Free(one);
  }
};
using CertificatePtr = std::unique_ptr<X509, FreedBy<X509_free>>;
using KeyPtr = std::unique_ptr<EVP_PKEY, FreedBy<EVP_PKEY_free>>;
using RevokedPtr = std::unique_ptr<X509_CRL, FreedBy<X509_CRL_free>>;
using BytesPtr = std::unique_ptr<BIO, FreedBy<BIO_free_all>>;

// What `read` makes of PEM text; null where it is none.
template <typename Ptr, typename Read>
Ptr Parsed(const std::string& pem, Read read) {
  const BytesPtr bytes(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  Ptr parsed(bytes == nullptr ? nullptr : read(bytes.get(), nullptr, nullptr, nullptr));
  ERR_clear_error();
  return parsed;
}

Result<std::string> TextIn(const fs::path& folder, const char* name, std::size_t bytes_max = kIdentityBytesMax) {
  return ReadFile(folder / name, bytes_max);
}

// All zeros where there is nothing.
struct stat StatusOf(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) status = {};
  return status;
}

mode_t ModeOf(const fs::path& path) { return StatusOf(path).st_mode; }

// Who can replace the authority's certificate, or the list of the revoked, lets in whom they want.
Status CheckNobodyElseChanges(const fs::path& path) {
  if ((ModeOf(path) & S_IWOTH) == 0) return {};
  return Fail(ErrorCode::kInvalidInput, "everybody on this machine can change " + path.string(),
              "Write `chmod o-w " + path.string() + "`; if others use this machine, take the identity there anew.");
}

Status CheckFiles(const fs::path& folder) {
  for (const char* name : kNeeded) {
    std::error_code error;
    if (!fs::is_regular_file(folder / name, error))
      return Fail(
          ErrorCode::kNotFound, "the identity in " + folder.string() + " lacks " + name,
          name == std::string_view(kPermissionsAuthority)
              ? "If an older rigcal made it, make a new authority with `rigcal identity init`, and all identities "
                "anew; else give the folder that `rigcal identity new` made, whole and readable for this user."
              : "Give the folder that `rigcal identity new` made, whole and readable for this user.");
    RIGCAL_TRY(CheckNobodyElseChanges(folder / name));
  }
  RIGCAL_TRY(CheckNobodyElseChanges(folder));
  RIGCAL_TRY(CheckNobodyElseChanges(folder / kRevoked));
  return CheckKeyIsPrivate(folder / kKey);
}

Status CheckDates(const DdsIdentity& identity, Stamp now, const fs::path& folder) {
  const std::string whose = "the identity of " + TextOf(identity) + " in " + folder.string();
  if (now.ns >= identity.not_after.ns)
    return Fail(ErrorCode::kInvalidInput, whose + " expired at " + ToIso(identity.not_after),
                "Make a new one with `rigcal identity new`; look at this machine's clock.");
  if (now.ns <= identity.not_before.ns)
    return Fail(ErrorCode::kInvalidInput, whose + " is not good before " + ToIso(identity.not_before),
                "Look at this machine's clock.");
  return {};
}

Status CheckBelongTogether(const fs::path& folder, const std::string& certificate_pem) {
  RIGCAL_ASSIGN(const std::string key_pem, TextIn(folder, kKey));
  const auto certificate = Parsed<CertificatePtr>(certificate_pem, PEM_read_bio_X509);
  const auto key = Parsed<KeyPtr>(key_pem, PEM_read_bio_PrivateKey);
  const bool good = certificate && key && X509_check_private_key(certificate.get(), key.get()) == 1;
  ERR_clear_error();
  if (good) return {};
  return Fail(ErrorCode::kInvalidInput, (folder / kKey).string() + " is not the key of " + kCertificate + " beside it",
              "Take the folder that `rigcal identity new` made there whole.");
}

// One of another authority would make DDS refuse everybody, or nobody.
Status CheckRevokedList(const fs::path& folder, const DdsIdentity& identity) {
  std::error_code error;
  if (!fs::exists(folder / kRevoked, error)) {
    if (identity.holder != IdentityHolder::kServer) return {};
    return Fail(ErrorCode::kNotFound, "the identity of the server in " + folder.string() + " lacks " + kRevoked,
                "Without it who was revoked is let in: take it there from the authority's folder `server`.");
  }
  RIGCAL_ASSIGN(const std::string list_pem, TextIn(folder, kRevoked, kRevokedBytesMax));
  RIGCAL_ASSIGN(const std::string authority_pem, TextIn(folder, kAuthority));
  const auto list = Parsed<RevokedPtr>(list_pem, PEM_read_bio_X509_CRL);
  const auto authority = Parsed<CertificatePtr>(authority_pem, PEM_read_bio_X509);
  EVP_PKEY* const key = authority ? X509_get0_pubkey(authority.get()) : nullptr;
  const bool good = list && key != nullptr && X509_CRL_verify(list.get(), key) == 1;
  ERR_clear_error();
  if (good) return {};
  return Fail(ErrorCode::kInvalidInput, (folder / kRevoked).string() + " is no list of the authority in " + kAuthority,
              "Take revoked.crl there anew from the authority's folder `server`.");
}

}  // namespace

Status CheckKeyIsPrivate(const fs::path& key) {
  if ((ModeOf(key) & S_IRWXO) == 0) return {};
  return Fail(ErrorCode::kInvalidInput, "everybody on this machine can read the key " + key.string(),
              "Write `chmod 600 " + key.string() + "`; if others use this machine, make a new identity instead.");
}

Result<std::vector<std::string>> ReadRevoked(const std::string& pem, const std::string& origin) {
  const auto list = Parsed<RevokedPtr>(pem, PEM_read_bio_X509_CRL);
  if (!list)
    return Fail(ErrorCode::kInvalidInput, origin + " is no list of revoked certificates",
                "Bring it back from a backup of the authority's folder.");
  std::vector<std::string> serials;
  const STACK_OF(X509_REVOKED)* const rows = X509_CRL_get_REVOKED(list.get());
  for (int i = 0; i < sk_X509_REVOKED_num(rows); ++i) {
    const std::unique_ptr<BIGNUM, FreedBy<BN_free>> number(
        ASN1_INTEGER_to_BN(X509_REVOKED_get0_serialNumber(sk_X509_REVOKED_value(rows, i)), nullptr));
    char* const hex = number ? BN_bn2hex(number.get()) : nullptr;
    serials.emplace_back(hex == nullptr ? "" : hex);
    CRYPTO_free(hex, "", 0);  // OPENSSL_free would put the name of this file into the program
  }
  return serials;
}

Result<DdsIdentity> ReadIdentity(const fs::path& folder, Stamp now) {
  RIGCAL_TRY(CheckFiles(folder));
  RIGCAL_ASSIGN(const std::string pem, TextIn(folder, kCertificate));
  RIGCAL_ASSIGN(DdsIdentity identity, ReadCertificate(pem, (folder / kCertificate).string()));
  RIGCAL_TRY(CheckDates(identity, now, folder));
  RIGCAL_TRY(CheckBelongTogether(folder, pem));
  RIGCAL_TRY(CheckRevokedList(folder, identity));
  return identity;
}

std::optional<RevokedList> RevokedListIn(const fs::path& folder) {
  const auto authority = TextIn(folder, kAuthority);
  const auto pem = TextIn(folder, kRevoked, kRevokedBytesMax);
  const auto list = Parsed<RevokedPtr>(pem.value_or(""), PEM_read_bio_X509_CRL);
  if (!authority || !list) return std::nullopt;
  return RevokedList{*authority, StampOfTime(X509_CRL_get0_lastUpdate(list.get()))};
}

std::string FingerprintOf(const fs::path& folder) {
  std::string text;
  const auto add = [&text](std::initializer_list<std::int64_t> parts) {
    for (const std::int64_t part : parts) text += std::to_string(part) + " ";
  };
  for (const char* name :
       {kAuthority, kPermissionsAuthority, kCertificate, kKey, kGovernance, kPermissions, kRevoked}) {
    const struct stat status = StatusOf(folder / name);
    add({status.st_mtim.tv_sec, status.st_mtim.tv_nsec, status.st_ctim.tv_sec, status.st_ctim.tv_nsec,
         static_cast<std::int64_t>(status.st_ino), status.st_size, status.st_mode, status.st_uid});
  }
  const struct stat status = StatusOf(folder);  // without its times: other files may come and go
  add({static_cast<std::int64_t>(status.st_ino), status.st_mode, status.st_uid});
  return text;
}

}  // namespace rigcal
