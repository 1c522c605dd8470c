// A committed revision -> its report folder, published at once or not at all.
#pragma once

#include <filesystem>
#include <string>

#include "server/base/stamp.h"
#include "storage/revisions/revisions.h"

namespace rigcal::pipeline {

// Renders into a temporary folder, fsyncs, renames it to ReportFolder()/<robot>/<number>, marks it published. Doing it
// twice is harmless. Returns the folder. `why_no_clouds`, if not empty, stands in the place of the coloured clouds.
[[nodiscard]] Result<std::filesystem::path> Publish(storage::Store& store, const storage::RevisionKey& key,
                                                    const Clock& clock, const std::string& why_no_clouds = {});

}  // namespace rigcal::pipeline
