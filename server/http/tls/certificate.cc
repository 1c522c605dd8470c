#include "server/http/tls/certificate.h"

#include <openssl/err.h>
#include <openssl/ssl.h>

#include <cstring>
#include <mutex>
#include <string_view>

#include "server/base/log.h"
#include "server/http/tls/tls_library.h"

namespace rigcal::http {
namespace fs = std::filesystem;
namespace {

struct FreeContext {
  void operator()(SSL_CTX* context) const { SSL_CTX_free(context); }
};
using Context = std::unique_ptr<SSL_CTX, FreeContext>;

constexpr const char* kCiphersOfTls12 = "ECDHE+AESGCM:ECDHE+CHACHA20";

Error Odd(const fs::path& file, const std::string& why, const std::string& cure) {
  ERR_clear_error();
  return {ErrorCode::kInvalidInput, file.string() + " " + why, cure};
}

// Where a key has a pass phrase, nobody is there to be asked.
int NoPassPhrase(char*, int, int, void*) { return 0; }

Context NewContext() { return Context(SSL_CTX_new(TLS_server_method())); }

// A context that holds the two files and serves nobody.
Result<Context> Read(const fs::path& certificate, const fs::path& key) {
  Context read = NewContext();
  if (!read) return Fail(ErrorCode::kInternal, "OpenSSL makes no TLS context", "See whether memory is left.");
  SSL_CTX_set_default_passwd_cb(read.get(), NoPassPhrase);
  if (SSL_CTX_use_certificate_chain_file(read.get(), certificate.c_str()) != 1)
    return Fail(Odd(
        certificate, "cannot be read as a certificate in PEM form, or its key is too weak",
        "Give --http-cert a PEM file that rigcald may read: the server's certificate, then those that vouch for it."));
  const bool is_key = SSL_CTX_use_PrivateKey_file(read.get(), key.c_str(), SSL_FILETYPE_PEM) == 1;
  if (is_key && SSL_CTX_check_private_key(read.get()) == 1) return read;
  if (is_key || ERR_GET_LIB(ERR_peek_error()) == ERR_LIB_X509)
    return Fail(Odd(key, "is not the key of the certificate in " + certificate.string(),
                    "Give --http-cert and --http-key files that belong together."));
  return Fail(
      Odd(key, "cannot be read as a private key in PEM form without a pass phrase",
          "Give --http-key a PEM file that rigcald may read; `openssl pkey -in FILE` takes a pass phrase off."));
}

void WarnOfTime(const fs::path& file, SSL_CTX* context) {
  const X509* const leaf = SSL_CTX_get0_certificate(context);
  if (X509_cmp_current_time(X509_get0_notAfter(leaf)) < 0)
    LogWarn("the certificate in " + file.string() +
            " is out of date: browsers will warn of it until there is a new one");
  if (X509_cmp_current_time(X509_get0_notBefore(leaf)) > 0)
    LogWarn("the certificate in " + file.string() + " is not valid yet: look at its dates and at this machine's clock");
}

int ChooseProtocol(SSL*, const unsigned char** out, unsigned char* out_size, const unsigned char* in, unsigned in_size,
                   void*) {
  static constexpr unsigned char kHttp1[] = "\x08http/1.1";
  unsigned char* chosen = nullptr;
  if (SSL_select_next_proto(&chosen, out_size, kHttp1, sizeof kHttp1 - 1, in, in_size) != OPENSSL_NPN_NEGOTIATED)
    return SSL_TLSEXT_ERR_NOACK;
  *out = chosen;
  return SSL_TLSEXT_ERR_OK;
}

}  // namespace

struct Certificate::Impl {
  fs::path certificate_file, key_file;
  Context serves;
  std::mutex mutex;
  Context holds;  // the newest that could be read

  // Of a connection that begins.
  static int Show(SSL* connection, void* of) {
    auto* const self = static_cast<Impl*>(of);
    const std::lock_guard lock(self->mutex);
    SSL_CTX* const from = self->holds.get();
    STACK_OF(X509)* chain = nullptr;
    SSL_CTX_get0_chain_certs(from, &chain);
    return SSL_use_cert_and_key(connection, SSL_CTX_get0_certificate(from), SSL_CTX_get0_privatekey(from), chain, 1);
  }
  void Prepare() {
    SSL_CTX_set_min_proto_version(serves.get(), TLS1_2_VERSION);
    SSL_CTX_set_cipher_list(serves.get(), kCiphersOfTls12);
    SSL_CTX_set_options(serves.get(), SSL_OP_CIPHER_SERVER_PREFERENCE | SSL_OP_NO_RENEGOTIATION |
                                          SSL_OP_NO_COMPRESSION | SSL_OP_IGNORE_UNEXPECTED_EOF);
    SSL_CTX_set_mode(serves.get(), SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER | SSL_MODE_RELEASE_BUFFERS);
    SSL_CTX_set_alpn_select_cb(serves.get(), ChooseProtocol, nullptr);
    SSL_CTX_set_cert_cb(serves.get(), Show, this);
  }
};

Certificate::Certificate(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Certificate::~Certificate() = default;

Result<std::shared_ptr<Certificate>> Certificate::Load(const fs::path& certificate, const fs::path& key) {
  NameTlsLibraries();
  auto impl = std::make_unique<Impl>();
  impl->certificate_file = certificate;
  impl->key_file = key;
  impl->serves = NewContext();
  std::shared_ptr<Certificate> loaded(new Certificate(std::move(impl)));
  RIGCAL_TRY(loaded->Reload());
  loaded->impl_->Prepare();
  return loaded;
}

Status Certificate::Reload() {
  RIGCAL_ASSIGN(Context read, Read(impl_->certificate_file, impl_->key_file));
  WarnOfTime(impl_->certificate_file, read.get());
  const std::lock_guard lock(impl_->mutex);
  impl_->holds = std::move(read);
  return {};
}

void* Certificate::context() const { return impl_->serves.get(); }

}  // namespace rigcal::http
