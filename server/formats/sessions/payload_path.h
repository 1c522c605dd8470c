// "<sensor>/<capture>.<suffix>": where a payload stands in a session folder.
#pragma once

#include <string_view>

#include "server/model/sessions/session.h"

namespace rigcal::formats {

// Path, sensor and capture; digest and size stay empty. Refuses anything but two valid names and a suffix that
// some kind of sensor has. The error names the path.
[[nodiscard]] Result<Payload> PayloadAt(std::string_view path);
// "png"; empty if there is none.
[[nodiscard]] std::string_view SuffixOf(std::string_view path);

}  // namespace rigcal::formats
