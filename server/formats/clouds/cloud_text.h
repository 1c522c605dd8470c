// The lines of a cloud file's header and of its body, if that is text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "server/base/result.h"

namespace rigcal::formats {

// Takes lines off a text, "\n" or "\r\n" after each. Views into the text.
class TextLines {
 public:
  // `first_line`: the number of the text's first line in its file.
  explicit TextLines(std::string_view text, std::size_t first_line = 1) : rest_(text), next_line_(first_line) {}

  // Nothing is left, not even an empty line.
  [[nodiscard]] bool AtEnd() const { return rest_.empty(); }
  // The next line, without what ends it; empty at the end.
  std::string_view Next();
  // The next one that is not blank; nothing at the end.
  std::optional<std::string_view> NextFilled();
  // Of the line that Next() gave last, counted from 1.
  [[nodiscard]] std::size_t line() const { return next_line_ - 1; }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::size_t next_line_;
};

// The next word of `line`, which is shortened by it; empty at its end.
[[nodiscard]] std::string_view TakeWord(std::string_view& line);
[[nodiscard]] std::vector<std::string_view> WordsOf(std::string_view line);

// Digits only; nothing for anything else, or beyond 64 bits.
[[nodiscard]] std::optional<std::uint64_t> CountOf(std::string_view word);
// Also "nan", "inf" and a leading '+'; nothing if it is no number or beyond the range of a double.
[[nodiscard]] std::optional<double> NumberOf(std::string_view word);

}  // namespace rigcal::formats
