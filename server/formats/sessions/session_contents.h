// What is read of a session's files before they are sent: what a technician can mend, and the server could not.
#pragma once

#include <filesystem>
#include <map>

#include "server/formats/sessions/refusals.h"
#include "server/model/sensors/pose_table.h"

namespace rigcal::formats {

// Tables of poses that cannot be read, or name a capture that no other sensor has; a .bin whose layout is neither given
// nor certain.
[[nodiscard]] Status CheckContents(const std::filesystem::path& folder, const Refusals& refusals, Manifest& manifest);

// The tables of a session's trackers; those that cannot be read are left out.
[[nodiscard]] std::map<SensorId, PoseTable> ReadTrackers(const std::filesystem::path& folder, const Manifest& manifest);

}  // namespace rigcal::formats
