// The coloured clouds of a revision, as files in its folder.
#pragma once

#include <filesystem>

#include "server/formats/documents.h"
#include "server/report/sections/cloud_section.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// Writes cloud/<lidar>/{front,top,oblique}.png, cloud.ply, points.bin and overlay/<camera>.jpg, <camera>_picture.jpg
// below `folder`, for every lidar that ChooseClouds finds. One picture is in memory at a time. A camera that several
// lidars meet is shown with the one that has the most points in its picture. What cannot be read, or takes more
// memory than the server has for it, is a note of the section, and what the disk has not kept is asked for again from
// `now` on; only a disk that cannot be written fails. Throws where there is no memory. The same store and revision give
// the same bytes.
[[nodiscard]] Result<report::CloudSection> WriteClouds(storage::Store& store, const formats::RevisionInput& revision,
                                                       const std::filesystem::path& folder, Stamp now);

}  // namespace rigcal::pipeline
