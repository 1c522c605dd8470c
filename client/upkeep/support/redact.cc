#include "client/upkeep/support/redact.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <regex>
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
const std::string kSecretName = R"re((?![a-z0-9_-]*[-_]file"?[ \t]*[=:])[a-z0-9_-]*)re" + kSecretWord + "[a-z0-9_-]*";
const std::string kSecretSign = R"re("?[ \t]*[=:][ \t]*)re";

// A line that is one setting loses all behind the sign; amid others, what is quoted or up to the next blank.
const std::vector<Rule>& Rules() {
  static const std::string kInstead = std::string("$1") + kRedacted;
  static const std::string kBegin = R"re(^([ \t]*(?:export[ \t]+|environment="?|-[ \t]+)?"?)re";
  static const std::string kAmid = "((?:^|[^a-z0-9_-])" + kSecretName + kSecretSign + ")";
  static const std::vector<Rule> rules = {
      {Pattern(R"re(([a-z][a-z0-9+.-]*://[^\s:/@"']*:)[^\s"]*@)re"), kInstead + "@"},
      {Pattern(R"re(([a-z][a-z0-9+.-]*://[^\s"?]*\?)[^\s"]+)re"), kInstead},
      {Pattern((kBegin + kSecretName + kSecretSign + R"re()[^\r\n]+)re").c_str()), kInstead},
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

// Line by line: a pattern never sees more than one, however long the text.
std::string LineRedacted(std::string line, bool is_of_webhook) {
  constexpr std::size_t kLineBytesMax = 8192;  // std::regex recurses by character
  if (line.size() > kLineBytesMax) line = line.substr(0, kLineBytesMax) + " [cut]";
  if (!MayHaveSecret(line)) return line;
  if (is_of_webhook || IsOfWebhook(line)) line = std::regex_replace(line, WebhookRule().pattern, WebhookRule().instead);
  for (const Rule& rule : Rules()) line = std::regex_replace(line, rule.pattern, rule.instead);
  return line;
}

std::string TextRedacted(std::string_view text, bool is_of_webhook) {
  const std::string without_keys = WithoutKeys(text);
  std::string kept;
  for (std::size_t at = 0; at < without_keys.size();) {
    const std::size_t end = std::min(without_keys.find('\n', at), without_keys.size());
    kept += LineRedacted(without_keys.substr(at, end - at), is_of_webhook);
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
