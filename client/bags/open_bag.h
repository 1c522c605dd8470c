// Opens a bag, whatever it is.
#pragma once

#include <filesystem>
#include <memory>

#include "client/bags/bag.h"

namespace rigcal::bags {

// A file (MCAP, rosbag2's database, a bag of ROS 1, each with zstd around it or not; told by its first bytes, not by
// its name) or a folder of rosbag2. Files of a folder are read one after the other; one that is missing or is no bag is
// noted and the others are given. Messages that are compressed one by one are unpacked. An error where nothing at all
// can be read.
[[nodiscard]] Result<std::unique_ptr<Bag>> OpenBag(const std::filesystem::path& path);

}  // namespace rigcal::bags
