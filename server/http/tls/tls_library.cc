#include "server/http/tls/tls_library.h"

#include <dlfcn.h>
#include <openssl/ssl.h>

#include <string_view>

#undef SSL_get_peer_certificate

namespace {

bool IsOpenSsl(const char* file) {
  return file != nullptr && (file == std::string_view("libssl.so") || file == std::string_view("libcrypto.so"));
}

}  // namespace

// Found by libcivetweb before the C library's own, as a symbol of the executable.
extern "C" void* dlopen(const char* file, int mode) noexcept {
  using Open = void* (*)(const char*, int);
  static const auto next = reinterpret_cast<Open>(dlsym(RTLD_NEXT, "dlopen"));
  return next(IsOpenSsl(file) ? nullptr : file, mode);
}

// Found in the executable by name: CMakeLists.txt exports it.
extern "C" X509* SSL_get_peer_certificate(const SSL* connection) { return SSL_get1_peer_certificate(connection); }

namespace rigcal::http {
void NameTlsLibraries() {}
}  // namespace rigcal::http
