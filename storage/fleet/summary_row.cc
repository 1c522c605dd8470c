#include "storage/fleet/summary_row.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "server/model/robots/drive_rule.h"

namespace rigcal::storage {
namespace {

char Lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string Lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), Lower);
  return text;
}

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// The digits from `at` on, without leading zeros.
std::string_view NumberAt(std::string_view text, std::size_t at) {
  while (at + 1 < text.size() && text[at] == '0' && IsDigit(text[at + 1])) ++at;
  std::size_t end = at;
  while (end < text.size() && IsDigit(text[end])) ++end;
  return text.substr(at, end - at);
}

// As pages have it: "warn" is in it.
std::string WordOf(VerdictLevel level) { return level == VerdictLevel::kWarn ? "warning" : NameOf(level); }

// Of the status and the drive rule what holds whatever the time.
std::string RuleWordsOf(VerdictLevel level) {
  if (level == VerdictLevel::kFail) return " " + NameOf(StatusWord::kFailed) + " " + WordsFor(DriveKind::kDoNotDrive);
  return level == VerdictLevel::kUnknown ? " " + WordsFor(DriveKind::kNotVerified) : "";
}

void AddDate(const std::optional<Stamp>& at, std::string& text) {
  if (at) text += " " + DayText(*at) + " " + ToIso(*at).substr(0, 10);
}

}  // namespace

// A number is a digit, as it stands among other characters; then its length, then itself. '\x01' comes before all that
// ids hold: of two that go on alike the shorter is first, and what differs by leading zeros only is told apart by the
// id.
std::string NameKeyOf(const RobotId& robot) {
  const std::string& id = robot.str();
  std::string key;
  for (std::size_t at = 0; at < id.size();) {
    if (!IsDigit(id[at])) {
      key.push_back(id[at++]);
      continue;
    }
    const std::string_view number = NumberAt(id, at);
    key.push_back('0');
    key.push_back(static_cast<char>('0' + number.size()));  // ids are short
    key += number;
    at = static_cast<std::size_t>(number.data() - id.data()) + number.size();
  }
  return key + '\x01' + id;
}

std::string SearchTextOf(const RobotSummary& summary) {
  const Verdict& verdict = summary.verdict;
  std::string text = summary.robot.str() + " " + WordOf(verdict.level) + " " + verdict.why + " " + verdict.what_to_do;
  text += RuleWordsOf(verdict.level);
  if (summary.worst) text += " " + summary.worst->frame_a.str() + " " + summary.worst->frame_b.str();
  for (const std::string& cause : summary.causes) text += " " + cause;
  text += " " + summary.rig_model + " " + summary.site + " " + summary.operator_name;
  if (summary.found.word != StatusWord::kOk) text += " " + NameOf(summary.found.word) + " " + summary.found.why;
  if (summary.runs) text += " " + summary.runs->trouble;
  if (!summary.validity.calibrated_at) text += " not calibrated never";
  AddDate(summary.validity.calibrated_at, text);
  AddDate(ValidUntil(summary.validity), text);
  AddDate(summary.last_session_at, text);
  if (summary.drift_due) {
    AddDate(summary.drift_due->at, text);
    text += " drift of " + summary.drift_due->sensor.str();
  }
  if (summary.revision > 0) text += " revision " + std::to_string(summary.revision);
  text += " " + std::to_string(summary.sessions) + " sessions " + std::to_string(summary.edges) + " edges";
  return Lowered(std::move(text));
}

std::vector<std::string> SearchWordsOf(const std::string& search) {
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

std::string ListOfKeys(const std::vector<std::string>& keys) {
  std::string list = "[";
  for (const std::string& key : keys) list += (list.size() == 1 ? "\"" : ",\"") + key + "\"";
  return list + "]";
}

std::vector<std::string> KeysOfList(const std::string& list) {
  std::vector<std::string> keys;
  for (std::size_t open = list.find('"'); open != std::string::npos;) {
    const std::size_t close = list.find('"', open + 1);
    if (close == std::string::npos) break;
    keys.push_back(list.substr(open + 1, close - open - 1));
    open = list.find('"', close + 1);
  }
  return keys;
}

}  // namespace rigcal::storage
