// A database on a server, and the folder with its files, know each other: rows that say "held" beside an empty folder
// would have every file taken for lost. For storage/*.cc only.
#pragma once

#include "storage/database/connection.h"
#include "storage/store_place.h"

namespace rigcal::storage {

// The first folder of a new store is its folder from then on: `store-id` in it holds the id that the store has.
// kConflict for any other folder, and for a folder of another store. Where all blobs are in the bucket already each
// process may have a folder of its own: a new one becomes one of the store's.
[[nodiscard]] Status TieFolder(Connection& connection, const StorePlace& place);

}  // namespace rigcal::storage
