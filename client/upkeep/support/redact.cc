#include "client/upkeep/support/redact.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <regex>
#include <string_view>
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

// How a quoted text or a bracket of some lines stands open at the end of a line.
class OpenText {
 public:
  [[nodiscard]] bool IsOpen() const { return !quote_.empty() || depth_ > 0; }

  // A value from its first character on.
  void Begin(std::string_view value) {
    *this = OpenText();
    if (!value.empty() && (IsOpening(value.front()) || !QuoteAt(value).empty())) Read(value);
  }

  // What follows the value, or a remark behind it, is none of it.
  void Read(std::string_view text) {
    for (std::size_t at = 0; at < text.size();) {
      const std::string_view rest = text.substr(at);
      if (!quote_.empty())
        at += ReadQuoted(rest);
      else if (const std::string_view quote = QuoteAt(rest); !quote.empty())
        at += quote.size(), quote_ = quote;
      else
        at += ReadBracket(rest.front());
      if (!IsOpen()) break;
    }
  }

 private:
  static bool IsOpening(char c) { return c == '[' || c == '{'; }
  static bool IsClosing(char c) { return c == ']' || c == '}'; }
  static std::string_view QuoteAt(std::string_view text) {
    for (const char* quote : {"\"\"\"", "\'\'\'", "\"", "\'"})
      if (text.starts_with(quote)) return quote;
    return {};
  }

  std::size_t ReadBracket(char c) {
    if (IsOpening(c)) ++depth_;
    if (IsClosing(c)) --depth_;
    return 1;
  }

  std::size_t ReadQuoted(std::string_view rest) {
    if (rest.front() == '\\' && quote_.front() == '"') return 2;
    if (quote_ == "'" && rest.starts_with("''")) return 2;  // of YAML: an apostrophe
    if (!rest.starts_with(quote_)) return 1;
    const std::size_t size = quote_.size();
    quote_ = "";
    return size;
  }

  std::string_view quote_;  // what ends it
  int depth_ = 0;           // brackets outside quotes
};

// Which lines go on with the value of a setting that is a secret, or of a webhook.
class OpenValue {
 public:
  // To be asked of every line in turn.
  bool GoesOnIn(const std::string& line) {
    const bool goes_on = text_.IsOpen() || in_element_ || by_backslash_ || (below_ && IsBelow(line));
    if (!goes_on) return Begin(line), false;
    if (text_.IsOpen()) text_.Read(line);
    in_element_ = in_element_ && line.find('<') == line.npos;
    by_backslash_ = by_backslash_ && EndsInBackslash(line);
    return true;
  }

 private:
  static std::string Trimmed(const std::string& text) { return text.substr(0, text.find_last_not_of(" \t\r") + 1); }
  static bool EndsInBackslash(const std::string& line) { return Trimmed(line).ends_with('\\'); }
  static std::size_t IndentOf(const std::string& line) { return std::min(line.find_first_not_of(" \t"), line.size()); }
  // Blocks, lists and plain text of YAML; the items of a list need not stand further in than its name.
  [[nodiscard]] bool IsBelow(const std::string& line) const {
    const std::size_t indent = IndentOf(line);
    if (Trimmed(line).empty() || indent > *below_) return true;
    return has_items_ && indent == *below_ && line.compare(indent, 2, "- ") == 0;
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
    else
      in_element_ = std::regex_search(seen, element);
  }

  void TakeUp(const std::string& value, const std::string& line) {
    text_.Begin(value);
    by_backslash_ = !text_.IsOpen() && EndsInBackslash(line);
    has_items_ = value.empty() || value.front() == '#';
    below_ = IndentOf(line);
  }

  OpenText text_;
  bool in_element_ = false, by_backslash_ = false, has_items_ = false;
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
    const bool is_blank = line.find_first_not_of(" \t\r") == line.npos;
    kept += open.GoesOnIn(line) && !is_blank ? kRedacted : LineRedacted(line, is_of_webhook);
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
