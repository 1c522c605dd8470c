// The store that is copied: opened as it is, and held still. For storage/*.cc only.
#pragma once

#include <functional>
#include <string>

#include "server/base/files/file_descriptor.h"
#include "storage/store.h"

namespace rigcal::storage {

// How a copy names it: the same folder by the same name.
[[nodiscard]] std::string SourceNameOf(const StorePlace& place);

struct Source {
  FileDescriptor lock;  // of its folder: as long as that is held, no server starts on it
  Store store;
};
// Not migrated, not made. kConflict: a server uses it; kUnsupported,
// kNotFound, kStorage as OpenUnchanged, and kStorage where a page of the database is damaged.
[[nodiscard]] Result<Source> OpenSource(const StorePlace& place);
// kConflict: a server or a worker uses it; workers need no lock of the folder.
[[nodiscard]] Status RefuseAtWork(Store& store);

// Runs `body` while nobody writes to it (SQLite), or in one snapshot.
[[nodiscard]] Status HoldStill(Store& source, const std::function<Status()>& body);

}  // namespace rigcal::storage
