// What is read of a session's files before they are sent: what a technician can mend, and the server could not.
#pragma once

#include <filesystem>

#include "server/formats/refusals.h"

namespace rigcal::formats {

// Tables of poses that cannot be read, or name a capture that no other sensor has; a .bin whose layout is neither given
// nor certain.
[[nodiscard]] Status CheckContents(const std::filesystem::path& folder, const Refusals& refusals, Manifest& manifest);

}  // namespace rigcal::formats
