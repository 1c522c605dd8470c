// A copy of a store, taken while a rigcald serves it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "storage/upkeep/backup_folder.h"
#include "storage/upkeep/copy_verified.h"

namespace rigcal::storage {

struct BackupOptions {
  std::filesystem::path data;    // the store's folder, on this machine
  std::filesystem::path folder;  // the backup's: new, empty, or of an earlier backup
  CopyHow how = CopyHow::kCopy;
  bool verify = false;  // holds what earlier backups have copied against its digest again
  std::function<void(std::int64_t done, std::int64_t total)> progress = [](std::int64_t, std::int64_t) {};  // contents
};
struct BackupDone {
  BackupLabel label;
  std::int64_t copied = 0, copied_bytes = 0;  // of contents that no earlier backup had
  std::int64_t known_lost = 0;                // inputs that the store had told of before
  std::vector<std::string> lost;              // inputs that are neither in the store nor in the backup, a sentence each
};

// First the database in one snapshot, then every content that the copy of it names: as a row is written after its
// content, and no content is taken away while a server may run, what the copy names is there, whatever arrives
// meanwhile. The backup before stays as it is until this one is complete and on disk; one that was broken off is begun
// again and copies only what is not there. A content that the store has damaged and an earlier backup has is kept.
// kStorage, without a new backup, where pages of the database or its log are damaged.
[[nodiscard]] Result<BackupDone> MakeBackup(const BackupOptions& options, const Clock& clock);

}  // namespace rigcal::storage
