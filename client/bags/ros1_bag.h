// A bag of ROS 1 (format "#ROSBAG V2.0").
#pragma once

#include <memory>

#include "client/bags/bag.h"
#include "client/bags/byte_source.h"

namespace rigcal::bags {

// Refuses what is no such bag, and versions before 2.0 by name. Chunks plain, bz2 or lz4; indexed or not (a
// `.bag.active` that nobody closed): the index is not used. Its messages are encoded as "ros1".
[[nodiscard]] Result<std::unique_ptr<Bag>> OpenRos1Bag(std::unique_ptr<ByteSource> source);

}  // namespace rigcal::bags
