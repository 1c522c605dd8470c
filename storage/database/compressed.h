// Texts as the store keeps them: zstd, one frame that says its size and has a checksum. The same text gives the same
// bytes.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "server/base/result.h"

namespace rigcal::storage {

// Errors begin with `subject`: "the document of revision 3 of robot r".
//
// kInvalidInput for more than `bytes_max` of text.
[[nodiscard]] Result<std::string> Compress(const std::string& subject, std::string_view text, std::size_t bytes_max);
// kStorage for anything but one whole frame of at most `bytes_max` of text; takes no more memory than the bytes can
// account for.
[[nodiscard]] Result<std::string> Decompress(const std::string& subject, std::string_view bytes, std::size_t bytes_max);

}  // namespace rigcal::storage
