// A connection to the store for each thread that answers over HTTP.
#pragma once

#include "storage/store.h"

namespace rigcal {

// That of the calling thread, opened when it first asks, and again where that failed; lives as long as the thread. One
// place per process.
[[nodiscard]] Result<storage::Store*> StoreOfThread(const storage::StorePlace& place);

}  // namespace rigcal
