// A store and the bucket with its blobs know each other: rows that say "held" beside another bucket would have every
// file taken for lost.
#pragma once

#include "storage/database/connection.h"
#include "storage/files/blobs.h"
#include "storage/store.h"

namespace rigcal::storage {

// The blobs of a store that is being opened. A store that is opened with a bucket for the first time keeps it from then
// on: what its folder has is put there first, and what its rows call held and the folder has not is noted as lost; a
// file that cannot be read ends it. kConflict: it has another one, the bucket is another store's, or on PostgreSQL
// others are at work. Opened without its bucket, its blobs cannot be used (Blobs::CheckUsable). For storage/*.cc only.
[[nodiscard]] Result<Blobs> OpenBlobs(Connection& connection, const StorePlace& place);

// Inside of a Write that names blobs: kUnreachable where the store has got a bucket that this Store does not know of.
[[nodiscard]] Status CheckBlobsStayed(Store& store);

// Whether blobs can be stored and read: of a bucket asks it (Bucket::Check).
[[nodiscard]] Status CheckBlobs(Store& store);

}  // namespace rigcal::storage
