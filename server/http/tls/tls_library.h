// How civetweb finds OpenSSL.
#pragma once

namespace rigcal::http {

// civetweb loads "libssl.so" and "libcrypto.so" when it first needs them, names that only the package for building
// (libssl-dev) has, and Debian's looks there for SSL_get_peer_certificate, which OpenSSL 3 no longer has as a function.
// In this process both names stand for the program with the libraries that it is linked with, and it has that function.
// Call before the first server with TLS: keeps the overrides linked in.
void NameTlsLibraries();

}  // namespace rigcal::http
