#include "client/identity/certificates.h"

#include <openssl/bn.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <ctime>

namespace rigcal::client {
namespace {

template <auto Free>
struct Freed {
  template <typename T>
  void operator()(T* one) const {
    Free(one);
  }
};
using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using Cert = std::unique_ptr<X509, Freed<X509_free>>;
using Crl = std::unique_ptr<X509_CRL, Freed<X509_CRL_free>>;
using Bytes = std::unique_ptr<BIO, Freed<BIO_free_all>>;
using Number = std::unique_ptr<BIGNUM, Freed<BN_free>>;
using Integer = std::unique_ptr<ASN1_INTEGER, Freed<ASN1_INTEGER_free>>;
using Time = std::unique_ptr<ASN1_TIME, Freed<ASN1_TIME_free>>;
using Pkcs7 = std::unique_ptr<PKCS7, Freed<PKCS7_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION_free>>;

constexpr int kSerialBits = 127;

tl::unexpected<Error> NotMade(const std::string& what) {
  const unsigned long code = ERR_get_error();
  ERR_clear_error();
  const char* const reason = code == 0 ? nullptr : ERR_reason_error_string(code);
  return Fail(ErrorCode::kInternal, "OpenSSL made no " + what + (reason == nullptr ? "" : std::string(": ") + reason),
              "See whether memory is left on this machine.");
}

Bytes BytesOf(const std::string& text) { return Bytes(BIO_new_mem_buf(text.data(), static_cast<int>(text.size()))); }

std::string TextOf(const Bytes& bytes) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bytes.get(), &data);
  return size <= 0 ? "" : std::string(data, static_cast<std::size_t>(size));
}

// What `write` puts into memory; empty where it fails.
template <typename Write>
std::string Written(const Write& write) {
  const Bytes bytes(BIO_new(BIO_s_mem()));
  return bytes && write(bytes.get()) == 1 ? TextOf(bytes) : "";
}

