#include "server/base/digests/secret.h"

#include <openssl/crypto.h>
#include <openssl/rand.h>

#include <cstdio>
#include <cstdlib>

namespace rigcal {

std::string RandomBytes(std::size_t count) {
  std::string bytes(count, '\0');
  if (RAND_bytes(reinterpret_cast<unsigned char*>(bytes.data()), static_cast<int>(count)) == 1) return bytes;
  std::fputs("rigcal: OpenSSL has no random bytes\n", stderr);
  std::abort();
}

std::string NewSecret() {
  std::string hex;
  for (const char c : RandomBytes(32)) {
    const auto byte = static_cast<unsigned char>(c);
    hex.append({"0123456789abcdef"[byte >> 4], "0123456789abcdef"[byte & 15]});
  }
  return hex;
}

bool IsSameSecret(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace rigcal
