// READ: every file of a session folder is looked at once.
#pragma once

#include <filesystem>
#include <functional>
#include <span>

#include "client/check/seen.h"
#include "server/model/sensors/cloud_layout.h"

namespace rigcal::check {

// Pure: encoded bytes to what they show. The search is that of the server's jobs (detect::FindIn). Throw
// std::bad_alloc.
[[nodiscard]] PictureSeen LookAtPicture(std::span<const std::byte> encoded, const std::string& path,
                                        const std::vector<const Target*>& targets);
[[nodiscard]] CloudSeen LookAtCloud(std::span<const std::byte> bytes, const std::string& path,
                                    const std::optional<CloudLayout>& layout);

// Bytes read of the folder and in all, then files looked at and in all; either may be empty. Called one at a time, from
// any thread.
struct LookProgress {
  std::function<void(std::int64_t, std::int64_t)> bytes, files;
};
// Files in parallel, each thread with one picture or cloud in memory at a time. Fails where SurveySessionFolder does.
[[nodiscard]] Result<SessionSeen> Look(const std::filesystem::path& folder, const LookProgress& progress);

}  // namespace rigcal::check
