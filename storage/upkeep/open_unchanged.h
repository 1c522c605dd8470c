// Opens a store that may be another process's: nothing of it is migrated or made.
#pragma once

#include <filesystem>

#include "storage/store.h"

namespace rigcal::storage {

// kNotFound: there is no store in `folder`. kUnsupported: it is of another version than this program, or cannot be read
// where nothing can be written; kStorage: the database cannot be read, or its log has lost commits, also where a server
// has it open.
[[nodiscard]] Result<Store> OpenUnchanged(const std::filesystem::path& folder);

}  // namespace rigcal::storage
