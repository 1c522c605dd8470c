#include "server/formats/answers/parameters.h"

#include <nlohmann/json.hpp>

#include "server/base/limits.h"
#include "server/base/number_text.h"
#include "server/base/text.h"

namespace rigcal::formats {
namespace {

tl::unexpected<Error> Bad(const std::string& what) {
  return Fail(ErrorCode::kInvalidInput, what, "Send a flat JSON object as docs/api.md describes it.");
}

int HexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

Result<std::string> PercentDecoded(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded.push_back(text[i] == '+' ? ' ' : text[i]);
      continue;
    }
    const int high = i + 2 < text.size() ? HexDigit(text[i + 1]) : -1;
    const int low = i + 2 < text.size() ? HexDigit(text[i + 2]) : -1;
    if (high < 0 || low < 0) return Bad("the query string has a '%' without two hex digits");
    decoded.push_back(static_cast<char>(high * 16 + low));
    i += 2;
  }
  return decoded;
}

// Its values may be empty arrays and objects: depth is bounded by leaving out while parsing what is nested, and nothing
// deeper is ever copied or written.
Result<nlohmann::json> FlatObject(std::string_view json) {
  if (json.empty()) return nlohmann::json::object();
  if (json.size() > limits::kRequestBytesMax) return Bad("the request is longer than 64 KiB");
  const auto flat = [](int depth, nlohmann::json::parse_event_t, nlohmann::json&) { return depth <= 1; };
  auto object = nlohmann::json::parse(json, flat, false);
  if (!object.is_object()) return Bad("the request's parameters are not a JSON object");
  return object;
}

}  // namespace

Result<Parameters> Parameters::Read(std::string_view json) {
  Parameters parameters;
  RIGCAL_ASSIGN(const nlohmann::json object, FlatObject(json));
  for (const auto& [name, value] : object.items()) {
    if (value.is_string())
      parameters.texts_[name] = value.get<std::string>();
    else if (value.is_number_integer() || value.is_boolean())
      parameters.texts_[name] = value.dump();
    else
      return Bad("the parameter " + Quoted(name) + " is neither a text nor an integer");
  }
  return parameters;
}

Result<std::string> WithParameter(std::string_view json, const std::string& name, const std::string& value) {
  RIGCAL_TRY(Parameters::Read(json));
  RIGCAL_ASSIGN(nlohmann::json object, FlatObject(json));
  object[name] = value;
  return object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::optional<std::string> Parameters::Text(const std::string& name) const {
  const auto found = texts_.find(name);
  return found == texts_.end() ? std::nullopt : std::optional(found->second);
}

Result<std::int64_t> Parameters::IntegerOr(const std::string& name, std::int64_t fallback) const {
  const auto text = Text(name);
  if (!text) return fallback;
  if (const auto value = NumberIn<std::int64_t>(*text)) return *value;
  return Fail(ErrorCode::kInvalidInput, "the parameter " + Quoted(name) + " is not an integer", "Give a whole number.");
}

Result<bool> Parameters::Flag(const std::string& name) const {
  const std::string text = Text(name).value_or("false");
  if (text == "true" || text == "1") return true;
  if (text == "false" || text == "0") return false;
  return Fail(ErrorCode::kInvalidInput, "the parameter " + Quoted(name) + " is neither true nor false",
              "Give true or false.");
}

Result<std::string> ParametersOfQuery(std::string_view query) {
  auto object = nlohmann::json::object();
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view item = query.substr(0, end);
    query.remove_prefix(std::min(end + 1, query.size()));
    if (item.empty()) continue;
    const std::size_t equals = std::min(item.find('='), item.size());
    RIGCAL_ASSIGN(const std::string name, PercentDecoded(item.substr(0, equals)));
    RIGCAL_ASSIGN(const std::string value, PercentDecoded(item.substr(std::min(equals + 1, item.size()))));
    object[name] = value;
  }
  return object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace rigcal::formats
