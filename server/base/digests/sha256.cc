#include "server/base/digests/sha256.h"

#include <openssl/evp.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "server/base/files/file_descriptor.h"

namespace rigcal {
namespace {

constexpr std::size_t kPieceBytes = 1 << 20;
constexpr std::size_t kDigestBytes = 32;

// OpenSSL's sha256 fails only if the library itself is unusable.
void Require(int ok) {
  if (ok == 1) return;
  std::fputs("rigcal: OpenSSL cannot compute sha256\n", stderr);
  std::abort();
}

Digest HexOf(const std::array<unsigned char, kDigestBytes>& bytes) {
  constexpr std::string_view kHexDigits = "0123456789abcdef";
  std::string text;
  text.reserve(2 * bytes.size());
  for (unsigned char byte : bytes) text.append({kHexDigits[byte >> 4], kHexDigits[byte & 15]});
  return Digest(std::move(text));
}

}  // namespace

struct Sha256::Impl {
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context{EVP_MD_CTX_new(), &EVP_MD_CTX_free};
};

Sha256::Sha256() : impl_(std::make_unique<Impl>()) {
  Require(impl_->context ? 1 : 0);
  Require(EVP_DigestInit_ex(impl_->context.get(), EVP_sha256(), nullptr));
}
Sha256::~Sha256() = default;
Sha256::Sha256(Sha256&&) noexcept = default;
Sha256& Sha256::operator=(Sha256&&) noexcept = default;

void Sha256::Add(std::span<const std::byte> bytes) {
  Require(EVP_DigestUpdate(impl_->context.get(), bytes.data(), bytes.size()));
}
void Sha256::Add(std::string_view text) { Add(std::as_bytes(std::span(text))); }

Digest Sha256::Finish() {
  std::array<unsigned char, kDigestBytes> bytes{};
  Require(EVP_DigestFinal_ex(impl_->context.get(), bytes.data(), nullptr));
  return HexOf(bytes);
}

Digest Sha256Of(std::string_view text) { return Sha256Of(std::as_bytes(std::span(text))); }

Digest Sha256Of(std::span<const std::byte> bytes) {
  Sha256 sha;
  sha.Add(bytes);
  return sha.Finish();
}

Result<Digest> Sha256OfFile(const std::filesystem::path& path) {
  RIGCAL_ASSIGN(const FileDescriptor file, OpenToRead(path));
  Sha256 sha;
  std::vector<char> piece(kPieceBytes);
  while (true) {
    const std::ptrdiff_t got = ReadSome(file, piece.data(), piece.size());
    if (got < 0) return FileFailure(path, "read", errno);
    if (got == 0) return sha.Finish();
    sha.Add(std::string_view(piece.data(), static_cast<std::size_t>(got)));
  }
}

}  // namespace rigcal
