#include "client/upkeep/support/redact.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <initializer_list>
#include <optional>
#include <regex>
#include <utility>
#include <vector>

#include "client/text/document.h"

namespace rigcal::client {
namespace {

struct Rule {
  std::regex pattern;
  std::string instead;
};

std::regex Pattern(const char* text) { return std::regex(text, std::regex::ECMAScript | std::regex::icase); }

// Names of settings. One that names a file with a secret in it (webhook-secret-file) is none.
const std::string kSecretWord = "(?:password|passwd|passphrase|secret|token|credential|(?:api|access|private)[-_]?key)";
const std::string kAnyName = R"re((?![a-z0-9_-]*[-_]file"?[ \t]*[=:])[a-z0-9_-]*)re";
const std::string kSecretName = kAnyName + kSecretWord + "[a-z0-9_-]*";
const std::string kSecretSign = R"re("?[ \t]*[=:][ \t]*)re";
const std::string kSettingBegin = R"re(^([ \t]*(?:export[ \t]+|environment="?|-[ \t]+)?"?)re";
constexpr std::size_t kLineBytesMax = 8192;  // std::regex recurses by character

// A line that is one setting loses all behind the sign; amid others, what is quoted or up to the next blank.
const std::vector<Rule>& Rules() {
  static const std::string kInstead = std::string("$1") + kRedacted;
  static const std::string kAmid = "((?:^|[^a-z0-9_-])" + kSecretName + kSecretSign + ")";
  static const std::vector<Rule> rules = {
      {Pattern(R"re(([a-z][a-z0-9+.-]*://[^\s:/@"']*:)[^\s"]*@)re"), kInstead + "@"},
      {Pattern(R"re(([a-z][a-z0-9+.-]*://[^\s"?]*\?)[^\s"]+)re"), kInstead},
      {Pattern((kSettingBegin + kSecretName + kSecretSign + R"re()[^\r\n]+)re").c_str()), kInstead},
      {Pattern(("(<[a-z0-9_:-]*" + kSecretWord + "[^<>]*>)[^<]+").c_str()), kInstead},
      {Pattern(R"re(((?:cookie|authorization)"?[ \t]*[:=][ \t]*)[^\r\n]*)re"), kInstead},
      {Pattern(R"re((bearer[ \t]+)[A-Za-z0-9._~+/=-]+)re"), kInstead},
      {Pattern(R"re((\bpassword[ \t]+)[^\s=:]+)re"), kInstead},
      {Pattern((kAmid + R"re("(?:\\.|[^"\\\r\n])*"?)re").c_str()), "$1\"" + std::string(kRedacted) + "\""},
      {Pattern((kAmid + R"re(('[^'\r\n]*'?|[^\s"]+))re").c_str()), kInstead},
  };
  return rules;
}

// Of many services the path of a webhook is what lets a message in.
const Rule& WebhookRule() {
  static const Rule rule = {Pattern(R"re(([a-z][a-z0-9+.-]*://[^\s/"?#]+/)[^\s"]+)re"), std::string("$1") + kRedacted};
  return rule;
}

std::string InLower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool IsOfWebhook(const std::string& text) {
  const std::string lower = InLower(text);
  return lower.find("webhook") != lower.npos || lower.find("://hooks.") != lower.npos;
}

std::string WithoutKeys(std::string_view text) {
  constexpr std::string_view kBegin = "-----BEGIN ", kKind = "PRIVATE KEY-----", kEnd = "-----END ";
  std::string kept;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t begin = text.find(kBegin, at);
    const std::size_t line = begin == text.npos ? text.npos : text.find('\n', begin);
    kept += text.substr(at, begin == text.npos ? text.npos : begin - at);
    if (begin == text.npos) break;
    const bool is_key = text.substr(begin, line == text.npos ? line : line - begin).find(kKind) != text.npos;
    const std::size_t end = is_key ? text.find(kKind, text.find(kEnd, begin)) : begin + kBegin.size();
    kept += is_key ? std::string_view(kRedacted) : kBegin;
    at = end == text.npos ? text.size() : end + (is_key ? kKind.size() : 0);
  }
  return kept;
}

// The patterns take their time: most lines need none.
bool MayHaveSecret(const std::string& text) {
  constexpr std::array kSigns = {"://",   "bearer",     "cookie", "authorization", "pass", "secret",
                                 "token", "credential", "key"};
  const std::string line = InLower(text);
  return std::any_of(kSigns.begin(), kSigns.end(), [&](const char* sign) { return line.find(sign) != line.npos; });
}

// Which lines go on with the value of a setting that is a secret, or of a webhook.
class OpenValue {
 public:
  // To be asked of every line in turn.
  bool GoesOnIn(const std::string& line) {
    const bool goes_on = !until_.empty() || by_backslash_ || (below_ && IsBelow(line));
    if (!goes_on) return Begin(line), false;
    if (!until_.empty() && line.find(until_) != line.npos) until_.clear();
    by_backslash_ = by_backslash_ && EndsInBackslash(line);
    return true;
  }

 private:
  static std::string Trimmed(const std::string& text) { return text.substr(0, text.find_last_not_of(" \t\r") + 1); }
  static bool EndsInBackslash(const std::string& line) { return Trimmed(line).ends_with('\\'); }
  static std::size_t IndentOf(const std::string& line) { return std::min(line.find_first_not_of(" \t"), line.size()); }
  // Blocks and lists of YAML; the items of a list need not stand further in than its name.
  [[nodiscard]] bool IsBelow(const std::string& line) const {
    const std::size_t indent = IndentOf(line);
    return Trimmed(line).empty() || indent > *below_ || (indent == *below_ && line.compare(indent, 2, "- ") == 0);
  }

  void Begin(const std::string& line) {
    static const std::regex setting = Pattern((kSettingBegin + "(?:" + kSecretName + "|" + kAnyName +
                                               "webhook[a-z0-9_-]*)" + kSecretSign + R"re()([^\r\n]*))re")
                                                  .c_str());
    static const std::regex element = Pattern(("<[a-z0-9_:-]*" + kSecretWord + "[^<>]*>[^<]*$").c_str());
    below_.reset();
    const std::string seen = line.substr(0, kLineBytesMax);
    std::smatch match;
    if (!MayHaveSecret(seen) && !IsOfWebhook(seen)) return;
    if (std::regex_search(seen, match, setting))
      TakeUp(Trimmed(match[2]), line);
    else if (std::regex_search(seen, element))
      until_ = "<";
  }

  void TakeUp(const std::string& value, const std::string& line) {
    for (const auto& [opens, closes] : std::initializer_list<std::pair<std::string_view, std::string_view>>{
             {"\"\"\"", "\"\"\""}, {"\'\'\'", "\'\'\'"}, {"\"", "\""}, {"\'", "\'"}, {"[", "]"}, {"{", "}"}}) {
      if (!value.starts_with(opens)) continue;
      if (value.find(closes, opens.size()) == value.npos) until_ = closes;
      break;
    }
    by_backslash_ = until_.empty() && EndsInBackslash(line);
    static const std::regex block("[|>][-+0-9]*");
    if (value.empty() || std::regex_match(value, block)) below_ = IndentOf(line);
  }

  std::string until_;  // what ends it
  bool by_backslash_ = false;
  std::optional<std::size_t> below_;  // lines that stand further in than this
};

// Line by line: a pattern never sees more than one, however long the text.
std::string LineRedacted(std::string line, bool is_of_webhook) {
  if (line.size() > kLineBytesMax) line = line.substr(0, kLineBytesMax) + " [cut]";
  if (!MayHaveSecret(line)) return line;
  if (is_of_webhook || IsOfWebhook(line)) line = std::regex_replace(line, WebhookRule().pattern, WebhookRule().instead);
  for (const Rule& rule : Rules()) line = std::regex_replace(line, rule.pattern, rule.instead);
  return line;
}

std::string TextRedacted(std::string_view text, bool is_of_webhook) {
  const std::string without_keys = WithoutKeys(text);
  std::string kept;
  OpenValue open;
  for (std::size_t at = 0; at < without_keys.size();) {
    const std::size_t end = std::min(without_keys.find('\n', at), without_keys.size());
    const std::string line = without_keys.substr(at, end - at);
    kept += open.GoesOnIn(line) ? kRedacted : LineRedacted(line, is_of_webhook);
    if (end < without_keys.size()) kept += '\n';
    at = end + 1;
  }
  return kept;
}

// Whether what stands under this name is a secret.
bool NamesSecret(const std::string& name) {
  static const std::regex pattern = Pattern((kSecretName + ":").c_str());
  return std::regex_match(name.substr(0, 256) + ":", pattern);
}

// `is_secret`, `is_of_webhook`: by the names above it.
std::string ValueRedacted(const Document& value, bool is_secret, bool is_of_webhook) {
  std::vector<Field> fields;
  for (const std::string& name : value.Keys())
    fields.push_back(Field::Raw(
        name, ValueRedacted(value[name], is_secret || NamesSecret(name), is_of_webhook || IsOfWebhook(name))));
  if (!fields.empty()) return JsonObject(fields);
  std::string items;
  for (const Document& item : value.Items())
    items += (items.empty() ? "" : ",") + ValueRedacted(item, is_secret, is_of_webhook);
  if (!items.empty()) return "[" + items + "]";
  if (is_secret && !value.IsNull()) return Field("", kRedacted).json;
  std::string dumped = value.Dump();
  return dumped.starts_with('"') ? Field("", TextRedacted(value.Text(), is_of_webhook)).json : dumped;
}

}  // namespace

std::string Redacted(std::string_view text) { return TextRedacted(text, false); }

std::string RedactedJson(std::string_view text) {
  const auto document = Document::Parse(text, "document");
  return document ? ValueRedacted(*document, false, false) + "\n" : Redacted(text);
}

}  // namespace rigcal::client
