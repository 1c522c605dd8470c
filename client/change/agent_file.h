// The file of `rigcal agent`: the document of the revision that a robot runs, byte for byte, so that its sha256 is the
// revision's digest.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/stamp.h"

namespace rigcal::client {

struct AppliedFile {
  Digest digest;
  Stamp applied_at;  // when it was written
};
// Nothing: there is no such file.
[[nodiscard]] Result<std::optional<AppliedFile>> LookAtApplied(const std::filesystem::path& file);

// The document in an answer to `show`, as the server stores it; empty where there is none.
[[nodiscard]] std::string_view DocumentIn(std::string_view answer);
// kStorage where the document is not that of `digest`: it is not written, and the file stays as it is. So it does on
// every other error; a file that is there is whole, whenever the power goes.
[[nodiscard]] Status Apply(std::string_view document, const Digest& digest, const std::filesystem::path& file);

}  // namespace rigcal::client
