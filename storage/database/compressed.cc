#include "storage/database/compressed.h"

#include <zstd.h>

#include <memory>
#include <new>

namespace rigcal::storage {
namespace {

constexpr int kLevel = 9;
constexpr std::size_t kBlockBytesMin = 3;  // of a block in a frame; it holds up to ZSTD_BLOCKSIZE_MAX of text

struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
};

tl::unexpected<Error> Damaged(const std::string& subject, const std::string& why) {
  return Fail(ErrorCode::kStorage, subject + " is damaged: " + why, "Restore the database from a backup.");
}

}  // namespace

Result<std::string> Compress(const std::string& subject, std::string_view text, std::size_t bytes_max) {
  if (text.size() > bytes_max)
    return Fail(ErrorCode::kInvalidInput,
                subject + " has " + std::to_string(text.size()) + " bytes; the limit is " + std::to_string(bytes_max),
                "Keep less in one piece.");
  const std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
  if (!context) throw std::bad_alloc();
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kLevel);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  std::string bytes(ZSTD_compressBound(text.size()), '\0');
  const std::size_t size = ZSTD_compress2(context.get(), bytes.data(), bytes.size(), text.data(), text.size());
  if (ZSTD_isError(size) != 0)
    return Fail(ErrorCode::kInternal, subject + " cannot be compressed: " + ZSTD_getErrorName(size),
                "This is a fault of rigcald: please report it.");
  bytes.resize(size);
  return bytes;
}

Result<std::string> Decompress(const std::string& subject, std::string_view bytes, std::size_t bytes_max) {
  const unsigned long long claimed = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (claimed == ZSTD_CONTENTSIZE_ERROR || claimed == ZSTD_CONTENTSIZE_UNKNOWN)
    return Damaged(subject, "it does not begin as a zstd frame that says its size");
  if (claimed > bytes_max || claimed > (bytes.size() / kBlockBytesMin + 1) * ZSTD_BLOCKSIZE_MAX)
    return Damaged(subject, std::to_string(bytes.size()) + " bytes claim to hold " + std::to_string(claimed));
  std::string text(static_cast<std::size_t>(claimed), '\0');
  const std::size_t size = ZSTD_decompress(text.data(), text.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(size) != 0) return Damaged(subject, ZSTD_getErrorName(size));
  if (size == text.size()) return text;
  return Damaged(subject, "it holds " + std::to_string(size) + " bytes, not " + std::to_string(claimed));
}

}  // namespace rigcal::storage
