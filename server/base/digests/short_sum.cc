#include "server/base/digests/short_sum.h"

#include <openssl/evp.h>

#include <array>
#include <memory>
#include <new>

namespace rigcal {
namespace {

// OpenSSL's sha256 fails for want of memory alone.
void RequireMemory(int ok) {
  if (ok != 1) throw std::bad_alloc();
}

// Begun anew for each sum.
class ShortHash {
 public:
  ShortHash() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    RequireMemory(context_ ? 1 : 0);
    RequireMemory(EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr));
  }

  [[nodiscard]] std::uint64_t Of(std::int64_t number, std::span<const std::byte> bytes) {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    RequireMemory(EVP_DigestInit_ex(context_.get(), nullptr, nullptr));
    RequireMemory(EVP_DigestUpdate(context_.get(), &number, sizeof(number)));
    RequireMemory(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()));
    RequireMemory(EVP_DigestFinal_ex(context_.get(), digest.data(), nullptr));
    std::uint64_t first = 0;
    for (std::size_t i = 0; i < sizeof(first); ++i) first = first << 8 | digest.at(i);
    return first;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::uint64_t ShortSumOf(std::int64_t number, std::span<const std::byte> bytes) {
  thread_local ShortHash hash;
  return hash.Of(number, bytes);
}

}  // namespace rigcal
