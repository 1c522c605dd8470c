#include "server/report/fleet_view.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace rigcal::report {
namespace {

char Lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string Lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), Lower);
  return text;
}

std::vector<std::string> WordsOf(const std::string& search) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : Lowered(search) + " ") {
    if (c != ' ')
      word.push_back(c);
    else if (!word.empty())
      words.push_back(std::exchange(word, {}));
  }
  return words;
}

// One of the choices of the page.
bool IsLike(const FleetRow& row, Stamp now, const std::string& choice) {
  if (choice.empty()) return true;
  if (choice == "overdue") return row.validity.overdue;
  if (choice == "off") return row.worst && row.worst->in_sigmas >= kOff_sigmas;
  if (choice == "quiet") return !row.last_session_at || now.ns - row.last_session_at->ns > kQuiet_ns;
  return NameOf(row.verdict.level) == choice;
}

bool HasWords(const FleetRow& row, const std::vector<std::string>& words) {
  if (words.empty()) return true;
  std::string text = row.robot.str() + " " + NameOf(row.verdict.level) + " " + row.verdict.why;
  if (row.worst) text += " " + row.worst->frame_a + " " + row.worst->frame_b;
  text = Lowered(std::move(text));
  return std::all_of(words.begin(), words.end(),
                     [&](const std::string& word) { return text.find(word) != std::string::npos; });
}

// What is overdue may be relied on no more than a warning allows: it goes before those.
int UrgencyOf(const FleetRow& row) {
  const int overdue = row.validity.overdue ? 0 : 1;
  switch (row.verdict.level) {
    case VerdictLevel::kFail:
      return overdue;
    case VerdictLevel::kUnknown:
      return 2 + overdue;
    case VerdictLevel::kWarn:
      return overdue == 0 ? 4 : 6;
    case VerdictLevel::kPass:
      break;
  }
  return overdue == 0 ? 5 : 7;
}

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// The digits from `at` on, without leading zeros.
std::string_view NumberAt(std::string_view text, std::size_t at) {
  while (at + 1 < text.size() && text[at] == '0' && IsDigit(text[at + 1])) ++at;
  std::size_t end = at;
  while (end < text.size() && IsDigit(text[end])) ++end;
  return text.substr(at, end - at);
}

// "robot-9" before "robot-10": as people count.
bool IsBefore(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (IsDigit(a[i]) && IsDigit(b[j])) {
      const std::string_view left = NumberAt(a, i), right = NumberAt(b, j);
      if (left.size() != right.size()) return left.size() < right.size();
      if (left != right) return left < right;
      i = static_cast<std::size_t>(left.data() - a.data()) + left.size();
      j = static_cast<std::size_t>(right.data() - b.data()) + right.size();
      continue;
    }
    if (a[i] != b[j]) return a[i] < b[j];
    ++i, ++j;
  }
  return a.size() - i != b.size() - j ? a.size() - i < b.size() - j : a < b;
}

// A number to sort by, the smallest first; equal ones by name.
std::int64_t KeyOf(const FleetRow& row, const std::string& sort) {
  if (sort == "robot") return 0;
  if (sort == "calibrated") return row.validity.calibrated_at.value_or(Stamp{}).ns;
  if (sort == "session") return row.last_session_at ? row.last_session_at->ns : 0;
  // A thousandth of sigma tells edges apart; beyond 1e12 sigma all are alike.
  if (sort == "worst") return row.worst ? -std::llround(std::min(row.worst->in_sigmas, 1e12) * 1e3) : 1;
  if (sort == "revision") return -row.revision;
  if (sort == "sessions") return -row.sessions;
  if (sort == "edges") return -row.edges;
  return UrgencyOf(row);
}

}  // namespace

FleetSlice SliceOf(const std::vector<FleetRow>& rows, const FleetQuery& query, Stamp now) {
  const std::vector<std::string> words = WordsOf(query.search);
  FleetSlice slice;
  for (const FleetRow& row : rows)
    if (IsLike(row, now, query.verdict) && HasWords(row, words)) slice.rows.push_back(&row);
  std::sort(slice.rows.begin(), slice.rows.end(), [&](const FleetRow* a, const FleetRow* b) {
    const std::int64_t left = KeyOf(*a, query.sort), right = KeyOf(*b, query.sort);
    if (left != right) return (left < right) != query.descending;
    // Only a list by name is turned; elsewhere equal ones keep one order.
    return query.sort == "robot" && query.descending ? IsBefore(b->robot.str(), a->robot.str())
                                                     : IsBefore(a->robot.str(), b->robot.str());
  });
  slice.matches = slice.rows.size();
  slice.pages = std::max<std::size_t>(1, (slice.matches + kFleetRowsMax - 1) / kFleetRowsMax);
  slice.page = std::clamp<std::size_t>(query.page, 1, slice.pages);
  const auto first = slice.rows.begin() + static_cast<std::ptrdiff_t>((slice.page - 1) * kFleetRowsMax);
  const auto last =
      slice.rows.begin() + static_cast<std::ptrdiff_t>(std::min(slice.page * kFleetRowsMax, slice.matches));
  slice.rows = std::vector<const FleetRow*>(first, last);
  return slice;
}

}  // namespace rigcal::report
