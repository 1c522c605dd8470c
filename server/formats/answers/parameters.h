// The parameters of a request: a flat JSON object or a URL's query string.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "server/base/result.h"

namespace rigcal::formats {

class Parameters {
 public:
  // An object of texts, integers and booleans; "" is the empty object. Anything else: kInvalidInput.
  [[nodiscard]] static Result<Parameters> Read(std::string_view json);
  [[nodiscard]] std::optional<std::string> Text(const std::string& name) const;
  // Also of a text of digits; `fallback` if the parameter is absent; kInvalidInput if it is not an integer.
  [[nodiscard]] Result<std::int64_t> IntegerOr(const std::string& name, std::int64_t fallback) const;
  // A boolean, or one of the texts "true", "false", "1", "0"; false if the parameter is absent.
  [[nodiscard]] Result<bool> Flag(const std::string& name) const;

 private:
  std::map<std::string, std::string> texts_;
};

// `json`, as Parameters::Read takes it, with the text `value` as `name`, whatever it had there; kInvalidInput where it
// is not that flat.
[[nodiscard]] Result<std::string> WithParameter(std::string_view json, const std::string& name,
                                                const std::string& value);

// "robot=a&revision=3" (percent-encoded) -> {"revision":"3","robot":"a"}.
[[nodiscard]] Result<std::string> ParametersOfQuery(std::string_view query);

}  // namespace rigcal::formats
