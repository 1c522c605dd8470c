// How large a SQLite file was when it was written: a file that was cut is shorter.
#pragma once

#include <cstdint>
#include <filesystem>

namespace rigcal::bags {

// Pages times their size, as the file's first 100 bytes say ("Database File Format" of SQLite, section 1.3); 0 where
// they do not, or where a log beside the file may hold the rest.
[[nodiscard]] std::uint64_t ClaimedSqliteBytes(const std::filesystem::path& file);

}  // namespace rigcal::bags
