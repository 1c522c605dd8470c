// Text as addresses and forms carry it. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace rigcal::http {

enum class Plus { kIsPlus, kIsSpace };  // in a path; in application/x-www-form-urlencoded

// Nothing where an escape is broken: civetweb's own decoding would leave it as it is.
[[nodiscard]] std::optional<std::string> PercentDecoded(std::string_view raw, Plus plus);

}  // namespace rigcal::http
