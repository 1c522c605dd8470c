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

bool IsLetter(char c) { return IsLower(c) || IsUpper(c); }

// Runs of letters and digits.
std::vector<std::string> PartsOf(std::string_view name) {
  std::vector<std::string> parts;
  bool in_part = false;
  for (const char c : name) {
    const bool is_part = IsDigit(c) || IsLetter(c);
    if (is_part && !in_part) parts.emplace_back();
    if (is_part) parts.back() += Lower(c);
    in_part = is_part;
  }
  return parts;
}

bool HasOnly(std::string_view part, std::string_view characters) {
  return part.find_first_not_of(characters) == std::string_view::npos;
}

// "7ba" and "af3b", as serial numbers are; "iv".
bool IsSerialNumber(std::string_view part) {
  const bool has_letter = std::any_of(part.begin(), part.end(), IsLetter),
             has_digit = std::any_of(part.begin(), part.end(), IsDigit);
  return has_letter && (has_digit ? HasOnly(part, "0123456789abcdef") : HasOnly(part, "ivx"));
}

// Of digits, without the zeros before them.
void AddNumbersIn(std::string_view part, std::vector<std::string>& numbers) {
  bool in_number = false;
  for (const char c : part) {
    if (IsDigit(c) && !in_number) numbers.emplace_back();
    in_number = IsDigit(c);
    if (in_number && (c != '0' || !numbers.back().empty())) numbers.back() += c;
  }
}

// What tells the robots of a series apart: numbers, also hexadecimal and Roman ones.
std::vector<std::string> NumbersOf(std::string_view name) {
  std::vector<std::string> numbers;
  for (const std::string& part : PartsOf(name)) {
    if (IsSerialNumber(part))
      numbers.push_back(part);
    else
      AddNumbersIn(part, numbers);
  }
  return numbers;
}

// By itself, or a capital at the end of a word: arm-a, robotB.
bool IsLoneLetter(std::string_view name, std::size_t at) {
  const auto is_letter = [&](std::size_t i) { return i < name.size() && IsLetter(name[i]); };
  const bool after_word = at > 0 && is_letter(at - 1) && !(IsUpper(name[at]) && IsLower(name[at - 1]));
  return is_letter(at) && !is_letter(at + 1) && !after_word;
}

// arm-a and arm-b: the letter counts, as a number would.
bool IsOtherLetter(std::string_view name, std::string_view known) {
  const std::string a = Mapped(name, Lower), b = Mapped(known, Lower);
  if (a.size() != b.size() || a == b) return false;
  const auto at = static_cast<std::size_t>(std::mismatch(a.begin(), a.end(), b.begin()).first - a.begin());
  return IsLoneLetter(name, at) && IsLoneLetter(known, at);
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
