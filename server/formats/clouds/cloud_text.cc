#include "server/formats/clouds/cloud_text.h"

#include <algorithm>

#include "server/base/number_text.h"

namespace rigcal::formats {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

}  // namespace

std::string_view TextLines::Next() {
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  ++next_line_;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::optional<std::string_view> TextLines::NextFilled() {
  while (!AtEnd())
    if (const std::string_view line = Next(); line.find_first_not_of(kBlanks) != std::string_view::npos) return line;
  return std::nullopt;
}

std::string_view TakeWord(std::string_view& line) {
  const std::size_t begin = std::min(line.find_first_not_of(kBlanks), line.size());
  const std::size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

std::vector<std::string_view> WordsOf(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::string_view word = TakeWord(line); !word.empty(); word = TakeWord(line)) words.push_back(word);
  return words;
}

std::optional<std::uint64_t> CountOf(std::string_view word) { return NumberIn<std::uint64_t>(word); }

std::optional<double> NumberOf(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  return NumberIn<double>(word);
}

}  // namespace rigcal::formats
