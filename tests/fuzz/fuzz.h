// What the fuzz targets share. A target reads one input, checks what must hold of every answer, and aborts where it
// does not.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "server/base/result.h"
#include "server/base/text.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace rigcal::fuzz {

inline void Require(bool holds, const char* what, std::string_view detail = "") {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s %.*s\n", what, static_cast<int>(detail.size()), detail.data());
  std::abort();
}

// A refusal is short and may be shown on a terminal, whatever was refused.
inline void RequireError(const Error& error) {
  constexpr std::size_t kErrorBytesMax = 2000;
  Require(!error.what.empty(), "an error says what is wrong");
  Require(error.what.size() + error.cure.size() <= kErrorBytesMax, "an error is short", error.what);
  Require(IsPrintableUtf8(error.what) && IsPrintableUtf8(error.cure), "an error is printable", Quoted(error.what));
}

template <typename T>
bool RequireGoodError(const Result<T>& result) {
  if (!result) RequireError(result.error());
  return result.has_value();
}

template <typename Matrix>
void RequireFinite(const Matrix& matrix, const char* what) {
  Require(matrix.allFinite(), what, "is finite");
}

inline std::string_view TextOf(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// Takes an input apart; zeros and empty texts when it is used up.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(TextOf(data, size)) {}

  std::string_view Take(std::size_t size) {
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(taken.size());
    return taken;
  }
  template <typename T>
  T Number() {
    T value{};
    const std::string_view bytes = Take(sizeof value);
    if (!bytes.empty()) std::memcpy(&value, bytes.data(), bytes.size());
    return value;
  }
  // Up to its length, which stands before it.
  std::string_view Text() { return Take(Number<std::uint8_t>()); }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

}  // namespace rigcal::fuzz
