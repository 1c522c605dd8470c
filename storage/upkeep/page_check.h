// The pages of a database against the sums that were noted when they were written (database/page_sums.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "storage/database/connection.h"

namespace rigcal::storage {

struct PageLook {
  std::int64_t pages = 0, unknown = 0;  // unknown: without a sum, as they were written before there were sums
  std::vector<std::int64_t> damaged;    // from 1, as SQLite counts
};
// Others may write meanwhile: what differs is looked at again before it counts. kStorage: the file cannot be read.
[[nodiscard]] Result<PageLook> LookAtPages(Connection& connection, const std::filesystem::path& database);

// Of a database that SQLite cannot open: nobody has it open, so that each page is looked at once.
[[nodiscard]] Result<PageLook> LookAtPages(const std::filesystem::path& database);

struct PageOwner {
  std::string name;       // of a table or an index; empty: no row lies in it, or it cannot be told
  bool is_index = false;  // what it holds follows from its table
  bool is_free = false;   // no row lies in it
};
// Of those pages; the walk through a damaged database may not reach all of them.
[[nodiscard]] std::map<std::int64_t, PageOwner> OwnersOf(Connection& connection,
                                                         const std::vector<std::int64_t>& pages);

// "page 17 of rigcal.db (table edge)"
[[nodiscard]] std::string TextOfPage(std::int64_t page, const PageOwner& owner);

struct Mended {
  bool free_pages = false;  // were noted as they are; not where the list of free pages is broken
  bool all_others = false;  // nothing but indices was damaged
};
// Builds the indices anew that these pages belong to, and notes the pages that no row lies in as they are. Nobody else
// has the store open.
[[nodiscard]] Result<Mended> MendPages(Connection& connection, const std::filesystem::path& database,
                                       const std::vector<std::int64_t>& damaged);
// From here on that connection refuses damaged pages, though it was opened to look at them: a repair must not write on
// what it read there.
void RefuseDamagedPages(Connection& connection);
// Of all pages without a sum, as they are: only where the database is good.
[[nodiscard]] Status NoteUnknownPages(Connection& connection, const std::filesystem::path& database);

}  // namespace rigcal::storage
