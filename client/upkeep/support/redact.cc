#include "client/upkeep/support/redact.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <regex>
#include <vector>

namespace rigcal::client {
namespace {

struct Rule {
  std::regex pattern;
  std::string instead;
};

std::regex Pattern(const char* text) { return std::regex(text, std::regex::ECMAScript | std::regex::icase); }

// An option that names a file with a secret in it (webhook-secret-file) is none.
const std::vector<Rule>& Rules() {
  static const std::string kInstead = std::string("$1") + kRedacted;
  static const std::string kNames =
      R"re(([a-z0-9_-]*(?:password|passwd|passphrase|secret|token|credential|api[-_]?key)[a-z0-9]*"?[ \t]*[=:][ \t]*))re";
  static const std::vector<Rule> rules = {
      {Pattern(R"re(([a-z][a-z0-9+.-]*://[^\s:/@"']*:)[^\s"']*@)re"), kInstead + "@"},
      {Pattern(R"re(((?:cookie|authorization)"?[ \t]*[:=][ \t]*)[^\r\n]*)re"), kInstead},
      {Pattern(R"re((bearer[ \t]+)[A-Za-z0-9._~+/=-]+)re"), kInstead},
      {Pattern(R"re((\bpassword[ \t]+)[^\s=:]+)re"), kInstead},
      {Pattern((kNames + R"re("[^"\r\n]*"?)re").c_str()), "$1\"" + std::string(kRedacted) + "\""},
      {Pattern((kNames + R"re(('[^'\r\n]*'?|[^\s,;}&"]+))re").c_str()), kInstead},
  };
  return rules;
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
bool MayHaveSecret(std::string line) {
  constexpr std::array kSigns = {"://",   "bearer",     "cookie", "authorization", "pass", "secret",
                                 "token", "credential", "key"};
  std::transform(line.begin(), line.end(), line.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::any_of(kSigns.begin(), kSigns.end(), [&](const char* sign) { return line.find(sign) != line.npos; });
}

// Line by line: a pattern never sees more than one, however long the text.
std::string LineRedacted(std::string line) {
  constexpr std::size_t kLineBytesMax = 8192;  // std::regex recurses by character
  if (line.size() > kLineBytesMax) line = line.substr(0, kLineBytesMax) + " [cut]";
  if (!MayHaveSecret(line)) return line;
  for (const Rule& rule : Rules()) line = std::regex_replace(line, rule.pattern, rule.instead);
  return line;
}

}  // namespace

std::string Redacted(std::string_view text) {
  const std::string without_keys = WithoutKeys(text);
  std::string kept;
  for (std::size_t at = 0; at < without_keys.size();) {
    const std::size_t end = std::min(without_keys.find('\n', at), without_keys.size());
    kept += LineRedacted(without_keys.substr(at, end - at));
    if (end < without_keys.size()) kept += '\n';
    at = end + 1;
  }
  return kept;
}

}  // namespace rigcal::client
