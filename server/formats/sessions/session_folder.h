// A session folder on disk -> Manifest (docs/session-format.md). Errors name file, sensor and line.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

#include "server/model/sessions/session.h"

namespace rigcal::formats {

// session.yaml alone; `name` is used in errors ("session.yaml line 7: ...").
[[nodiscard]] Result<SessionHeader> ReadSessionYaml(std::string_view text, const std::string& name);

// Reads session.yaml, lists the payloads, hashes them (in parallel). Refuses symbolic links out of the folder, files of
// unknown sensors, unknown suffixes, empty files, two files for the same capture and sensor, no payloads at all, a
// table of poses that cannot be read or that names a capture which no other sensor has, a .bin whose layout is neither
// given nor certain. `progress` (bytes hashed, bytes in all) may be empty.
[[nodiscard]] Result<Manifest> ReadSessionFolder(const std::filesystem::path& folder,
                                                 const std::function<void(std::int64_t, std::int64_t)>& progress);

// The same, but what ReadSessionFolder refuses of the files and folders beside session.yaml is told, each in its
// sentence, and left away; the rest is read. Without refusals it is the manifest of ReadSessionFolder.
struct SessionSurvey {
  Manifest manifest;
  std::vector<Error> refusals;  // the first is the error of ReadSessionFolder
};
// An error where the folder or session.yaml itself cannot be read. `progress` as of ReadSessionFolder.
[[nodiscard]] Result<SessionSurvey> SurveySessionFolder(
    const std::filesystem::path& folder, const std::function<void(std::int64_t, std::int64_t)>& progress);

}  // namespace rigcal::formats
