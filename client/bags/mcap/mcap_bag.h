// A bag in an MCAP file: rosbag2's, or of any other recorder.
#pragma once

#include <memory>

#include "client/bags/bag.h"
#include "client/bags/byte_source.h"

namespace rigcal::bags {

// Refuses what is no MCAP file of version 0. Indexed or not, its chunks plain, lz4 or zstd; a file that was cut off is
// read as far as it goes.
[[nodiscard]] Result<std::unique_ptr<Bag>> OpenMcap(std::unique_ptr<ByteSource> source);

}  // namespace rigcal::bags
