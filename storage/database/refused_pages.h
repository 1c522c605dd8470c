// The pages of databases, and the logs, that this process read and refused, as the disk had changed them
// (summing_files.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "server/base/result.h"

namespace rigcal::storage {

struct RefusedPage {
  std::filesystem::path database;
  std::int64_t page = 0;         // from 1, as SQLite counts; 0: the log
  std::int64_t log_at_byte = 0;  // of the log: where it is damaged
};

// Any thread. A page counts as refused until it is read or written and is good; a log as long as the process runs.
void NoteRefused(const RefusedPage& refused);
void NoteGood(const std::filesystem::path& database, std::int64_t page);

// The last one that was refused in this thread, once: SQLite's own sentence does not name it.
[[nodiscard]] std::optional<RefusedPage> TakeRefused();
// kStorage, as one sentence about `subject`.
[[nodiscard]] Error ErrorOf(const RefusedPage& refused, const std::string& subject);

// Of that database, where its log was refused; known again to this thread as the last one.
[[nodiscard]] bool IsLogRefused(const std::filesystem::path& database);

// The error of the first of that database's pages that counts as refused.
[[nodiscard]] Status CheckNoneRefused(const std::filesystem::path& database);

}  // namespace rigcal::storage
