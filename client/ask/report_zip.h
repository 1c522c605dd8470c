// A published report as one file that travels: asked from the server piece by piece, written as a zip.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "client/wire/connection.h"

namespace rigcal::client {

struct ZipSummary {
  std::size_t files = 0;
  std::int64_t bytes = 0;  // of the files, not of the zip
};
// Everything lies in a folder "<robot>-<revision>" within. `file` appears when it is complete, or not at all; the same
// report gives the same bytes.
[[nodiscard]] Result<ZipSummary> WriteReportZip(Connection& connection, std::chrono::milliseconds timeout,
                                                const std::string& robot, std::int64_t revision,
                                                const std::filesystem::path& file);

}  // namespace rigcal::client
