// A bag in a SQLite database (rosbag2's storage before MCAP), of every schema version from 1 to 4.
#pragma once

#include <filesystem>
#include <memory>

#include "client/bags/bag.h"

namespace rigcal::bags {

// Read only, nothing is written beside it. A write-ahead log that was left behind is taken into account. Messages come
// in the order in which they were stored. Refuses what is no such database; of a damaged one what can be read is given.
// `name`: by which errors call it; empty: as `file`. The file may lose its name once it is open.
[[nodiscard]] Result<std::unique_ptr<Bag>> OpenSqliteBag(const std::filesystem::path& file,
                                                         const std::string& name = "");

}  // namespace rigcal::bags