Time TimeOf(Stamp stamp) { return Time(ASN1_TIME_set(nullptr, static_cast<time_t>(stamp.ns / 1'000'000'000))); }

bool Append(X509_NAME* name, const char* field, const std::string& value) {
  return X509_NAME_add_entry_by_txt(name, field, MBSTRING_UTF8, reinterpret_cast<const unsigned char*>(value.c_str()),
                                    -1, -1, 0) == 1;
}

bool AppendRole(X509_NAME* name, const DdsIdentity& identity) {
  return identity.holder != IdentityHolder::kOperator || Append(name, "O", rigcal::NameOf(identity.role));
}

bool AddExtension(X509& certificate, int nid, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, &certificate, &certificate, nullptr, nullptr, 0);
  const Extension extension(X509V3_EXT_conf_nid(nullptr, &context, nid, value));
  return extension && X509_add_ext(&certificate, extension.get(), -1) == 1;
}

bool SetSerial(X509& certificate) {
  const Number number(BN_new());
  return number && BN_rand(number.get(), kSerialBits, BN_RAND_TOP_ONE, BN_RAND_BOTTOM_ANY) == 1 &&
         BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(&certificate)) != nullptr;
}

bool SetTimes(X509& certificate, Stamp not_before, Stamp not_after) {
  const Time from = TimeOf(not_before), until = TimeOf(not_after);
  return from && until && X509_set1_notBefore(&certificate, from.get()) == 1 &&
         X509_set1_notAfter(&certificate, until.get()) == 1;
}

// Version 3, with a serial number, times and a key; without name, issuer and signature.
Cert BareCertificate(EVP_PKEY* key, Stamp not_before, Stamp not_after) {
  Cert made(X509_new());
  const bool done = made && X509_set_version(made.get(), 2) == 1 && SetSerial(*made) &&
                    SetTimes(*made, not_before, not_after) && X509_set_pubkey(made.get(), key) == 1;
  return done ? std::move(made) : nullptr;
}

Key NewKey() { return Key(EVP_EC_gen("P-256")); }

std::string PemOf(EVP_PKEY* key) {
  return Written([key](BIO* to) { return PEM_write_bio_PrivateKey(to, key, nullptr, nullptr, 0, nullptr, nullptr); });
}
std::string PemOf(X509* certificate) {
  return Written([certificate](BIO* to) { return PEM_write_bio_X509(to, certificate); });
}

Result<KeyAndCertificate> TextsOf(const Key& key, const Cert& certificate) {
  KeyAndCertificate texts{PemOf(key.get()), PemOf(certificate.get())};
  if (texts.key.empty() || texts.certificate.empty()) return NotMade("text of a certificate");
  return texts;
}

bool AppendRevoked(X509_CRL& list, const std::string& serial, const ASN1_TIME& at) {
  BIGNUM* raw = nullptr;
  if (BN_hex2bn(&raw, serial.c_str()) == 0) return false;
  const Number number(raw);
  const Integer integer(BN_to_ASN1_INTEGER(number.get(), nullptr));
  std::unique_ptr<X509_REVOKED, Freed<X509_REVOKED_free>> row(X509_REVOKED_new());
  if (!integer || !row || X509_REVOKED_set_serialNumber(row.get(), integer.get()) != 1) return false;
  ASN1_TIME copy = at;
  if (X509_REVOKED_set_revocationDate(row.get(), &copy) != 1 || X509_CRL_add0_revoked(&list, row.get()) != 1)
    return false;
  (void)row.release();  // the list's now
  return true;
}

}  // namespace

struct Signer::Impl {
  Key key;
  Cert certificate;
};

Signer::Signer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Signer::~Signer() = default;
Signer::Signer(Signer&&) noexcept = default;
Signer& Signer::operator=(Signer&&) noexcept = default;

Result<KeyAndCertificate> Signer::Make(const std::string& of, Stamp not_before, Stamp not_after) {
  const Key key = NewKey();
  if (!key) return NotMade("key");
  const Cert made = BareCertificate(key.get(), not_before, not_after);
  if (!made) return NotMade("certificate");
  X509_NAME* const name = X509_get_subject_name(made.get());
  const bool done = Append(name, "CN", "Rigcal " + of) && X509_set_issuer_name(made.get(), name) == 1 &&
                    AddExtension(*made, NID_basic_constraints, "critical,CA:TRUE,pathlen:0") &&
                    AddExtension(*made, NID_key_usage, "critical,digitalSignature,keyCertSign,cRLSign") &&
                    X509_sign(made.get(), key.get(), EVP_sha256()) != 0;
  if (!done) return NotMade("certificate of the authority");
  return TextsOf(key, made);
}

Result<Signer> Signer::Read(const KeyAndCertificate& texts, const std::string& origin) {
  auto impl = std::make_unique<Impl>();
  impl->key = Key(PEM_read_bio_PrivateKey(BytesOf(texts.key).get(), nullptr, nullptr, nullptr));
  impl->certificate = Cert(PEM_read_bio_X509(BytesOf(texts.certificate).get(), nullptr, nullptr, nullptr));
  const bool good = impl->key && impl->certificate && X509_check_private_key(impl->certificate.get(), impl->key.get());
  ERR_clear_error();
  if (good) return Signer(std::move(impl));
  return Fail(ErrorCode::kInvalidInput, origin + " holds no key and certificate of an authority",
              "Give the folder that `rigcal identity init` made, or bring it back from a backup.");
}

Result<KeyAndCertificate> Signer::Vouch(const DdsIdentity& identity) const {
  const Key key = NewKey();
  if (!key) return NotMade("key");
  const Cert made = BareCertificate(key.get(), identity.not_before, identity.not_after);
  if (!made) return NotMade("certificate");
  X509_NAME* const name = X509_get_subject_name(made.get());
  const bool done = Append(name, "OU", NameOf(identity.holder)) && AppendRole(name, identity) &&
                    Append(name, "CN", identity.name) &&
                    X509_set_issuer_name(made.get(), X509_get_subject_name(impl_->certificate.get())) == 1 &&
                    AddExtension(*made, NID_basic_constraints, "critical,CA:FALSE") &&
                    AddExtension(*made, NID_key_usage, "critical,digitalSignature,keyAgreement") &&
                    X509_sign(made.get(), impl_->key.get(), EVP_sha256()) != 0;
  if (!done) return NotMade("certificate of " + rigcal::TextOf(identity));
  return TextsOf(key, made);
}

Result<std::string> Signer::Sign(const std::string& text) const {
  constexpr int kFlags = PKCS7_TEXT | PKCS7_DETACHED | PKCS7_STREAM;
  const Bytes in = BytesOf(text);
  const Pkcs7 made(PKCS7_sign(impl_->certificate.get(), impl_->key.get(), nullptr, in.get(), kFlags));
  if (!made) return NotMade("signature");
  std::string signed_text = Written([&](BIO* to) { return SMIME_write_PKCS7(to, made.get(), in.get(), kFlags); });
  if (signed_text.empty()) return NotMade("signed document");
  return signed_text;
}

Result<std::string> Signer::ListRevoked(const std::vector<std::string>& serials, Stamp now) const {
  const Crl list(X509_CRL_new());
  const Time at = TimeOf(now);
  bool done = list && at && X509_CRL_set_version(list.get(), 1) == 1 &&
              X509_CRL_set_issuer_name(list.get(), X509_get_subject_name(impl_->certificate.get())) == 1 &&
              X509_CRL_set1_lastUpdate(list.get(), at.get()) == 1 &&
              X509_CRL_set1_nextUpdate(list.get(), X509_get0_notAfter(impl_->certificate.get())) == 1;
  for (const std::string& serial : serials) done = done && AppendRevoked(*list, serial, *at);
  done = done && X509_CRL_sort(list.get()) == 1 && X509_CRL_sign(list.get(), impl_->key.get(), EVP_sha256()) != 0;
  if (!done) return NotMade("list of revoked certificates");
  return Written([&](BIO* to) { return PEM_write_bio_X509_CRL(to, list.get()); });
}

Stamp Signer::not_after() const {
  std::tm parts{};
  if (ASN1_TIME_to_tm(X509_get0_notAfter(impl_->certificate.get()), &parts) != 1) return {};
  return {static_cast<std::int64_t>(timegm(&parts)) * 1'000'000'000};
}

}  // namespace rigcal::client
