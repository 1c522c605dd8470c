// A database on a server, and the folder with its files, know each other: rows that say "held" beside an empty folder
// would have every file taken for lost. For storage/*.cc only.
#pragma once

#include <filesystem>

#include "storage/database/connection.h"

namespace rigcal::storage {

// The first folder of a new store is its folder from then on: `store-id` in it holds the id that the store has.
// kConflict for any other folder, and for a folder of another store. `place`: of the store, for people.
[[nodiscard]] Status TieFolder(Connection& connection, const std::string& place, const std::filesystem::path& folder);

}  // namespace rigcal::storage
