// A connection to the store for each thread that answers over HTTP.
#pragma once

#include <filesystem>

#include "storage/store.h"

namespace rigcal {

// That of the calling thread, opened when it first asks, and again where that failed; lives as long as the thread. One folder
// per process.
[[nodiscard]] Result<storage::Store*> StoreOfThread(const std::filesystem::path& folder);

}  // namespace rigcal
