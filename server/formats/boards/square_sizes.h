// Measured square sizes as they are kept: by target, canonical JSON.
#pragma once

#include <string>

#include "server/base/result.h"
#include "server/model/boards/square_size.h"

namespace rigcal::formats {

// {"board": {"square_m", "square_sigma_m"}}; of none the empty text.
[[nodiscard]] std::string WriteSquareSizes(const SquareSizes& sizes);
// What the writer wrote; anything else is kInvalidInput and named.
[[nodiscard]] Result<SquareSizes> ReadSquareSizes(const std::string& text);

}  // namespace rigcal::formats
