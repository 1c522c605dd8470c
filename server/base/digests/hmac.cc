#include "server/base/digests/hmac.h"

#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace rigcal {

Digest HmacSha256(std::string_view key, std::string_view text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
  unsigned size = 0;
  const std::string message(text);
  const auto* const first = reinterpret_cast<const unsigned char*>(message.data());
  if (HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()), first, message.size(), bytes.data(), &size) ==
      nullptr) {
    std::fputs("rigcal: OpenSSL cannot compute an HMAC\n", stderr);
    std::abort();
  }
  std::string hex;
  for (unsigned i = 0; i < size; ++i)
    hex.append({"0123456789abcdef"[bytes[i] >> 4], "0123456789abcdef"[bytes[i] & 15]});
  return Digest(std::move(hex));
}

}  // namespace rigcal
