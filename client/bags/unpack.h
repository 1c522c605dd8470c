// Unpacks lz4, zstd and bz2 from memory, as far as the packed bytes go.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rigcal::bags {

enum class Packing { kNone, kLz4, kZstd, kBz2 };
// "", "none", "lz4", "zstd", "bz2"; nothing for any other word.
[[nodiscard]] std::optional<Packing> PackingOf(std::string_view name);

struct Unpacked {
  std::vector<std::byte> bytes;        // all, or what came out before the trouble
  std::optional<std::string> trouble;  // "its zstd data ends early": why there is no more
};
// One frame or several. Memory grows with what comes out, never by what is claimed; more than `bytes_max` is trouble.
[[nodiscard]] Unpacked Unpack(Packing packing, std::span<const std::byte> packed, std::size_t bytes_max);
// Whether these are the first bytes of a zstd frame.
[[nodiscard]] bool IsZstd(std::span<const std::byte> bytes);

}  // namespace rigcal::bags
