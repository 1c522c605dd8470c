// READ: the files of a published report, for those who cannot see the server's disk.
#pragma once

#include <cstdint>
#include <string>

#include "server/base/ids.h"
#include "storage/store.h"

namespace rigcal::pipeline {

constexpr std::int64_t kReportPieceBytes = 1 << 20;

// The documents of the verbs `report_files` and `report_file` (docs/api.md). `revision` is a number, not 0. kNotFound
// for what is not published, or not a file of that report.
[[nodiscard]] Result<std::string> ReportFiles(const storage::Store& store, const RobotId& robot, int revision);
[[nodiscard]] Result<std::string> ReportFile(const storage::Store& store, const RobotId& robot, int revision,
                                             const std::string& path, std::int64_t offset);

}  // namespace rigcal::pipeline
