// Sums of many short pieces, by SHA-256 through OpenSSL.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace rigcal {

// The first eight bytes, the most significant one first, of the SHA-256 of `number` (eight bytes, as it lies in memory)
// and `bytes`. Needs no memory but for the first one of a thread: throws std::bad_alloc where there is none.
[[nodiscard]] std::uint64_t ShortSumOf(std::int64_t number, std::span<const std::byte> bytes);

}  // namespace rigcal
