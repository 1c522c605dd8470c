// Sends one file of the published folder: ETag, If-None-Match, Range.
#pragma once

#include <civetweb.h>

#include <filesystem>
#include <string>

namespace rigcal::http {

// `file` is relative to `folder`, as PublishedFile() gives it. Returns the status; 404 (nothing sent) where it is no
// file, a symbolic link stands in the way, or `folder` is empty.
[[nodiscard]] int SendFile(mg_connection* connection, const std::filesystem::path& folder, const std::string& file);

}  // namespace rigcal::http
