#include "server/base/near_names.h"

#include <algorithm>
#include <numeric>

namespace rigcal {
namespace {

constexpr std::size_t kEditsMax = 2, kCharactersPerEdit = 3;
constexpr std::size_t kSlipLengthMin = 4;
constexpr std::size_t kToldMax = 3;
constexpr std::string_view kNameCharacters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";

bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool IsUpper(char c) { return c >= 'A' && c <= 'Z'; }
bool IsLower(char c) { return c >= 'a' && c <= 'z'; }
char Lower(char c) { return IsUpper(c) ? static_cast<char>(c - 'A' + 'a') : c; }
char Upper(char c) { return IsLower(c) ? static_cast<char>(c - 'a' + 'A') : c; }

std::string Mapped(std::string_view name, char (*map)(char)) {
  std::string mapped(name);
  std::transform(mapped.begin(), mapped.end(), mapped.begin(), map);
  return mapped;
}

// Those in a name, without the zeros before them.
std::vector<std::string> NumbersOf(std::string_view name) {
  std::vector<std::string> numbers;
  bool in_number = false;
  for (const char c : name) {
    if (IsDigit(c) && !in_number) numbers.emplace_back();
    in_number = IsDigit(c);
    if (in_number && (c != '0' || !numbers.back().empty())) numbers.back() += c;
  }
  return numbers;
}

bool IsLoneLetter(std::string_view name, std::size_t at) {
  const auto is_letter = [&](std::size_t i) { return i < name.size() && (IsLower(name[i]) || IsUpper(name[i])); };
  return is_letter(at) && !is_letter(at + 1) && (at == 0 || !is_letter(at - 1));
}

// arm-a and arm-b: the letter counts, as a number would.
bool IsOtherLetter(std::string_view name, std::string_view known) {
  const std::string a = Mapped(name, Lower), b = Mapped(known, Lower);
  if (a.size() != b.size() || a == b) return false;
  const auto at = static_cast<std::size_t>(std::mismatch(a.begin(), a.end(), b.begin()).first - a.begin());
  return IsLoneLetter(a, at) && IsLoneLetter(b, at);
}

std::vector<std::string> CutToTold(std::vector<std::string> names) {
  if (names.size() > kToldMax) names.erase(names.begin() + kToldMax, names.end());
  return names;
}

}  // namespace

std::size_t EditDistance(std::string_view a, std::string_view b) {
  if (a == b) return 0;
  const std::string x = Mapped(a, Lower), y = Mapped(b, Lower);
  std::vector<std::size_t> before(y.size() + 1), last(y.size() + 1), row(y.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 0; i < x.size(); ++i) {
    row[0] = i + 1;
    for (std::size_t j = 0; j < y.size(); ++j) {
      row[j + 1] = std::min({last[j] + (x[i] == y[j] ? 0 : 1), last[j + 1] + 1, row[j] + 1});
      if (i > 0 && j > 0 && x[i] == y[j - 1] && x[i - 1] == y[j]) row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
    }
    before.swap(last);
    last.swap(row);
  }
  return std::max<std::size_t>(last.back(), 1);
}

bool IsSlip(std::string_view name, std::string_view known) {
  return std::min(name.size(), known.size()) >= kSlipLengthMin && EditDistance(name, known) == 1 &&
         NumbersOf(name) == NumbersOf(known) && !IsOtherLetter(name, known);
}

std::vector<std::string> NearestNames(std::string_view name, std::span<const std::string> known) {
  std::size_t nearest = std::min(kEditsMax, name.size() / kCharactersPerEdit);
  std::vector<std::string> slips, names;
  for (const std::string& one : known) {
    if (std::max(one.size(), name.size()) - std::min(one.size(), name.size()) > nearest) continue;
    const std::size_t distance = EditDistance(name, one);
    if (distance == 0 || distance > nearest) continue;
    if (distance < nearest) names.clear();
    nearest = distance;
    names.push_back(one);
    if (IsSlip(name, one)) slips.push_back(one);
  }
  if (!slips.empty()) return CutToTold(std::move(slips));
  return names.size() > kToldMax ? std::vector<std::string>() : names;
}

std::string Suggestion(std::span<const std::string> names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
  return text.empty() ? "" : ": did you mean " + text + "?";
}

std::vector<std::string> NamesOneEditAway(std::string_view name) {
  std::vector<std::string> names = {Mapped(name, Lower), Mapped(name, Upper)};
  for (std::size_t at = 0; at <= name.size(); ++at) {
    const std::string head(name.substr(0, at)), tail(name.substr(at));
    for (const char c : kNameCharacters) {
      names.push_back(head + c + tail);
      if (!tail.empty()) names.push_back(head + c + tail.substr(1));
    }
    if (!tail.empty()) names.push_back(head + tail.substr(1));
    if (tail.size() > 1) names.push_back(head + tail[1] + tail[0] + tail.substr(2));
  }
  return names;
}

}  // namespace rigcal
