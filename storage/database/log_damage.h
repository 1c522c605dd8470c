// Whether the log (WAL) of the database in a data folder has lost commits that SQLite does not miss.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "server/base/result.h"

namespace rigcal::storage {

struct LogDamage {
  enum class Kind {
    kNotRead,     // behind a frame that is not as it was written lie commits that SQLite would not read
    kStored,      // likewise, but all of them are in the database: what is left to read is older than that
    kHalfStored,  // likewise, but some of their pages are in the database, and others are not
    kGone,        // the file is not there; its index (-shm) says that the database lacks a part of it
  };
  Kind kind = Kind::kNotRead;
  std::int64_t at_byte = 0;     // where it is damaged; 0: its header, so that nothing is read
  std::int64_t read_bytes = 0;  // what SQLite reads
  std::int64_t commits = 0;     // that it does not read, at the least; of kGone: frames
};

// Call it before the database is opened: SQLite takes the part that it reads and removes the rest. Others may have it
// open and write meanwhile. Nothing: no damage can be proved.
[[nodiscard]] std::optional<LogDamage> FindLogDamage(const std::filesystem::path& folder);
// One sentence, and the cure.
[[nodiscard]] Error ErrorOf(const LogDamage& damage, const std::filesystem::path& folder);
// kStorage, where there is any.
[[nodiscard]] Status RefuseDamagedLog(const std::filesystem::path& folder);

// Of a log that nobody has open and whose last commit cannot be read: what may be lost, as a sentence without its stop,
// and where to look. Nothing where the machine was started after the log was written: power loss, which leaves the like
// of it, takes nothing that was acknowledged.
[[nodiscard]] std::optional<Error> LogInDoubt(const std::filesystem::path& folder);
// Of a log that went without a trace of why (page_sums.h, ForgetIfLogWent): what may be lost, as a sentence without its
// stop, and where to look. Nothing: none did, or it was told and forgotten.
[[nodiscard]] std::optional<Error> LogThatWent(const std::filesystem::path& folder);
void ForgetLogThatWent(const std::filesystem::path& folder);

[[nodiscard]] std::filesystem::path LogFile(const std::filesystem::path& folder);
[[nodiscard]] std::filesystem::path LogIndexFile(const std::filesystem::path& folder);

}  // namespace rigcal::storage
