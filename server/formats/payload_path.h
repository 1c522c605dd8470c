// "<sensor>/<capture>.<suffix>": where a payload stands in a session folder.
#pragma once

#include <optional>
#include <string_view>

#include "server/model/session.h"

namespace rigcal::formats {

// path, sensor and capture; digest and size stay empty. Refuses anything that is not two valid names and a suffix of
// kind `camera` (png, jpg or jpeg in any case). The error names the path.
[[nodiscard]] Result<Payload> PayloadAt(std::string_view path);
// The suffix in lower case without its dot; empty if there is none.
[[nodiscard]] std::string SuffixOf(std::string_view path);

}  // namespace rigcal::formats
