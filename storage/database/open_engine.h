// Which engine keeps the rows of a store. For storage/*.cc only.
#pragma once

#include <memory>

#include "storage/database/engine.h"
#include "storage/store_place.h"

namespace rigcal::storage {

// A new connection. Errors name the place.
[[nodiscard]] Result<std::unique_ptr<Engine>> OpenEngine(const StorePlace& place);

}  // namespace rigcal::storage
