// Reads little-endian numbers, texts and bytes from the front of a piece of memory that may be hostile.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace rigcal::bags {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they stand in the bag");

// Once something was asked for that is not there, `failed()` stays true and every answer is zero or empty.
class Cursor {
 public:
  // `bytes` outlives the cursor and what it gives.
  explicit Cursor(std::span<const std::byte> bytes) : rest_(bytes) {}

  // The next sizeof(T) bytes as a number.
  template <typename T>
  [[nodiscard]] T Number() {
    T value{};
    const std::span<const std::byte> bytes = Bytes(sizeof(T));
    if (!bytes.empty()) std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }
  // The next `count` bytes.
  [[nodiscard]] std::span<const std::byte> Bytes(std::uint64_t count) {
    if (failed_ || count > rest_.size()) {
      failed_ = true;
      rest_ = {};
      return {};
    }
    const auto taken = rest_.first(static_cast<std::size_t>(count));
    rest_ = rest_.subspan(static_cast<std::size_t>(count));
    return taken;
  }
  // Bytes or text whose 32-bit length stands before them.
  [[nodiscard]] std::span<const std::byte> Block() { return Bytes(Number<std::uint32_t>()); }
  [[nodiscard]] std::string_view Text() {
    const auto bytes = Block();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  [[nodiscard]] std::span<const std::byte> rest() const { return rest_; }
  [[nodiscard]] bool AtEnd() const { return rest_.empty(); }
  [[nodiscard]] bool failed() const { return failed_; }

 private:
  std::span<const std::byte> rest_;
  bool failed_ = false;
};

// The same bytes, as text.
[[nodiscard]] inline std::string_view TextOf(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace rigcal::bags
