// The contents that rows name, in the folder of another store.
#pragma once

#include <filesystem>

#include "storage/database/connection.h"
#include "storage/move/move_store.h"

namespace rigcal::storage {

// By name of the rows of `rows`, from the one folder of blobs to the other: each is held against its digest; what is
// there already as well. Adds to `moved`. The names are on disk with the next SyncFileSystem.
[[nodiscard]] Status CopyFiles(Connection& rows, const std::filesystem::path& from, const std::filesystem::path& to,
                               const MoveOptions& options, Moved& moved);

}  // namespace rigcal::storage
