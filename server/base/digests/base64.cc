#include "server/base/digests/base64.h"

#include <openssl/evp.h>

#include <algorithm>

namespace rigcal {

std::string ToBase64(std::string_view bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');  // OpenSSL ends it with a zero
  const int size =
      EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                      reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(size));
  return text;
}

Result<std::string> FromBase64(std::string_view text) {
  const auto padding = static_cast<std::size_t>(
      std::count(text.end() - static_cast<std::ptrdiff_t>(std::min<std::size_t>(text.size(), 2)), text.end(), '='));
  std::string bytes(3 * (text.size() / 4), '\0');
  const int size = text.size() % 4 != 0 ? -1
                                        : EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()),
                                                          reinterpret_cast<const unsigned char*>(text.data()),
                                                          static_cast<int>(text.size()));
  if (size < 0) return Fail(ErrorCode::kInvalidInput, "a text is not base64", "Ask again; if it stays so, report it.");
  bytes.resize(static_cast<std::size_t>(size) - padding);
  return bytes;
}

}  // namespace rigcal
