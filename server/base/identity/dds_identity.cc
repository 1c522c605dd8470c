#include "server/base/identity/dds_identity.h"

#include <openssl/bn.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <sys/stat.h>

#include <array>
#include <ctime>
#include <memory>
#include <utility>

#include "server/base/files/durable_file.h"
#include "server/base/ids.h"

namespace rigcal {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kIdentityBytesMax = 1 << 20;
constexpr std::array<std::pair<IdentityHolder, std::string_view>, 3> kHolders = {{
    {IdentityHolder::kServer, "server"},
    {IdentityHolder::kRobot, "robot"},
    {IdentityHolder::kOperator, "operator"},
}};

struct FreeX509 {
  void operator()(X509* certificate) const { X509_free(certificate); }
};
using CertificatePtr = std::unique_ptr<X509, FreeX509>;

CertificatePtr ParsePem(const std::string& pem) {
  const std::unique_ptr<BIO, decltype(&BIO_free)> bytes(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())),
                                                        BIO_free);
  CertificatePtr read(bytes == nullptr ? nullptr : PEM_read_bio_X509(bytes.get(), nullptr, nullptr, nullptr));
  ERR_clear_error();
  return read;
}

std::string PartOf(const X509& certificate, int nid) {
  std::array<char, 256> text{};
  const int size = X509_NAME_get_text_by_NID(X509_get_subject_name(&certificate), nid, text.data(), text.size());
  return size <= 0 ? "" : std::string(text.data(), static_cast<std::size_t>(size));
}

Stamp StampOfTime(const ASN1_TIME* time) {
  std::tm parts{};
  if (ASN1_TIME_to_tm(time, &parts) != 1) return {};
  return {static_cast<std::int64_t>(timegm(&parts)) * 1'000'000'000};
}

std::string SerialOf(const X509& certificate) {
  const std::unique_ptr<BIGNUM, decltype(&BN_free)> number(
      ASN1_INTEGER_to_BN(X509_get0_serialNumber(&certificate), nullptr), BN_free);
  char* const hex = number == nullptr ? nullptr : BN_bn2hex(number.get());
  std::string text = hex == nullptr ? "" : hex;
  CRYPTO_free(hex, "", 0);  // OPENSSL_free would put the name of this file into the program
  return text;
}

Status CheckKeyIsPrivate(const fs::path& key) {
  struct stat status {};
  if (stat(key.c_str(), &status) != 0 || (status.st_mode & S_IRWXO) == 0) return {};
  return Fail(ErrorCode::kInvalidInput, "everybody on this machine can read the key " + key.string(),
              "Write `chmod 600 " + key.string() + "`; if others use this machine, make a new identity instead.");
}

Status CheckFiles(const fs::path& folder) {
  using namespace identity_files;  // NOLINT: all of them
  for (const char* name : {kAuthority, kCertificate, kKey, kGovernance, kPermissions}) {
    std::error_code error;
    if (fs::is_regular_file(folder / name, error)) continue;
    return Fail(ErrorCode::kNotFound, "the identity in " + folder.string() + " lacks " + name,
                "Give the folder that `rigcal identity new` made, whole and readable for this user.");
  }
  return CheckKeyIsPrivate(folder / kKey);
}

Status CheckDates(const DdsIdentity& identity, Stamp now, const fs::path& folder) {
  if (now.ns >= identity.not_after.ns)
    return Fail(
        ErrorCode::kInvalidInput,
        "the identity of " + TextOf(identity) + " in " + folder.string() + " expired at " + ToIso(identity.not_after),
        "Make a new one with `rigcal identity new`; look at this machine's clock.");
  if (now.ns <= identity.not_before.ns)
    return Fail(ErrorCode::kInvalidInput,
                "the identity of " + TextOf(identity) + " in " + folder.string() + " is not good before " +
                    ToIso(identity.not_before),
                "Look at this machine's clock.");
  return {};
}

}  // namespace

std::string NameOf(IdentityHolder holder) {
  for (const auto& [one, name] : kHolders)
    if (one == holder) return std::string(name);
  return "";
}

Result<IdentityHolder> IdentityHolderOf(const std::string& name) {
  for (const auto& [one, known] : kHolders)
    if (known == name) return one;
  return Fail(ErrorCode::kInvalidInput, "there is no identity of a '" + name + "'", "Say server, robot or operator.");
}

std::string TextOf(const DdsIdentity& identity) {
  if (identity.holder == IdentityHolder::kServer) return "the server";
  return NameOf(identity.holder) + " " + identity.name;
}

Result<DdsIdentity> ReadCertificate(const std::string& pem, const std::string& origin) {
  const CertificatePtr certificate = ParsePem(pem);
  const auto odd = [&origin] {
    return Fail(ErrorCode::kInvalidInput, origin + " is no certificate of a Rigcal identity",
                "Give the folder that `rigcal identity new` made.");
  };
  if (!certificate) return odd();
  const auto holder = IdentityHolderOf(PartOf(*certificate, NID_organizationalUnitName));
  DdsIdentity identity;
  identity.name = PartOf(*certificate, NID_commonName);
  if (!holder || !CheckName("name", identity.name)) return odd();
  identity.holder = *holder;
  identity.not_before = StampOfTime(X509_get0_notBefore(certificate.get()));
  identity.not_after = StampOfTime(X509_get0_notAfter(certificate.get()));
  identity.serial = SerialOf(*certificate);
  return identity;
}

Result<DdsIdentity> ReadIdentity(const fs::path& folder, Stamp now) {
  RIGCAL_TRY(CheckFiles(folder));
  const fs::path file = folder / identity_files::kCertificate;
  RIGCAL_ASSIGN(const std::string pem, ReadFile(file, kIdentityBytesMax));
  RIGCAL_ASSIGN(DdsIdentity identity, ReadCertificate(pem, file.string()));
  RIGCAL_TRY(CheckDates(identity, now, folder));
  return identity;
}

}  // namespace rigcal
