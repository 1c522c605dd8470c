#include "server/base/identity/dds_identity.h"

#include <openssl/bn.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <array>
#include <ctime>
#include <memory>
#include <utility>

#include "server/base/identity/openssl_time.h"
#include "server/base/ids.h"

namespace rigcal {
namespace {

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

std::string SerialOf(const X509& certificate) {
  const std::unique_ptr<BIGNUM, decltype(&BN_free)> number(
      ASN1_INTEGER_to_BN(X509_get0_serialNumber(&certificate), nullptr), BN_free);
  char* const hex = number == nullptr ? nullptr : BN_bn2hex(number.get());
  std::string text = hex == nullptr ? "" : hex;
  CRYPTO_free(hex, "", 0);  // OPENSSL_free would put the name of this file into the program
  return text;
}

}  // namespace

Stamp StampOfTime(const ASN1_TIME* time) {
  std::tm parts{};
  if (ASN1_TIME_to_tm(time, &parts) != 1) return {};
  return {static_cast<std::int64_t>(timegm(&parts)) * 1'000'000'000};
}

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
  const std::string role = identity.holder == IdentityHolder::kOperator ? " (" + NameOf(identity.role) + ")" : "";
  return NameOf(identity.holder) + " " + identity.name + role;
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
  if (*holder == IdentityHolder::kOperator) {
    const auto role = RoleOf(PartOf(*certificate, NID_organizationName));
    if (!role) return odd();
    identity.role = *role;
  }
  identity.not_before = StampOfTime(X509_get0_notBefore(certificate.get()));
  identity.not_after = StampOfTime(X509_get0_notAfter(certificate.get()));
  identity.serial = SerialOf(*certificate);
  return identity;
}

}  // namespace rigcal
