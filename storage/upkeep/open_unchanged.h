// Opens a store that may be another process's: nothing of it is migrated or made.
#pragma once

#include <filesystem>

#include "storage/store.h"

namespace rigcal::storage {

// kNotFound: there is no store in `folder`. kUnsupported: it is of another version than this program, or cannot be read
// where nothing can be written; kStorage: the database cannot be read, or its log has lost commits, also where a server
// has it open.
[[nodiscard]] Result<Store> OpenUnchanged(const std::filesystem::path& folder);
// The same of any place. Of one in PostgreSQL, kNotFound also where the folder holds no blobs, and kConflict where it
// is another store's.
[[nodiscard]] Result<Store> OpenUnchanged(const StorePlace& place);
// Of a place in PostgreSQL: kNotFound and kUnsupported as above, and kStorage where it cannot be reached.
[[nodiscard]] Status CheckServerStore(const StorePlace& place);

}  // namespace rigcal::storage
