#include "client/bags/unpack.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>

namespace rigcal::bags {
namespace {

constexpr std::size_t kFirstBytes = 256 << 10;
constexpr int kWindowLogMax = 27;  // 128 MiB: what zstd's own program takes without being asked

// What one call of a library took and gave.
struct Turn {
  std::size_t taken = 0, given = 0;
  bool ended = false;  // a frame is whole
  const char* error = nullptr;
};

// Calls `step(in, out)` until all is taken and out. A library that neither takes nor gives has come to the end.
template <typename Step>
Unpacked Run(const char* name, std::span<const std::byte> in, std::size_t bytes_max, const Step& step) {
  Unpacked result;
  std::size_t filled = 0;
  bool ended = false;
  for (;;) {
    if (filled == result.bytes.size()) {
      if (filled > bytes_max) {
        result.trouble = "it unpacks to more than " + std::to_string(bytes_max) + " bytes";
        break;
      }
      result.bytes.resize(std::min(std::max(kFirstBytes, 2 * filled), bytes_max + 1));
    }
    const Turn turn = step(in, std::span(result.bytes).subspan(filled));
    if (turn.error != nullptr) {
      result.trouble = std::string("its ") + name + " data is damaged (" + turn.error + ")";
      break;
    }
    in = in.subspan(turn.taken);
    filled += turn.given;
    ended = turn.ended || (ended && turn.taken == 0 && turn.given == 0);
    if (ended && in.empty()) break;
    if (turn.taken == 0 && turn.given == 0) {
      result.trouble = std::string("its ") + name + " data ends early";
      break;
    }
  }
  result.bytes.resize(std::min(filled, bytes_max));
  return result;
}

Unpacked UnpackLz4(std::span<const std::byte> packed, std::size_t bytes_max) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)) != 0U) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(made, LZ4F_freeDecompressionContext);
  return Run("lz4", packed, bytes_max, [&](std::span<const std::byte> in, std::span<std::byte> out) {
    std::size_t taken = in.size(), given = out.size();
    const std::size_t hint = LZ4F_decompress(context.get(), out.data(), &given, in.data(), &taken, nullptr);
    return LZ4F_isError(hint) != 0U ? Turn{0, 0, false, LZ4F_getErrorName(hint)} : Turn{taken, given, hint == 0};
  });
}

Unpacked UnpackZstd(std::span<const std::byte> packed, std::size_t bytes_max) {
  const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  if (!context) throw std::bad_alloc();
  ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, kWindowLogMax);
  return Run("zstd", packed, bytes_max, [&](std::span<const std::byte> in, std::span<std::byte> out) {
    ZSTD_inBuffer from{in.data(), in.size(), 0};
    ZSTD_outBuffer to{out.data(), out.size(), 0};
    const std::size_t hint = ZSTD_decompressStream(context.get(), &to, &from);
    return ZSTD_isError(hint) != 0U ? Turn{0, 0, false, ZSTD_getErrorName(hint)} : Turn{from.pos, to.pos, hint == 0};
  });
}

class Bz2Stream {
 public:
  Bz2Stream() { Begin(); }
  ~Bz2Stream() { BZ2_bzDecompressEnd(&stream_); }
  Bz2Stream(const Bz2Stream&) = delete;
  Bz2Stream& operator=(const Bz2Stream&) = delete;

  Turn Step(std::span<const std::byte> in, std::span<std::byte> out) {
    if (ended_ && in.empty()) return {0, 0, true};
    if (ended_) {  // another stream behind the first
      BZ2_bzDecompressEnd(&stream_);
      Begin();
    }
    const auto in_count = static_cast<unsigned>(std::min<std::size_t>(in.size(), 1U << 30));
    const auto out_count = static_cast<unsigned>(std::min<std::size_t>(out.size(), 1U << 30));
    stream_.next_in = const_cast<char*>(reinterpret_cast<const char*>(in.data()));
    stream_.avail_in = in_count;
    stream_.next_out = reinterpret_cast<char*>(out.data());
    stream_.avail_out = out_count;
    const int code = BZ2_bzDecompress(&stream_);
    ended_ = code == BZ_STREAM_END;
    if (code != BZ_OK && !ended_) return {0, 0, false, code == BZ_DATA_ERROR_MAGIC ? "no bz2 data" : "wrong checksum"};
    return {in_count - stream_.avail_in, out_count - stream_.avail_out, ended_};
  }

 private:
  void Begin() {
    stream_ = {};
    if (BZ2_bzDecompressInit(&stream_, 0, 0) != BZ_OK) throw std::bad_alloc();
    ended_ = false;
  }

  bz_stream stream_ = {};
  bool ended_ = false;
};

}  // namespace

std::optional<Packing> PackingOf(std::string_view name) {
  if (name.empty() || name == "none") return Packing::kNone;
  if (name == "lz4") return Packing::kLz4;
  if (name == "zstd") return Packing::kZstd;
  if (name == "bz2") return Packing::kBz2;
  return std::nullopt;
}

Unpacked Unpack(Packing packing, std::span<const std::byte> packed, std::size_t bytes_max) {
  switch (packing) {
    case Packing::kNone:
      break;
    case Packing::kLz4:
      return UnpackLz4(packed, bytes_max);
    case Packing::kZstd:
      return UnpackZstd(packed, bytes_max);
    case Packing::kBz2: {
      Bz2Stream stream;
      return Run("bz2", packed, bytes_max, [&](auto in, auto out) { return stream.Step(in, out); });
    }
  }
  Unpacked result;
  if (packed.size() > bytes_max) result.trouble = "it has more than " + std::to_string(bytes_max) + " bytes";
  packed = packed.first(std::min(packed.size(), bytes_max));
  result.bytes.assign(packed.begin(), packed.end());
  return result;
}

bool IsZstd(std::span<const std::byte> bytes) {
  constexpr unsigned char kMagic[] = {0x28, 0xB5, 0x2F, 0xFD};
  return bytes.size() >= sizeof kMagic && std::memcmp(bytes.data(), kMagic, sizeof kMagic) == 0;
}

}  // namespace rigcal::bags
