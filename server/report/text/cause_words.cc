#include "server/report/text/cause_words.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>
#include <vector>

#include "server/model/cause.h"

namespace rigcal::report {
namespace {

// {}: the sensors or boards that it is about; {or}: of which it is one; {last}: the word behind them.
struct Phrase {
  std::string_view kind, text;
};
constexpr std::array kPhrases = {
    Phrase{kFailedPairKey, "{-} failed"},
    Phrase{kMoreCausesKey, "more causes than are listed"},
    Phrase{"exchanged", "{} exchanged"},
    Phrase{"files_missing", "files of {} missing"},
    Phrase{"files_unreadable", "files of {} cannot be read"},
    Phrase{"positions_unit", "positions of {} in millimetres"},
    Phrase{"board_counts", "board {} found in no picture"},
    Phrase{"board_size", "board {} {last} than given"},
    Phrase{"lens_model", "lens of {} is {last}"},
    Phrase{"moved_within", "{or} moved during a session"},
    Phrase{"board_tilt", "boards not tilted enough"},
    Phrase{"board_places", "boards in too few places"},
    Phrase{"board_unseen", "{} sees no board"},
    Phrase{"short_session", "session of a few captures"},
    Phrase{"far_from_nominal", "{} not at its nominal (CAD) pose"},
    Phrase{"nominal_unit", "nominal pose of {} in millimetres"},
    Phrase{"not_measured", "{} not measured"},
    Phrase{"sensor_missing", "{} in the rig model but not on the robot"},
    Phrase{"sensor_kind", "{} of another kind than in the rig model"},
    Phrase{"pair_missing", "required pairs of {} not calibrated"},
    Phrase{"off_rig_model", "{} not where the rig model has it"},
    Phrase{"reference_not_drawn", "{} without a place in the rig model"},
    Phrase{"moved", "{or} moved"},
    Phrase{"lens_changed", "lens of {} changed"},
    Phrase{"wrong_intrinsics", "intrinsics given for {} not those of its lens"},
    Phrase{"disagree", "{-} do not agree"},
    Phrase{"open_loop", "loops that do not close"},
    Phrase{"measured_in_part", "{} not measured along every axis"},
    Phrase{"few_captures", "too few captures"},
    Phrase{"uncertain", "{} less certain than wanted"},
    Phrase{"apart", "{} elsewhere on another visit"},
    Phrase{"unchecked", "poses that nothing checks"},
    Phrase{"hardly_checked", "pairs checked in part or too roughly"},
};

constexpr std::string_view kDisputed = "disputed";  // of a board's size: lidars and trackers do not agree

std::vector<std::string> WordsIn(const std::string& key) {
  std::istringstream stream(key);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

// "+2": and two more.
std::string JoinedNames(const std::vector<std::string>& names, const char* between) {
  std::string text;
  for (const std::string& name : names) {
    if (name.front() == '+')
      text += " and " + name.substr(1) + " more";
    else
      text += (text.empty() ? "" : between) + name;
  }
  return text;
}

void PutWords(std::string_view place, const std::string& words, std::string& text) {
  if (const auto at = text.find(place); at != std::string::npos) text.replace(at, place.size(), words);
}

std::string OwnWords(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
}

}  // namespace

std::string CauseText(const std::string& key) {
  std::vector<std::string> names = WordsIn(key);
  const auto phrase = std::find_if(kPhrases.begin(), kPhrases.end(),
                                   [&](const Phrase& one) { return !names.empty() && one.kind == names.front(); });
  if (phrase == kPhrases.end()) return OwnWords(key);
  names.erase(names.begin());
  std::string text(phrase->text), last;
  if (text.find("{last}") != std::string::npos && !names.empty()) {
    last = names.back();
    names.pop_back();
    if (last == kDisputed) text = "size of board {} {last}";
  }
  PutWords("{last}", last, text);
  PutWords("{-}", JoinedNames(names, " - "), text);
  PutWords("{or}", JoinedNames(names, " or "), text);
  PutWords("{}", JoinedNames(names, ", "), text);
  if (const auto gap = text.find("  "); gap != std::string::npos) text.erase(gap, 1);  // no board is known by name
  return text;
}

}  // namespace rigcal::report
