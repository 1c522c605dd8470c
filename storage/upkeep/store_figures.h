// How much is in a store, in numbers alone.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "storage/store.h"

namespace rigcal::storage {

struct StoreFigures {
  int schema_version = 0;
  std::map<std::string, std::int64_t> rows;  // by table; those whose name begins with "waiting" are queues
};

// kStorage where the database cannot be read; kUnsupported where it is not SQLite. In one snapshot.
[[nodiscard]] Result<StoreFigures> LoadFigures(Store& store);

}  // namespace rigcal::storage
