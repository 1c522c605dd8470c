// One decoder per cloud format; contract: ReadCloud (cloud.h).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "server/base/result.h"
#include "server/model/sensors/cloud.h"
#include "server/model/sensors/cloud_layout.h"

namespace rigcal::formats {

// ReadCloud of one suffix, without its checks of the cloud as a whole; errors call the file `name`.
[[nodiscard]] Result<Cloud> ReadPcd(std::string_view bytes, const std::string& name);
[[nodiscard]] Result<Cloud> ReadPly(std::string_view bytes, const std::string& name);
// Points, and values of each, as the header claims; nothing if it cannot be read.
[[nodiscard]] std::optional<std::pair<std::size_t, std::size_t>> PlySize(std::string_view bytes);
[[nodiscard]] Result<Cloud> ReadBin(std::string_view bytes, const std::optional<CloudLayout>& layout,
                                    const std::string& name);

}  // namespace rigcal::formats
