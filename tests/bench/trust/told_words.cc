#include "tests/bench/trust/told_words.h"

#include <algorithm>
#include <cctype>

namespace rigcal {
namespace {

bool IsOfId(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.'; }

// A full stop or dash at the end belongs to the sentence.
std::vector<std::string_view> WordsOf(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at;
    while (end < text.size() && IsOfId(text[end])) ++end;
    std::string_view word = text.substr(at, end - at);
    while (!word.empty() && (word.back() == '.' || word.back() == '-')) word.remove_suffix(1);
    if (!word.empty()) words.push_back(word);
    at = std::max(end, at + 1);
  }
  return words;
}

bool Has(const std::vector<std::string_view>& words, std::initializer_list<std::string_view> wanted) {
  return std::any_of(words.begin(), words.end(), [&](std::string_view word) {
    return std::find(wanted.begin(), wanted.end(), word) != wanted.end();
  });
}

template <typename Id>
const Id* Find(const std::vector<Id>& ids, std::string_view word) {
  const auto found = std::find_if(ids.begin(), ids.end(), [&](const Id& id) { return id.str() == word; });
  return found == ids.end() ? nullptr : &*found;
}

}  // namespace

std::set<SensorId> SensorsIn(std::string_view text, const std::vector<SensorId>& sensors) {
  std::set<SensorId> named;
  for (const std::string_view word : WordsOf(text))
    if (const SensorId* sensor = Find(sensors, word)) named.insert(*sensor);
  return named;
}

// A number is an id after the word, or unless it counts or measures something.
std::set<CaptureId> CapturesIn(std::string_view text, const std::vector<CaptureId>& captures) {
  const std::vector<std::string_view> words = WordsOf(text);
  std::set<CaptureId> named;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const CaptureId* capture = Find(captures, words[i]);
    if (capture == nullptr) continue;
    const bool is_told = i > 0 && Has({words[i - 1]}, {"capture", "captures", "Capture", "Captures"});
    const bool is_amount =
        i + 1 < words.size() &&
        Has({words[i + 1]},
            {"capture", "captures", "picture", "pictures", "cloud", "clouds", "of",    "to",   "mm",    "m",
             "px",      "deg",      "degrees", "times",    "sigma", "poses",  "edges", "more", "beams", "points"});
    if (is_told || !is_amount) named.insert(*capture);
  }
  return named;
}

bool SaysMoved(std::string_view text) {
  return Has(WordsOf(text), {"moved", "Moved", "bumped"}) || text.find("two poses") != text.npos;
}

bool SaysLens(std::string_view text) {
  return Has(WordsOf(text), {"lens", "lenses", "distortion", "pinhole_radtan", "pinhole_rational", "fisheye_kb4"});
}

}  // namespace rigcal
