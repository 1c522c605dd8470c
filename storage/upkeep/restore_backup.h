// A backup becomes a data folder.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "storage/upkeep/backup_folder.h"

namespace rigcal::storage {

struct RestoreOptions {
  std::filesystem::path folder;  // the backup's
  std::filesystem::path data;    // new or empty
  int number = 0;                // which of its backups; 0: the newest
  std::function<void(std::int64_t done, std::int64_t total)> progress = [](std::int64_t, std::int64_t) {};  // contents
};
struct Restored {
  BackupLabel label;
  std::int64_t blobs = 0, bytes = 0;
  std::vector<std::string> lost;           // inputs that the backup does not have as they were, a sentence each
  bool losses_noted = false;               // they count as not held; false: older versions knew no losses
  std::vector<std::string> users, tokens;  // that are good again, by name: also those that were taken back since
};

// Every byte is held against its digest on the way. The folder is made beside `data` and takes its place at the end, on
// disk: broken off, there is none, and the same again begins anew. kConflict: `data` is in use or not empty; kNotFound:
// there is no such backup; kStorage: its database is damaged; kBusy: another restore is at it. Whoever was logged in
// then is so no longer.
[[nodiscard]] Result<Restored> RestoreBackup(const RestoreOptions& options);

}  // namespace rigcal::storage
