#include "server/http/logins/form.h"

#include <algorithm>

#include "server/base/text.h"
#include "server/http/request_path.h"

namespace rigcal::http {
namespace {

// Calls `each` with what stands between `separator`s.
template <typename Each>
void Split(std::string_view text, char separator, const Each& each) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(separator), text.size());
    each(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

std::string_view Trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string_view::npos ? std::string_view()
                                         : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

}  // namespace

std::optional<Form> ReadForm(std::string_view body) {
  Form form;
  bool is_whole = true;
  Split(body, '&', [&](std::string_view one) {
    const std::size_t equals = std::min(one.find('='), one.size());
    const auto name = PercentDecoded(one.substr(0, equals), Plus::kIsSpace);
    const auto value = PercentDecoded(one.substr(std::min(equals + 1, one.size())), Plus::kIsSpace);
    is_whole = is_whole && name && value;
    if (name && value) form.emplace(*name, *value);
  });
  return is_whole ? std::optional(std::move(form)) : std::nullopt;
}

std::string FieldOf(const Form& form, const std::string& name) {
  const auto found = form.find(name);
  return found == form.end() ? "" : found->second;
}

std::string PercentEncoded(std::string_view text) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._~/";
  std::string encoded;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (kPlain.find(c) != std::string_view::npos)
      encoded += c;
    else
      encoded.append({'%', "0123456789ABCDEF"[byte >> 4], "0123456789ABCDEF"[byte & 15]});
  }
  return encoded;
}

std::string CookieOf(std::string_view header, std::string_view name) {
  std::string value;
  int count = 0;
  Split(header, ';', [&](std::string_view raw) {
    const std::string_view one = Trimmed(raw);
    const std::size_t equals = one.find('=');
    if (equals == std::string_view::npos || one.substr(0, equals) != name) return;
    value = one.substr(equals + 1);
    ++count;
  });
  return count == 1 ? value : "";
}

std::string CookieText(const std::string& name, const std::string& value, bool is_secure) {
  return name + "=" + value + "; Path=/; HttpOnly; SameSite=Strict" + (is_secure ? "; Secure" : "") +
         (value.empty() ? "; Max-Age=0" : "");
}

std::string OwnPath(const std::string& wanted) {
  const std::string path = wanted.substr(0, wanted.find('?'));
  const bool is_own = wanted.rfind('/', 0) == 0 && wanted.rfind("//", 0) != 0 && IsPrintableUtf8(wanted) &&
                      wanted.find_first_of("\\#") == std::string::npos && NormalPath(path).has_value();
  return is_own ? wanted : "/";
}

bool IsOwnPage(std::string_view origin, std::string_view host, std::string_view site) {
  if (origin.empty()) return site == "same-origin";
  for (const std::string_view scheme : {"http://", "https://"})
    if (origin.substr(0, scheme.size()) == scheme) return !host.empty() && origin.substr(scheme.size()) == host;
  return false;
}

}  // namespace rigcal::http
