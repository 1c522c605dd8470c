#include "server/base/digests/password.h"

#include <openssl/evp.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "server/base/digests/base64.h"
#include "server/base/digests/secret.h"
#include "server/base/number_text.h"
#include "server/base/text.h"

namespace rigcal {
namespace {

constexpr std::size_t kKeyBytes = 32, kSaltBytes = 16;
constexpr std::uint64_t kMemoryBytesMax = 256ULL << 20;

struct Cost {
  std::uint64_t log2_n = 15, r = 8, p = 1;
};

std::string KeyOf(std::string_view password, const std::string& salt, const Cost& cost) {
  std::string key(kKeyBytes, '\0');
  const bool done =
      EVP_PBE_scrypt(password.data(), password.size(), reinterpret_cast<const unsigned char*>(salt.data()), salt.size(),
                     1ULL << cost.log2_n, cost.r, cost.p, kMemoryBytesMax + (1 << 20),
                     reinterpret_cast<unsigned char*>(key.data()), key.size()) == 1;
  if (done) return key;
  std::fputs("rigcal: OpenSSL cannot compute scrypt\n", stderr);
  std::abort();
}

std::vector<std::string> PartsOf(const std::string& hash) {
  std::vector<std::string> parts(1);
  for (const char c : hash) c == '$' ? parts.emplace_back() : parts.back() += c;
  return parts;
}

bool ReadNumber(const std::string& text, std::uint64_t max, std::uint64_t& number) {
  number = NumberIn<std::uint64_t>(text).value_or(0);
  return number >= 1 && number <= max;
}

bool ReadCost(const std::vector<std::string>& parts, Cost& cost) {
  return ReadNumber(parts[1], 20, cost.log2_n) && ReadNumber(parts[2], 32, cost.r) &&
         ReadNumber(parts[3], 16, cost.p) && (128 * cost.r << cost.log2_n) <= kMemoryBytesMax;
}

}  // namespace

Status CheckPassword(std::string_view password) {
  if (password.size() >= kPasswordBytesMin && password.size() <= kPasswordBytesMax && IsPrintableUtf8(password))
    return {};
  return Fail(ErrorCode::kInvalidInput,
              password.size() < kPasswordBytesMin
                  ? "the password is shorter than " + std::to_string(kPasswordBytesMin) + " characters"
                  : "the password is too long, or has characters that cannot be typed",
              "Take some words that do not belong together, in UTF-8.");
}

std::string HashOfPassword(std::string_view password) {
  const Cost cost;
  const std::string salt = RandomBytes(kSaltBytes);
  return "scrypt$" + std::to_string(cost.log2_n) + "$" + std::to_string(cost.r) + "$" + std::to_string(cost.p) + "$" +
         ToBase64(salt) + "$" + ToBase64(KeyOf(password, salt, cost));
}

bool IsPassword(std::string_view password, const std::string& hash) {
  const std::vector<std::string> parts = PartsOf(hash);
  Cost cost;
  if (parts.size() != 6 || parts[0] != "scrypt" || !ReadCost(parts, cost)) return false;
  const auto salt = FromBase64(parts[4]), key = FromBase64(parts[5]);
  return salt && key && IsSameSecret(KeyOf(password, *salt, cost), *key);
}

void SpendTimeOfPassword(std::string_view password) { (void)KeyOf(password, std::string(kSaltBytes, '\0'), Cost()); }

}  // namespace rigcal
