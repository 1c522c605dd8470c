// What forms send and cookies bring. Pure.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace rigcal::http {

// Of application/x-www-form-urlencoded; of several of one name the first. Nothing where an escape is broken.
using Form = std::map<std::string, std::string>;
[[nodiscard]] std::optional<Form> ReadForm(std::string_view body);
// The field, or empty.
[[nodiscard]] std::string FieldOf(const Form& form, const std::string& name);
// For a query string.
[[nodiscard]] std::string PercentEncoded(std::string_view text);

// Of a Cookie header; empty if there is none of this name. Of several nothing: a page of a neighbouring name set one.
[[nodiscard]] std::string CookieOf(std::string_view header, std::string_view name);
// The value of a Set-Cookie header: for this server's own requests and no script, until the browser ends. An empty
// `value` takes it back.
[[nodiscard]] std::string CookieText(const std::string& name, const std::string& value, bool is_secure);

// Where to go after a login: a path of this server with its query; "/" for anything else.
[[nodiscard]] std::string OwnPath(const std::string& wanted);
// Whether a form was sent from a page of this very server: `origin` and `host` as their headers have them, `site` the
// header Sec-Fetch-Site, which decides where there is no Origin.
[[nodiscard]] bool IsOwnPage(std::string_view origin, std::string_view host, std::string_view site);

}  // namespace rigcal::http
